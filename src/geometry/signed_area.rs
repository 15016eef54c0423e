//! The area of a polygon in the plane, positive counter-clockwise: half the sum of cross products along its border, with
//! the rounding errors of products and sums carried along, so that a polygon far from the origin keeps its digits.
//!
//! A. Meister, *Generalia de genesi figurarum planarum*, 1769.

use crate::math::exact::{two_product, two_sum};
use crate::real::Real;

/// NaN or infinity gives NaN.
pub fn signed_area<T: Real>(polygon: &[[T; 2]]) -> T {
    let Some(mut a) = polygon.last() else { return T::zero() };
    let (mut sum, mut lost) = (T::zero(), T::zero());
    for b in polygon {
        for (p, q, sign) in [(a[0], b[1], T::one()), (a[1], b[0], -T::one())] {
            let (product, product_low) = two_product(p * sign, q);
            let (total, low) = two_sum(sum, product);
            sum = total;
            lost += low + product_low;
        }
        a = b;
    }
    let area = (sum + lost) * T::of(0.5);
    if area.is_finite() { area } else { T::NAN }
}
