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
    let pixels = image.len().checked_div(channels).unwrap_or(0);
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

/// Partial sums, each over every eighth value, so that additions need not wait for one another.
const STRIPES: usize = 8;

#[inline(always)]
fn block_sum<T: Real>(
    metric: Metric,
    x: &[T],
    r: &[T],
    channels: usize,
    mask: Option<&[bool]>,
) -> (f64, usize) {
    let Some(mask) = mask else {
        return (stripes_sum(metric, x, r), x.len() / channels);
    };
    let (mut sum, mut count) = (0.0, 0);
    for (i, (x, r)) in x.chunks_exact(channels).zip(r.chunks_exact(channels)).enumerate() {
        if mask[i] {
            count += 1;
            for (x, r) in x.iter().zip(r) {
                sum += metric.term(x.to_f64(), r.to_f64());
            }
        }
    }
    (sum, count)
}

#[inline(always)]
fn stripes_sum<T: Real>(metric: Metric, x: &[T], r: &[T]) -> f64 {
    // The metric is chosen outside the loop, so that each loop is straight-line.
    match metric {
        Metric::Square => stripes(x, r, |x, r| Metric::Square.term(x, r)),
        Metric::RelativeSquare { epsilon } => {
            stripes(x, r, |x, r| Metric::RelativeSquare { epsilon }.term(x, r))
        }
        Metric::SymmetricRelative => stripes(x, r, |x, r| Metric::SymmetricRelative.term(x, r)),
    }
}

#[inline(always)]
fn stripes<T: Real>(x: &[T], r: &[T], term: impl Fn(f64, f64) -> f64) -> f64 {
    let mut sums = [0.0; STRIPES];
    let ((x, x_rest), (r, r_rest)) = (x.as_chunks::<STRIPES>(), r.as_chunks::<STRIPES>());
    for (x, r) in x.iter().zip(r) {
        for l in 0..STRIPES {
            sums[l] += term(x[l].to_f64(), r[l].to_f64());
        }
    }
    for (l, (x, r)) in x_rest.iter().zip(r_rest).enumerate() {
        sums[l] += term(x.to_f64(), r.to_f64());
    }
    sums.iter().sum()
}
