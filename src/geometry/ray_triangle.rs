//! A ray against a triangle, by three methods. All are two-sided, and give `t` and the weights `u` of `b` and `v` of
//! `c`: the point is `(1 - u - v) a + u b + v c`.
//!
//! - [`Method::Watertight`]: the triangle is sheared into the ray's frame, where three edge functions decide. Two
//!   triangles that share an edge compute the same edge function with the opposite sign, so no ray passes between
//!   them. An edge function that rounds to zero is decided by its exact value (see [`watertight`]).
//!   S. Woop, C. Benthin, I. Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013.
//! - [`Method::MollerTrumbore`]: Cramer's rule on the edges. T. Möller, B. Trumbore, *Fast, Minimum Storage
//!   Ray/Triangle Intersection*, Journal of Graphics Tools 2(1), 1997. Rays at edges can slip through.
//! - [`Method::Plane`]: the point where the ray meets the plane, then its barycentrics in the coordinate plane that
//!   the normal is steepest to. D. Badouel, *An Efficient Ray-Polygon Intersection*, Graphics Gems, 1990.
//!
//! Triangles without area are missed, unless a ray passes within round-off of them. Nothing is fused: a fused edge
//! function would break the antisymmetry.

use crate::math::exact::product_error;
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Watertight,
    MollerTrumbore,
    Plane,
}

/// Where a ray meets the plane of its triangle.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<V> {
    pub t: V,
    pub u: V,
    pub v: V,
}

/// The axis along which a direction is longest.
#[inline(always)]
pub fn dominant_axis<T: Real>(d: [T; 3]) -> usize {
    // No `map` over arrays here and below: it is compiled for the baseline alone, and called.
    let (x, y, z) = (d[0].abs(), d[1].abs(), d[2].abs());
    if x > y {
        if x > z { 0 } else { 2 }
    } else if y > z {
        1
    } else {
        2
    }
}

/// Lanes in which [`dominant_axis`] is `axis`.
#[inline(always)]
pub fn along<V: Lanes>(axis: usize, d: [V; 3]) -> V::Mask {
    let (x, y, z) = (d[0].abs(), d[1].abs(), d[2].abs());
    let (xy, xz, yz) = (y.less(x), z.less(x), z.less(y));
    match axis {
        0 => xy & xz,
        1 => !xy & yz,
        _ => (xy & !xz) | (!xy & !yz),
    }
}

/// The cyclic order of axes that ends in the dominant one.
#[inline(always)]
pub fn permutation(kz: usize) -> [usize; 3] {
    const ORDER: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];
    ORDER[kz]
}

#[inline(always)]
fn in_order<T: Real>(k: [usize; 3], v: Vec3<T>) -> Vec3<T> {
    let v = v.to_array();
    Vec3::new(v[k[0]], v[k[1]], v[k[2]])
}

/// A power of two that brings the largest component `d` of a direction to the neighbourhood of one, and its inverse.
/// Scaling by them is exact; so directions of length 1e-20 and 1e20 are as good as unit ones. `d` must be normal.
#[inline(always)]
pub fn direction_scale<V: Lanes>(d: V) -> (V, V) {
    // 126 for single precision: beyond, 2^-e would not be normal.
    let limit = -<V::Elem as Real>::MIN_POSITIVE.split_exponent().1;
    let e = d.split_exponent().1.min(d.like(limit));
    (V::exp2i(-e), V::exp2i(e))
}

/// Lanes in which `x` is neither infinite nor NaN.
#[inline(always)]
pub fn finite<V: Lanes>(x: V) -> V::Mask {
    let zero = x.num(0.0);
    (x * zero).equal(zero)
}

/// Woop's test. Coordinates come permuted, the dominant axis of the ray last; `shear` is
/// `(d_x / d_z, d_y / d_z, 1 / d_z)`. None if no lane crosses its triangle.
///
/// The sign of `p q - r s`, computed from two rounded products, is right or zero, since rounding is monotone. Where
/// it is zero, the difference of the products' rounding errors is the exact value; the paper recomputes in double
/// precision instead, which double itself does not have.
#[inline(always)]
pub fn watertight<V: Lanes>(
    origin: Vec3<V>,
    shear: Vec3<V>,
    a: Vec3<V>,
    b: Vec3<V>,
    c: Vec3<V>,
) -> Option<(V::Mask, Crossing<V>)> {
    let zero = origin.x.num(0.0);
    let (a, b, c) = (a - origin, b - origin, c - origin);
    let (ax, ay) = (a.x - shear.x * a.z, a.y - shear.y * a.z);
    let (bx, by) = (b.x - shear.x * b.z, b.y - shear.y * b.z);
    let (cx, cy) = (c.x - shear.x * c.z, c.y - shear.y * c.z);

    // Edge functions: twice the areas opposite a, b and c.
    let mut ea = cx * by - cy * bx;
    let mut eb = ax * cy - ay * cx;
    let mut ec = bx * ay - by * ax;
    let mut inside = one_side(zero, ea, eb, ec);
    if V::bits(inside) == 0 {
        return None;
    }
    let on_edge = inside & (ea.equal(zero) | eb.equal(zero) | ec.equal(zero));
    if V::bits(on_edge) != 0 {
        ea = V::select(ea.equal(zero), product_error(cx, by) - product_error(cy, bx), ea);
        eb = V::select(eb.equal(zero), product_error(ax, cy) - product_error(ay, cx), eb);
        ec = V::select(ec.equal(zero), product_error(bx, ay) - product_error(by, ax), ec);
        inside = inside & one_side(zero, ea, eb, ec);
    }

    // Quotients rather than products with 1 / det, which overflows on slivers.
    let det = ea + eb + ec;
    let inside = inside & !det.equal(zero);
    if V::bits(inside) == 0 {
        return None;
    }
    let (w, u, v) = (ea / det, eb / det, ec / det);
    let t = (w * a.z + u * b.z + v * c.z) * shear.z;
    Some((inside, Crossing { t, u, v }))
}

