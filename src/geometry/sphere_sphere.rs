//! Do two balls overlap? Squared distance against the squared sum of radii, decided exactly. Balls that touch overlap; a
//! negative radius is an empty ball.

use super::predicate::{self, Number, Point};
use crate::real::Real;
use std::cmp::Ordering;

#[inline(always)]
fn excess<N: Number>(a: Point, ra: f64, b: Point, rb: f64) -> N {
    let d = predicate::between::<N>(a, b);
    let reach = N::of(ra).plus(&N::of(rb));
    predicate::dot(&d, &d).minus(&reach.times(&reach))
}

#[inline(never)]
pub fn sphere_sphere<T: Real>(a: [T; 3], ra: T, b: [T; 3], rb: T) -> bool {
    let (a, ra, b, rb) = (predicate::point(a), ra.to_f64(), predicate::point(b), rb.to_f64());
    if !(predicate::finite(a) && predicate::finite(b) && ra >= 0.0 && rb >= 0.0) {
        return false;
    }
    ra + rb == f64::INFINITY
        || predicate::sign(excess(a, ra, b, rb), || excess(a, ra, b, rb)) != Ordering::Greater
}
