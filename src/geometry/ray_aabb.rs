//! A ray against an axis-aligned box: the interval common to three slabs, by three methods.
//!
//! - [`Method::Exact`]: intervals are rounded, but whether they overlap is decided exactly: where the rounded borders of
//!   two slabs lie within their rounding errors, the sign of `(p - o) d' - (p' - o') d` decides. The box is closed.
//! - [`Method::Conservative`]: the exit is moved out by the rounding error, so that no box is ever missed, which is what
//!   a hierarchy needs. T. Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013.
//! - [`Method::Slabs`]: products with the inverse direction, as in textbooks; rays within a face meet 0 · ∞.
//!   T. Kay, J. Kajiya, *Ray Tracing Complex Scenes*, SIGGRAPH 1986.

use crate::math::exact::{all_finite, exponent, largest, scaled, total, two_difference, two_product};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Exact,
    Conservative,
    Slabs,
}

/// What a line has in common with a box.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<T> {
    /// The first parameter of the ray's interval within the box; infinite if there is none.
    pub t: T,
    /// The line's stay in the box; `(inf, -inf)` if it misses.
    pub enter: T,
    pub exit: T,
    /// Where the line enters and leaves each slab.
    pub near: [T; 3],
    pub far: [T; 3],
    /// The faces through which it enters and leaves, in the order +x -x +y -y +z -z; -1 if it does not.
    pub faces: [i32; 2],
}

impl<T: Real> Crossing<T> {
    pub const NAN: Self =
        Self { t: T::NAN, enter: T::NAN, exit: T::NAN, near: [T::NAN; 3], far: [T::NAN; 3], faces: [-1; 2] };
}

/// The least and the largest of three, with their axes.
#[inline(always)]
fn last<T: Real>(v: [T; 3], sign: T) -> (usize, T) {
    let mut k = 0;
    for i in 1..3 {
        if sign * v[i] > sign * v[k] {
            k = i;
        }
    }
    (k, v[k])
}

/// What slabs have in common; `met` tells whether it is more than nothing, given the last entry and the first exit.
/// `forward` tells for each axis whether the line runs towards the upper face.
#[inline(always)]
pub(crate) fn common<T: Real>(
    near: [T; 3],
    far: [T; 3],
    forward: [bool; 3],
    (along, t_min, t_max): (T, T, T),
    met: impl Fn(T, T) -> bool,
) -> Crossing<T> {
    let ((ke, enter), (kx, exit)) = (last(near, T::one()), last(far, -T::one()));
    let resize = |v: [T; 3]| v.map(|x| scaled(x, along));
    let (near, far) = (resize(near), resize(far));
    if !met(enter, exit) {
        let (t, enter, exit) = (T::INFINITY, T::INFINITY, -T::INFINITY);
        return Crossing { t, enter, exit, near, far, faces: [-1; 2] };
    }
    let (enter, exit) = (scaled(enter, along), scaled(Lanes::max(exit, enter), along));
    let t = if enter <= t_max && exit >= t_min { Lanes::max(enter, t_min) } else { T::INFINITY };
    let face =
        |t: T, k: usize, upper: bool| if t.is_finite() { (2 * k + usize::from(!upper)) as i32 } else { -1 };
    let faces = [face(enter, ke, !forward[ke]), face(exit, kx, forward[kx])];
    Crossing { t, enter, exit, near, far, faces }
}

/// One ray against one box. Infinite corners are fine. NaN, an infinite origin or direction, or a direction of no
/// length give NaN; a box whose lower corner exceeds the upper one is missed.
#[inline(always)]
pub fn ray_aabb<T: Real>(
    method: Method,
    origin: Vec3<T>,
    direction: Vec3<T>,
    [lower, upper]: [[T; 3]; 2],
    t_min: T,
    t_max: T,
) -> Crossing<T> {
    let longest = largest(direction);
    let mut proper = all_finite(origin) & all_finite(direction) & (longest >= T::MIN_POSITIVE);
    let mut empty = false;
    for i in 0..3 {
        proper &= !lower[i].is_nan() & !upper[i].is_nan();
        empty |= lower[i] > upper[i];
    }
    if !proper || t_min.is_nan() || t_max.is_nan() {
        return Crossing::NAN;
    }
    let e = exponent(longest);
    let (o, d) = (origin.to_array(), (direction * T::exp2i(-e)).to_array());
    let (mut near, mut far) = ([-T::INFINITY; 3], [T::INFINITY; 3]);
    for i in 0..3 {
        if method == Method::Slabs {
            let inverse = T::one() / d[i];
            let (a, b) = ((lower[i] - o[i]) * inverse, (upper[i] - o[i]) * inverse);
            (near[i], far[i]) = (Lanes::min(a, b), Lanes::max(a, b));
        } else if d[i] != T::zero() {
            let (a, b) = if d[i] > T::zero() { (lower[i], upper[i]) } else { (upper[i], lower[i]) };
            (near[i], far[i]) = ((a - o[i]) / d[i], (b - o[i]) / d[i]);
        } else if !(lower[i] <= o[i] && o[i] <= upper[i]) {
            empty = true;
            (near[i], far[i]) = (T::INFINITY, -T::INFINITY);
        }
    }
    let forward = d.map(|x| x > T::zero());
    common(near, far, forward, (-e, t_min, t_max), |enter, exit| match method {
        _ if empty => false,
        // Each border carries two roundings: a machine epsilon of itself at most.
        Method::Conservative => enter <= exit + exit.abs() * (T::EPSILON * T::of(3.0)),
        Method::Slabs => enter <= exit,
        Method::Exact => overlap(near, far, o, d, [lower, upper]),
    })
}

/// Whether every slab is entered before any other is left.
#[inline(always)]
fn overlap<T: Real>(near: [T; 3], far: [T; 3], o: [T; 3], d: [T; 3], corners: [[T; 3]; 2]) -> bool {
    for i in 0..3 {
        for j in 0..3 {
            let slack = (near[i].abs() + far[j].abs()) * (T::EPSILON * T::of(2.0));
            if i == j || near[i] + slack < far[j] {
                continue;
            }
            // Infinite borders need no more than a comparison.
            let settled = near[i] - slack > far[j] || !slack.is_finite();
            if (settled && near[i] > far[j]) || (!settled && after(i, j, o, d, corners)) {
                return false;
            }
        }
    }
    true
}

/// Whether the line enters slab `i` after it has left slab `j`, exactly.
#[inline(never)]
fn after<T: Real>(i: usize, j: usize, o: [T; 3], d: [T; 3], corners: [[T; 3]; 2]) -> bool {
    let (p, q) = (corners[usize::from(d[i] < T::zero())][i], corners[usize::from(d[j] > T::zero())][j]);
    // (p - o_i) / d_i > (q - o_j) / d_j, times both divisors.
    let (si, sj) = (d[i].abs(), d[j].abs());
    let (mut a, mut b) = (two_difference(p, o[i]), two_difference(q, o[j]));
    if d[i] < T::zero() {
        a = (-a.0, -a.1);
    }
    if d[j] > T::zero() {
        b = (-b.0, -b.1);
    }
    let [x, y] = [two_product(a.0, sj), two_product(a.1, sj)];
    let [z, w] = [two_product(b.0, si), two_product(b.1, si)];
    total([x.0, z.0, y.0, w.0, x.1, z.1, y.1, w.1]) > T::zero()
}
