//! Does a ball overlap an axis-aligned box? The squared distance from its centre to the box against the squared radius,
//! decided exactly. Touching counts.
//!
//! J. Arvo, *A Simple Method for Box-Sphere Intersection Testing*, Graphics Gems, 1990.

use super::predicate::{self, Number, Point};
use crate::real::Real;
use std::cmp::Ordering;

/// The point of the box nearest to `c`; NaN if the box has none.
#[inline(always)]
pub fn nearest<T: Real>(c: [T; 3], [low, high]: [[T; 3]; 2]) -> [T; 3] {
    if !exists([low, high]) {
        return [T::NAN; 3];
    }
    std::array::from_fn(|i| {
        // Ordered so that NaN in `c` comes through.
        if c[i] < low[i] {
            low[i]
        } else if c[i] > high[i] {
            high[i]
        } else {
            c[i]
        }
    })
}

/// Neither empty nor of NaN.
#[inline(always)]
fn exists<T: Real>([low, high]: [[T; 3]; 2]) -> bool {
    low[0] <= high[0] && low[1] <= high[1] && low[2] <= high[2]
}

#[inline(always)]
fn excess<N: Number>(c: Point, p: Point, r: f64) -> N {
    let d = predicate::between::<N>(c, p);
    predicate::dot(&d, &d).minus(&N::of(r).times(&N::of(r)))
}

#[inline(never)]
pub fn sphere_aabb<T: Real>(c: [T; 3], r: T, [low, high]: [[T; 3]; 2]) -> bool {
    let (p, c, r) = (predicate::point(nearest(c, [low, high])), predicate::point(c), r.to_f64());
    if !(predicate::finite(c) && predicate::finite(p) && r >= 0.0) {
        return false;
    }
    r == f64::INFINITY || predicate::sign(excess(c, p, r), || excess(c, p, r)) != Ordering::Greater
}
