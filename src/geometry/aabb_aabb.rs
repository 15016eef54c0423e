//! Do two axis-aligned boxes overlap? Interval tests on three axes: comparisons alone, so exact. Boxes that touch
//! overlap; a box whose lower corner exceeds its upper one is empty and overlaps nothing, nor does one with NaN.

use crate::real::Real;

#[inline(always)]
pub fn aabb_aabb<T: Real>(a: [[T; 3]; 2], b: [[T; 3]; 2]) -> bool {
    let ([al, ah], [bl, bh]) = (a, b);
    let mut overlap = true;
    for i in 0..3 {
        overlap &= (al[i] <= bh[i]) & (bl[i] <= ah[i]) & (al[i] <= ah[i]) & (bl[i] <= bh[i]);
    }
    overlap
}

/// How far apart the boxes are along each axis; negative is the depth to which they overlap there.
#[inline(always)]
pub fn gaps<T: Real>(a: [[T; 3]; 2], b: [[T; 3]; 2]) -> [T; 3] {
    let ([al, ah], [bl, bh]) = (a, b);
    std::array::from_fn(|i| {
        let (left, right) = (bl[i] - ah[i], al[i] - bh[i]);
        if left.is_nan() || right.is_nan() { T::NAN } else { left.max(right) }
    })
}
