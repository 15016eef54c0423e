//! Barycentric coordinates on the screen into those on the triangle before projection, and back: weights over, or times,
//! the vertices' `w`, brought to the sum of one. Attributes are interpolated with the former.
//!
//! `w` is taken relative to the smallest, or the largest, so that no size of it overflows.
//!
//! P. Heckbert, H. Moreton, *Interpolation for Polygon Texture Mapping and Shading*, 1991.

use crate::real::{Lanes, Real};

/// `weights` on the screen into those on the triangle; with `inverse` back. A sum of zero has no point: NaN.
#[inline(always)]
pub fn perspective_barycentric<T: Real>(inverse: bool, weights: [T; 3], w: [T; 3]) -> [T; 3] {
    let size = w.map(Lanes::abs);
    let factors = if inverse {
        let largest = Lanes::max(Lanes::max(size[0], size[1]), size[2]);
        w.map(|x| x / largest)
    } else {
        let smallest = Lanes::min(Lanes::min(size[0], size[1]), size[2]);
        // A vertex in the eye's plane takes all.
        w.map(|x| if x.abs() == smallest { T::one().copysign(x) } else { smallest / x })
    };
    let scaled: [T; 3] = std::array::from_fn(|i| weights[i] * factors[i]);
    let sum = scaled[0] + scaled[1] + scaled[2];
    let proper = sum != T::zero()
        && sum.is_finite()
        && size[0].is_finite()
        && size[1].is_finite()
        && size[2].is_finite();
    scaled.map(|x| if proper { x / sum } else { T::NAN })
}
