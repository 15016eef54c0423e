//! The nearest points of two segments, also where they are parallel, overlap, cross or are points.
//!
//! A pair of nearest points has an end of a segment in it, or both lie inside and on the common normal. All five
//! candidates are evaluated and the nearest is taken: a near-parallel pair of lines, whose common normal is uncertain,
//! is then held by the ends. No tolerance takes part.
//!
//! Compare D. Eberly, *Robust Computation of Distance Between Line Segments*, 2018; C. Ericson, *Real-Time Collision
//! Detection*, 2005, section 5.1.9.

use super::line_line::Nearest;
use crate::math::exact::{all_finite, cross, dot, exponent, largest, scaled};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// The parameter in [0, 1] of the point of the segment `p + t d` nearest to the origin.
#[inline(always)]
pub(crate) fn nearest_on_segment<T: Real>(p: Vec3<T>, d: Vec3<T>) -> T {
    let squared = d.dot(d);
    let t = -dot(p, d) / squared;
    // A segment without length has any.
    if squared > T::zero() { t.clamp01() } else { T::zero() }
}

/// `s` and `t` in [0, 1] of the points `a + s (b - a)` and `c + t (d - c)`. NaN or infinity give NaN.
#[inline(always)]
pub fn segment_segment<T: Real>([a, b]: [Vec3<T>; 2], [c, d]: [Vec3<T>; 2]) -> Nearest<T> {
    if !(all_finite(a) & all_finite(b) & all_finite(c) & all_finite(d)) {
        return Nearest::NAN;
    }
    let (u, v, w) = (b - a, d - c, c - a);
    // A power of two, so that no digit is lost.
    let e = exponent(Lanes::max(Lanes::max(largest(u), largest(v)), largest(w)));
    let [u, v, w] = [u, v, w].map(|x| x * T::exp2i(-e));

    // From the point at s to the point at t.
    let between = |s: T, t: T| w + v * t - u * s;
    let (zero, one) = (T::zero(), T::one());
    let across = [
        (zero, nearest_on_segment(w, v)),
        (one, nearest_on_segment(w - u, v)),
        (nearest_on_segment(-w, u), zero),
        (nearest_on_segment(-(w + v), u), one),
    ];
    let mut best = (across[0], between(across[0].0, across[0].1).length_squared());
    let mut offer = |s: T, t: T| {
        let squared = between(s, t).length_squared();
        if squared < best.1 {
            best = ((s, t), squared);
        }
    };
    for (s, t) in &across[1..] {
        offer(*s, *t);
    }
    let n = cross(u, v);
    let size = largest(n);
    let parallel = size == zero;
    if !parallel {
        let en = exponent(size);
        let n = n * T::exp2i(-en);
        let squared = n.dot(n);
        let s = scaled(dot(n, cross(w, v)) / squared, -en);
        let t = scaled(dot(n, cross(w, u)) / squared, -en);
        if s >= zero && s <= one && t >= zero && t <= one {
            // Almost parallel, both are uncertain along the segments: each in turn goes to the point across.
            let t = nearest_on_segment(w - u * s, v);
            let s = nearest_on_segment(-(w + v * t), u);
            offer(s, t);
        }
    }
    let ((s, t), squared) = best;
    // From the nearer end, so that both ends are exact.
    let point = |p: Vec3<T>, q: Vec3<T>, t: T| {
        if t + t <= one { p + (q - p) * t } else { q - (q - p) * (one - t) }
    };
    let points = [point(a, b, s), point(c, d, t)];
    Nearest { s, t, distance: scaled(squared.sqrt(), e), points, parallel }
}
