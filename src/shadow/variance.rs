//! Variance shadow maps: from the mean and the mean square of depth, a bound on the share that is not nearer than the
//! receiver.
//!
//! Of all distributions of one mean and variance, at most σ² / (σ² + (t − μ)²) lies at t > μ or beyond (P. Chebyshev;
//! the one-sided form by F. Cantelli). Two depths, and a receiver at the farther, meet the bound.
//!
//! W. Donnelly, A. Lauritzen, *Variance Shadow Maps*, I3D 2006. A. Lauritzen, *Summed-Area Variance Shadow Maps*, GPU
//! Gems 3, 2007 (least variance, reduction of light bleeding).

use crate::real::Lanes;

/// The most that may lie at `t` or beyond; 1 up to the mean. `least` is the least variance that counts.
#[inline(always)]
pub fn chebyshev_bound<V: Lanes>(mean: V, square: V, t: V, least: V) -> V {
    let (zero, one) = (t.num(0.0), t.num(1.0));
    let off = t - mean;
    let variance = square - mean * mean;
    // NaN stays.
    let variance = V::select(variance.less(least), least, variance);
    // Without variance nothing lies beyond the mean, however little beyond.
    let bound = V::select(variance.less_eq(zero), zero, variance / (variance + off * off));
    V::select(off.less_eq(zero) & square.equal(square), one, bound)
}

/// Lit fractions up to `bleeding` count as 0, those above are stretched to [0, 1].
#[inline(always)]
pub fn without_bleeding<V: Lanes>(lit: V, bleeding: V) -> V {
    let (zero, one) = (lit.num(0.0), lit.num(1.0));
    let stretched = (lit - bleeding) / (one - bleeding);
    V::select(stretched.equal(stretched), stretched.max(zero).min(one), stretched)
}
