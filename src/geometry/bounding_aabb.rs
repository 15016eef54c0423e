//! The smallest axis-aligned box around points: least and greatest coordinates, exact. NaN in any coordinate gives NaN.

use crate::real::Real;

#[inline(always)]
pub fn bounding_aabb<T: Real>(points: &[[T; 3]]) -> [[T; 3]; 2] {
    let mut b = [[T::INFINITY; 3], [-T::INFINITY; 3]];
    // NaN in, NaN out: comparisons would pass it over.
    let mut nan = T::zero();
    for p in points {
        for k in 0..3 {
            b[0][k] = if p[k] < b[0][k] { p[k] } else { b[0][k] };
            b[1][k] = if p[k] > b[1][k] { p[k] } else { b[1][k] };
            nan += if p[k].is_nan() { p[k] } else { T::zero() };
        }
    }
    if nan.is_nan() { [[T::NAN; 3]; 2] } else { b }
}
