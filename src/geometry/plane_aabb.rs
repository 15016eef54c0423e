//! On which side of a plane `n · x + d = 0` does an axis-aligned box lie? The corners farthest along and against the
//! normal decide, exactly: 1 if both are in front (where `n` points), -1 if both are behind, 0 if the plane meets the
//! box, be it in one point. What is no box or no number counts as met.

use super::predicate::{self, Number, Point};
use crate::real::Real;
use std::cmp::Ordering;

#[inline(always)]
pub fn height<N: Number>(n: Point, d: f64, p: Point) -> N {
    predicate::dot(&predicate::vector::<N>(n), &predicate::vector(p)).plus(&N::of(d))
}

/// The sign of `n · p + d`.
#[inline(always)]
pub fn side(n: Point, d: f64, p: Point) -> Ordering {
    predicate::sign(height(n, d, p), || height(n, d, p))
}

#[inline(never)]
pub fn plane_aabb<T: Real>(plane: [T; 4], [low, high]: [[T; 3]; 2]) -> i8 {
    let [a, b, c, d] = predicate::four(plane);
    let (n, low, high) = ([a, b, c], predicate::point(low), predicate::point(high));
    let exists = (0..3).all(|i| low[i] <= high[i]);
    if !(exists && predicate::finite([a, b, c, d]) && predicate::finite(low) && predicate::finite(high)) {
        return 0;
    }
    let pick = |i: usize, a: &Point, b: &Point| if n[i] > 0.0 { a[i] } else { b[i] };
    let near = [pick(0, &low, &high), pick(1, &low, &high), pick(2, &low, &high)];
    if side(n, d, near) == Ordering::Greater {
        return 1;
    }
    let far = [pick(0, &high, &low), pick(1, &high, &low), pick(2, &high, &low)];
    -((side(n, d, far) == Ordering::Less) as i8)
}

/// The signed distance of the box's centre from the plane, and half the extent of the box along the normal; NaN if there
/// is no box.
#[inline(never)]
pub fn interval<T: Real>(plane: [T; 4], [low, high]: [[T; 3]; 2]) -> [T; 2] {
    let [a, b, c, d] = predicate::four(plane);
    let (low, high) = (predicate::point(low), predicate::point(high));
    if !(0..3).all(|i| low[i] <= high[i]) {
        return [T::NAN; 2];
    }
    let (mut centre, mut radius) = (d, 0.0);
    for (i, n) in [a, b, c].into_iter().enumerate() {
        centre += n * (0.5 * (low[i] + high[i]));
        radius += n.abs() * (0.5 * (high[i] - low[i]));
    }
    let length = (a * a + b * b + c * c).sqrt();
    [T::of(centre / length), T::of(radius / length)]
}
