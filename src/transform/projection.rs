//! Projections to clip space, -w ≤ x, y ≤ w; the viewport; and the distance back from a depth.
//!
//! Three depth conventions: standard (OpenGL, z/w from -1 at near to 1 at far), zero to one (near to far), and reversed
//! (1 at near to 0 at far, which spreads floating-point precision evenly). The far plane may be infinite.
//!
//! N. Reed, *Depth precision visualized*, 2015 (reversed depth); E. Lengyel, *Projection matrix tricks*, 2007.

use super::Rows4;
use crate::math::tan;
use crate::real::Real;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    Standard,
    ZeroToOne,
    Reversed,
}

/// Left, right, bottom, top, near, far: at the near plane for a perspective projection.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Frustum<T>(pub [T; 6]);

impl<T: Real> Frustum<T> {
    /// Symmetric, from a vertical field of view in radians within (0, π) and the ratio of width to height, else NaN.
    #[inline(always)]
    pub fn from_fov(fov_y: T, aspect: T, near: T, far: T) -> Self {
        let proper = fov_y > T::zero() && fov_y < T::PI && aspect > T::zero();
        let near = if proper { near } else { T::NAN };
        let top = near * tan(fov_y * T::of(0.5));
        let right = top * aspect;
        Frustum([-right, right, -top, top, near, far])
    }
}

/// The perspective projection, or NaN where the planes do not bound a volume.
#[inline(always)]
pub fn perspective<T: Real>(frustum: Frustum<T>, depth: Depth) -> Rows4<T> {
    let Frustum([l, r, b, t, n, f]) = frustum;
    let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
    if !(n > zero && f > n && l != r && b != t) {
        return [[T::NAN; 4]; 4];
    }
    // far / (far - near) and near / (far - near), with their limits at infinity.
    let (over, under) = if f == T::INFINITY { (one, zero) } else { (f / (f - n), n / (f - n)) };
    let (a, c) = match depth {
        Depth::Standard => (-(over + under), -(two * n * over)),
        Depth::ZeroToOne => (-over, -(n * over)),
        Depth::Reversed => (under, n * over),
    };
    [
        [two * n / (r - l), zero, (r + l) / (r - l), zero],
        [zero, two * n / (t - b), (t + b) / (t - b), zero],
        [zero, zero, a, c],
        [zero, zero, -one, zero],
    ]
}

/// The orthographic projection, or NaN where the planes do not bound a volume.
#[inline(always)]
pub fn orthographic<T: Real>(frustum: Frustum<T>, depth: Depth) -> Rows4<T> {
    let Frustum([l, r, b, t, n, f]) = frustum;
    let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
    if !(l != r && b != t && n != f && (f - n).is_finite()) {
        return [[T::NAN; 4]; 4];
    }
    let (a, c) = match depth {
        Depth::Standard => (-two / (f - n), -(f + n) / (f - n)),
        Depth::ZeroToOne => (-one / (f - n), -n / (f - n)),
        Depth::Reversed => (one / (f - n), f / (f - n)),
    };
    [
        [two / (r - l), zero, zero, -(r + l) / (r - l)],
        [zero, two / (t - b), zero, -(t + b) / (t - b)],
        [zero, zero, a, c],
        [zero, zero, zero, one],
    ]
}

/// Normalised device coordinates to pixels: x to the right, y down, the picture's corner at `origin`; z stays.
pub fn viewport<T: Real>(size: [T; 2], origin: [T; 2]) -> Rows4<T> {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let [w, h] = size.map(|s| s * half);
    [
        [w, zero, zero, origin[0] + w],
        [zero, -h, zero, origin[1] + h],
        [zero, zero, one, zero],
        [zero, zero, zero, one],
    ]
}

/// The distance along the line of sight (-z in eye space) that a projection maps to the depth z/w. Its four entries
/// that concern depth, `[[a, b], [c, d]]`, say which convention it is of.
#[inline(always)]
pub fn linear_depth<T: Real>(depth: T, [[a, b], [c, d]]: [[T; 2]; 2]) -> T {
    (depth * d - b) / (depth * c - a)
}
