//! Variance shadow maps: from the mean and the mean square of depth, a bound on the share that is not nearer than the
//! receiver.
//!
//! Of all distributions of one mean and variance, at most σ² / (σ² + (t − μ)²) lies at t > μ or beyond (P. Chebyshev;
//! the one-sided form by F. Cantelli). Two depths, and a receiver at the farther, meet the bound.
//!
//! W. Donnelly, A. Lauritzen, *Variance Shadow Maps*, I3D 2006. A. Lauritzen, *Summed-Area Variance Shadow Maps*, GPU
//! Gems
//! 3, 2007 (least variance, reduction of light bleeding).

use crate::real::{Lanes, Real};

/// The most that may lie at `t` or beyond; 1 up to the mean. `least` is the least variance that counts.
#[inline(always)]
pub fn chebyshev_bound<T: Real>(mean: T, square: T, t: T, least: T) -> T {
    let off = t - mean;
    let variance = square - mean * mean;
    // NaN stays.
    let variance = if variance < least { least } else { variance };
    if off <= T::zero() && !square.is_nan() { T::one() } else { variance / (variance + off * off) }
}

/// Lit fractions up to `bleeding` count as 0, those above are stretched to [0, 1].
#[inline(always)]
pub fn without_bleeding<T: Real>(lit: T, bleeding: T) -> T {
    let stretched = (lit - bleeding) / (T::one() - bleeding);
    if stretched.is_nan() { stretched } else { Lanes::min(Lanes::max(stretched, T::zero()), T::one()) }
}