/// Lanes in which no two of three edge functions have opposite signs; NaN has none.
#[inline(always)]
fn one_side<V: Lanes>(zero: V, ea: V, eb: V, ec: V) -> V::Mask {
    let negative = ea.less(zero) | eb.less(zero) | ec.less(zero);
    let positive = zero.less(ea) | zero.less(eb) | zero.less(ec);
    !(negative & positive)
}

#[inline(always)]
fn moller_trumbore<T: Real>(
    o: Vec3<T>,
    d: Vec3<T>,
    a: Vec3<T>,
    b: Vec3<T>,
    c: Vec3<T>,
) -> Option<Crossing<T>> {
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    let s = o - a;
    let q = s.cross(e1);
    let (u, v) = (s.dot(p) / det, d.dot(q) / det);
    // Written so that NaN and det = 0 miss.
    let inside = det != T::zero() && u >= T::zero() && v >= T::zero() && u + v <= T::one();
    inside.then(|| Crossing { t: e2.dot(q) / det, u, v })
}

#[inline(always)]
fn plane<T: Real>(o: Vec3<T>, d: Vec3<T>, a: Vec3<T>, b: Vec3<T>, c: Vec3<T>) -> Option<Crossing<T>> {
    let (e1, e2) = (b - a, c - a);
    let n = e1.cross(e2);
    let t = n.dot(a - o) / n.dot(d);
    let p = ((o - a) + d * t).to_array();
    // Drop the coordinate along which the normal is longest: the projected area is largest, so never zero.
    let [i, j, k] = permutation(dominant_axis(n.to_array()));
    let (e1, e2, area) = (e1.to_array(), e2.to_array(), n.to_array()[k]);
    let u = (p[i] * e2[j] - p[j] * e2[i]) / area;
    let v = (e1[i] * p[j] - e1[j] * p[i]) / area;
    let inside = t.is_finite() && u >= T::zero() && v >= T::zero() && u + v <= T::one();
    inside.then_some(Crossing { t, u, v })
}

/// One ray against one triangle; hits lie in the open interval `(t_min, t_max)`. A miss has `t` infinite, `u` and
/// `v` zero; NaN or infinity in the ray or the triangle, or a direction of no length, gives NaN.
#[inline(always)]
pub fn ray_triangle<T: Real>(
    method: Method,
    o: Vec3<T>,
    d: Vec3<T>,
    [a, b, c]: [Vec3<T>; 3],
    t_min: T,
    t_max: T,
) -> Crossing<T> {
    let all = |v: Vec3<T>| finite(v.x) & finite(v.y) & finite(v.z);
    let longest = d.x.abs().max(d.y.abs()).max(d.z.abs());
    let proper = all(o) & all(d) & all(a) & all(b) & all(c) & (longest >= T::MIN_POSITIVE);
    if !proper || t_min.is_nan() || t_max.is_nan() {
        return Crossing { t: T::NAN, u: T::NAN, v: T::NAN };
    }
    let (scale, unscale) = direction_scale(longest);
    let d = d * scale;
    let crossing = match method {
        Method::Watertight => {
            let k = permutation(dominant_axis(d.to_array()));
            let (p, q) = (in_order(k, d), T::one() / in_order(k, d).z);
            let shear = Vec3::new(p.x * q, p.y * q, q);
            // No closure: it would be called outside the dispatch.
            #[allow(clippy::manual_map)]
            match watertight(in_order(k, o), shear, in_order(k, a), in_order(k, b), in_order(k, c)) {
                Some((_, crossing)) => Some(crossing),
                None => None,
            }
        }
        Method::MollerTrumbore => moller_trumbore(o, d, a, b, c),
        Method::Plane => plane(o, d, a, b, c),
    };
    match crossing {
        Some(x) if x.t > t_min * unscale && x.t < Lanes::min(t_max, T::MAX) * unscale => {
            Crossing { t: x.t * scale, ..x }
        }
        _ => Crossing { t: T::INFINITY, u: T::zero(), v: T::zero() },
    }
}
