//! Error of a picture against its reference, summed over the pixels of a mask.
//!
//! Terms are formed and summed in double: within blocks whose bounds do not depend on the threads, then over blocks
//! with Neumaier's compensation, so that the relative error of a sum stays below 1e-12 for any picture that fits
//! in memory.
//!
//! A. Neumaier, *Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen*, 1974.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};

/// The term of one value `x` against its reference `r`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metric {
    /// (x - r)²
    Square,
    /// (x - r)² / (r² + ε)
    RelativeSquare { epsilon: f64 },
    /// |x - r| / (|x| + |r|), 0 where both are 0
    SymmetricRelative,
}

impl Metric {
    #[inline(always)]
    fn term(self, x: f64, r: f64) -> f64 {
        let d = x - r;
        match self {
            Metric::Square => d * d,
            Metric::RelativeSquare { epsilon } => d * d / (r * r + epsilon),
            Metric::SymmetricRelative => {
                let sum = Lanes::abs(x) + Lanes::abs(r);
                if sum == 0.0 { 0.0 } else { Lanes::abs(d) / sum }
            }
        }
    }
}

/// Pixels in a block.
const BLOCK: usize = 1 << 12;

/// The mean term over the channels of masked pixels; NaN where the mask is empty.
pub fn mean<T: Real>(
    watch: &mut dyn Watch,
    metric: Metric,
    image: &[T],
    reference: &[T],
    channels: usize,
    mask: Option<&[bool]>,
) -> Result<f64, Interrupted> {
    let pixels = if channels == 0 { 0 } else { image.len() / channels };
    let mut blocks = vec![(0.0f64, 0usize); pixels.div_ceil(BLOCK)];
    parallel::for_each(watch, &mut blocks[..], 1, |b, out| {
        let range = b * BLOCK..((b + 1) * BLOCK).min(pixels);
        let mask = mask.map(|m| &m[range.clone()]);
        let values = range.start * channels..range.end * channels;
        let (x, r) = (&image[values.clone()], &reference[values]);
        out[0] = dispatch!(_s => block_sum(metric, x, r, channels, mask));
    })?;
    let (mut sum, mut lost, mut count) = (0.0f64, 0.0f64, 0usize);
    for (s, n) in blocks {
        let t = sum + s;
        lost += if Lanes::abs(sum) >= Lanes::abs(s) { (sum - t) + s } else { (s - t) + sum };
        (sum, count) = (t, count + n);
    }
    // An infinite sum has no low part.
    let total = if sum.is_finite() { sum + lost } else { sum };
    Ok(total / (count * channels) as f64)
}

#[inline(always)]
fn block_sum<T: Real>(
    metric: Metric,
    x: &[T],
    r: &[T],
    channels: usize,
    mask: Option<&[bool]>,
) -> (f64, usize) {
    let (mut sum, mut count) = (0.0, 0);
    for (i, (x, r)) in x.chunks_exact(channels).zip(r.chunks_exact(channels)).enumerate() {
        if mask.is_none_or(|m| m[i]) {
            count += 1;
            for (x, r) in x.iter().zip(r) {
                sum += metric.term(x.to_f64(), r.to_f64());
            }
        }
    }
    (sum, count)
}
