//! Small vectors and matrices over a scalar or over SIMD lanes.
//!
//! Matrices hold columns and act on column vectors: `m * v`. The order of every sum is fixed, and nothing is
//! fused, so that a lane gives the bits of the scalar.

use crate::real::Lanes;
use std::ops::{Add, Mul, Neg, Sub};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Vec2<V> {
    pub x: V,
    pub y: V,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Vec3<V> {
    pub x: V,
    pub y: V,
    pub z: V,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Vec4<V> {
    pub x: V,
    pub y: V,
    pub z: V,
    pub w: V,
}

/// Three columns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Mat3<V>(pub [Vec3<V>; 3]);

/// Four columns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Mat4<V>(pub [Vec4<V>; 4]);

/// What the three vectors share: arrays in and out, and component-wise arithmetic.
macro_rules! vector {
    ($name:ident, $n:literal, $($f:ident),+) => {
        impl<V: Copy> $name<V> {
            #[inline(always)]
            pub fn to_array(self) -> [V; $n] {
                [$(self.$f),+]
            }
            #[inline(always)]
            pub fn splat(v: V) -> Self {
                Self { $($f: v),+ }
            }
            /// Every component through `f`.
            #[inline(always)]
            pub fn map<W>(self, f: impl Fn(V) -> W) -> $name<W> {
                $name { $($f: f(self.$f)),+ }
            }
            /// Components of both through `f`.
            #[inline(always)]
            pub fn zip<U: Copy, W>(self, o: $name<U>, f: impl Fn(V, U) -> W) -> $name<W> {
                $name { $($f: f(self.$f, o.$f)),+ }
            }
        }
        impl<V> From<[V; $n]> for $name<V> {
            #[inline(always)]
            fn from([$($f),+]: [V; $n]) -> Self {
                Self { $($f),+ }
            }
        }
        impl<V: Copy + Add<Output = V>> Add for $name<V> {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                Self { $($f: self.$f + o.$f),+ }
            }
        }
        impl<V: Copy + Sub<Output = V>> Sub for $name<V> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                Self { $($f: self.$f - o.$f),+ }
            }
        }
        impl<V: Copy + Mul<Output = V>> Mul<V> for $name<V> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, s: V) -> Self {
                Self { $($f: self.$f * s),+ }
            }
        }
        impl<V: Copy + Neg<Output = V>> Neg for $name<V> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self { $($f: -self.$f),+ }
            }
        }
    };
}
vector!(Vec2, 2, x, y);
vector!(Vec3, 3, x, y, z);
vector!(Vec4, 4, x, y, z, w);

impl<V: Lanes> Vec2<V> {
    #[inline(always)]
    pub fn dot(self, o: Self) -> V {
        self.x * o.x + self.y * o.y
    }
}

impl<V> Vec3<V> {
    #[inline(always)]
    pub const fn new(x: V, y: V, z: V) -> Self {
        Self { x, y, z }
    }
}

impl<V: Lanes> Vec3<V> {
    #[inline(always)]
    pub fn dot(self, o: Self) -> V {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self {
            x: self.y * o.z - self.z * o.y,
            y: self.z * o.x - self.x * o.z,
            z: self.x * o.y - self.y * o.x,
        }
    }
    #[inline(always)]
    pub fn length_squared(self) -> V {
        self.dot(self)
    }
    /// The Euclidean length; squares must neither overflow nor vanish (see [`Vec3::normalize`]).
    #[inline(always)]
    pub fn length(self) -> V {
        self.dot(self).sqrt()
    }
    /// The unit vector, for every finite non-zero length: the largest component is scaled to one first, so
    /// lengths of 1e-30 or 1e30 lose nothing in single precision. Zero gives NaN.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        let largest = self.x.abs().max(self.y.abs()).max(self.z.abs());
        let v = self.map(|c| c / largest);
        let length = v.length();
        v.map(|c| c / length)
    }
    /// Component-wise product, as of colours.
    #[inline(always)]
    pub fn times(self, o: Self) -> Self {
        Self { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z }
    }
    #[inline(always)]
    pub fn extend(self, w: V) -> Vec4<V> {
        Vec4 { x: self.x, y: self.y, z: self.z, w }
    }
}

impl<V: Lanes> Vec4<V> {
    #[inline(always)]
    pub fn dot(self, o: Self) -> V {
        self.x * o.x + self.y * o.y + self.z * o.z + self.w * o.w
    }
    /// The unit vector, as [`Vec3::normalize`].
    #[inline(always)]
    pub fn normalize(self) -> Self {
        let largest = self.x.abs().max(self.y.abs()).max(self.z.abs().max(self.w.abs()));
        let v = self.map(|c| c / largest);
        let length = v.dot(v).sqrt();
        v.map(|c| c / length)
    }
    #[inline(always)]
    pub fn xyz(self) -> Vec3<V> {
        Vec3 { x: self.x, y: self.y, z: self.z }
    }
}

impl<V: Lanes> Mat3<V> {
    /// From rows, as NumPy stores a matrix.
    #[inline(always)]
    pub fn from_rows(r: [[V; 3]; 3]) -> Self {
        Self(std::array::from_fn(|c| Vec3 { x: r[0][c], y: r[1][c], z: r[2][c] }))
    }
    /// Its rows.
    #[inline(always)]
    pub fn rows(self) -> [[V; 3]; 3] {
        let [a, b, c] = self.0;
        [[a.x, b.x, c.x], [a.y, b.y, c.y], [a.z, b.z, c.z]]
    }
    #[inline(always)]
    pub fn mul_vec(self, v: Vec3<V>) -> Vec3<V> {
        self.0[0] * v.x + self.0[1] * v.y + self.0[2] * v.z
    }
    /// The determinant.
    #[inline(always)]
    pub fn determinant(self) -> V {
        self.0[0].dot(self.0[1].cross(self.0[2]))
    }
    /// The cofactor matrix: the adjugate's transpose, which carries normals. Exists for singular matrices too.
    #[inline(always)]
    pub fn cofactor(self) -> Self {
        let [a, b, c] = self.0;
        Self([b.cross(c), c.cross(a), a.cross(b)])
    }
}

impl<V: Lanes> Mat4<V> {
    /// From rows, as NumPy stores a matrix.
    #[inline(always)]
    pub fn from_rows(r: [[V; 4]; 4]) -> Self {
        Self(std::array::from_fn(|c| Vec4 { x: r[0][c], y: r[1][c], z: r[2][c], w: r[3][c] }))
    }
    #[inline(always)]
    pub fn mul_vec(self, v: Vec4<V>) -> Vec4<V> {
        self.0[0] * v.x + self.0[1] * v.y + self.0[2] * v.z + self.0[3] * v.w
    }
    /// A point: w = 1 in, the homogeneous result out.
    #[inline(always)]
    pub fn mul_point(self, p: Vec3<V>) -> Vec4<V> {
        self.0[0] * p.x + self.0[1] * p.y + self.0[2] * p.z + self.0[3]
    }
    /// A direction: w = 0.
    #[inline(always)]
    pub fn mul_vector(self, d: Vec3<V>) -> Vec3<V> {
        (self.0[0] * d.x + self.0[1] * d.y + self.0[2] * d.z).xyz()
    }
    /// The linear part.
    #[inline(always)]
    pub fn mat3(self) -> Mat3<V> {
        Mat3([self.0[0].xyz(), self.0[1].xyz(), self.0[2].xyz()])
    }
}
