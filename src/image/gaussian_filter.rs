//! The Gaussian filter, as two passes along rows and columns.
//!
//! Rows are filtered into a window of a few, which the columns' pass reads while it is in the cache: the picture is
//! read once and written once.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::Real;
use crate::simd::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// What lies beyond the picture's border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Border {
    /// The nearest pixel.
    Nearest,
    /// The picture mirrored about the border: d c b a | a b c d | d c b a.
    Reflect,
    /// The picture again.
    Wrap,
}

impl Border {
    /// The pixel that stands for `i` of a line of `n`.
    #[inline(always)]
    pub fn at(self, i: isize, n: usize) -> usize {
        let m = n as isize;
        (match self {
            Border::Nearest => i.clamp(0, m - 1),
            Border::Wrap => i.rem_euclid(m),
            Border::Reflect => {
                let k = i.rem_euclid(2 * m);
                if k < m { k } else { 2 * m - 1 - k }
            }
        }) as usize
    }
}

/// Weights of the pixels at distance 0, 1, 2 …, whose sum to both sides is 1. A sigma of 0 leaves the picture as it is.
pub fn weights<T: Real>(sigma: f64, truncate: f64) -> Vec<T> {
    let reach = (truncate * sigma + 0.5).floor() as usize;
    let raw: Vec<f64> = (0..=reach)
        .map(|i| {
            if i == 0 {
                1.0
            } else {
                let x = i as f64 / sigma;
                crate::math::exp(-0.5 * x * x)
            }
        })
        .collect();
    let sum = raw[0] + 2.0 * raw[1..].iter().sum::<f64>();
    raw.iter().map(|&w| T::of(w / sum)).collect()
}

/// Rows of output in a piece of work.
const BAND: usize = 64;
/// Values of a row that are filtered down together.
const STRIP: usize = 256;

/// Filters every channel of a picture of `width` × `height`; `columns` and `rows` are the weights across and down.
pub fn gaussian_filter<T: Real>(
    watch: &mut dyn Watch,
    image: &[T],
    [width, height]: [usize; 2],
    channels: usize,
    [across, downward]: [&[T]; 2],
    border: Border,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let row = width * channels;
    assert!(image.len() == row * height && out.len() == image.len(), "sizes");
    if row == 0 {
        return Ok(());
    }
    let reach = downward.len() - 1;
    // Bands well above the reach: what is filtered twice at their borders stays a small share.
    let band = BAND.max(4 * reach).min(height.max(1));
    // Some tens of milliseconds.
    let long = row * band * (across.len() + downward.len()) > 1 << 26;
    parallel::for_each_stoppable(watch, Rows { data: out, width: row }, band, long, |first, out, stop| {
        let rows = out.data.len() / row;
        let mut line = vec![T::zero(); row + 2 * (across.len() - 1) * channels];
        let mut done = vec![T::zero(); stride(row) * (rows + 2 * reach)];
        let plan = Plan { image, width, height, channels, across, downward, border };
        dispatch!(s => plan.band(s, first, rows, &mut line, &mut done, out.data, stop));
    })
}

/// Rows of the window lie apart by no power of two, or they would share few lines of the cache.
#[inline(always)]
fn stride(row: usize) -> usize {
    row.next_multiple_of(16) + 16
}

struct Plan<'a, T> {
    image: &'a [T],
    width: usize,
    height: usize,
    channels: usize,
    across: &'a [T],
    downward: &'a [T],
    border: Border,
}

impl<T: Real> Plan<'_, T> {
    /// Rows `first`… of the result: each row around them across, then down. Returns soon once `stop` is set.
    #[inline(always)]
    fn band<S: Simd>(
        &self,
        s: S,
        first: usize,
        rows: usize,
        line: &mut [T],
        done: &mut [T],
        out: &mut [T],
        stop: &AtomicBool,
    ) {
        let row = self.width * self.channels;
        let (stride, reach) = (stride(row), self.downward.len() - 1);
        for i in 0..rows + 2 * reach {
            if stop.load(Ordering::Relaxed) {
                return;
            }
            let y = self.border.at(first as isize + i as isize - reach as isize, self.height);
            self.spread(y, line);
            correlate(s, line, self.channels, self.across, &mut done[i * stride..i * stride + row]);
        }
        // Strips of columns, whose rows within the reach fit into the first cache.
        let mut x = 0;
        while x < row {
            let wide = STRIP.min(row - x);
            for i in 0..rows {
                if stop.load(Ordering::Relaxed) {
                    return;
                }
                let end = (i + 2 * reach) * stride + x + wide;
                correlate(
                    s,
                    &done[i * stride + x..end],
                    stride,
                    self.downward,
                    &mut out[i * row + x..i * row + x + wide],
                );
            }
            x += wide;
        }
    }

    /// A row with what lies beyond its ends.
    #[inline(always)]
    fn spread(&self, y: usize, line: &mut [T]) {
        let (c, reach, row) = (self.channels, self.across.len() - 1, self.width * self.channels);
        let source = &self.image[y * row..(y + 1) * row];
        line[reach * c..reach * c + row].copy_from_slice(source);
        for i in 0..reach {
            let left = self.border.at(i as isize - reach as isize, self.width);
            let right = self.border.at((self.width + i) as isize, self.width);
            for k in 0..c {
                line[i * c + k] = source[left * c + k];
                line[(reach + self.width + i) * c + k] = source[right * c + k];
            }
        }
    }
}

/// `out[i]` is the weighted sum of `line[i + k · step]`, the middle of the weights at the middle of the reach. Pairs at one
/// distance are added first: half the multiplications.
#[inline(always)]
fn correlate<T: Real, S: Simd>(s: S, line: &[T], step: usize, weights: &[T], out: &mut [T]) {
    let (n, reach) = (out.len(), weights.len() - 1);
    assert!(line.len() >= n + 2 * reach * step, "sizes");
    let mut i = 0;
    while i + 4 * LANES <= n {
        let at = i + reach * step;
        let w = all::<T, S>(s, weights[0]);
        let mut sums = [
            w * load(s, line, at),
            w * load(s, line, at + LANES),
            w * load(s, line, at + 2 * LANES),
            w * load(s, line, at + 3 * LANES),
        ];
        let mut j = 1;
        while j <= reach {
            let (w, a, b) = (all::<T, S>(s, weights[j]), at - j * step, at + j * step);
            for k in 0..4 {
                sums[k] += w * (load(s, line, a + k * LANES) + load(s, line, b + k * LANES));
            }
            j += 1;
        }
        for k in 0..4 {
            out[i + k * LANES..i + (k + 1) * LANES].copy_from_slice(sums[k].as_slice());
        }
        i += 4 * LANES;
    }
    while i < n {
        let mut sum = weights[0] * line[i + reach * step];
        let mut j = 1;
        while j <= reach {
            sum += weights[j] * (line[i + (reach - j) * step] + line[i + (reach + j) * step]);
            j += 1;
        }
        out[i] = sum;
        i += 1;
    }
}

const LANES: usize = 8;

#[inline(always)]
fn all<T: Real, S: Simd>(s: S, v: T) -> T::V8<S> {
    <T::V8<S> as SimdBase<S>>::splat(s, v)
}

#[inline(always)]
fn load<T: Real, S: Simd>(s: S, line: &[T], at: usize) -> T::V8<S> {
    <T::V8<S> as SimdBase<S>>::from_slice(s, &line[at..at + LANES])
}
