//! A picture at half the size, again and again, down to one pixel: by mean, by least, or by greatest.
//!
//! A side of odd length 2n + 1 becomes n pixels that each cover 2 + 1/n of the finer ones: the mean weights three by
//! the share of them that is covered, so that the mean of the whole picture stays the same at every level; least and
//! greatest take all three.
//!
//! L. Williams, *Pyramidal Parametrics*, SIGGRAPH 1983. S. Guthe, P. Heckbert, *Non-Power-of-Two Mipmapping*, 2005.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::Real;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fold {
    Mean,
    Least,
    Greatest,
}

/// The next level's side.
pub fn half(n: usize) -> usize {
    (n / 2).max(1)
}

/// The level below a picture of `width` × `height`: `half(width)` × `half(height)`.
pub fn halve<T: Real>(
    watch: &mut dyn Watch,
    fine: &[T],
    [width, height]: [usize; 2],
    channels: usize,
    fold: Fold,
    coarse: &mut [T],
) -> Result<(), Interrupted> {
    let (w, h) = (half(width), half(height));
    assert!(fine.len() == width * height * channels && coarse.len() == w * h * channels, "sizes");
    if coarse.is_empty() {
        return Ok(());
    }
    let plan = Plan { fine, size: [width, height], channels, fold };
    let band = ((1 << 18) / (width * channels).max(1)).clamp(1, 256);
    parallel::for_each(
        watch,
        Rows { data: coarse, width: w * channels },
        band,
        |first, out| dispatch!(_s => plan.rows(first, out.data, w)),
    )
}

struct Plan<'a, T> {
    fine: &'a [T],
    size: [usize; 2],
    channels: usize,
    fold: Fold,
}

impl<T: Real> Plan<'_, T> {
    #[inline(always)]
    fn rows(&self, first: usize, out: &mut [T], w: usize) {
        let c = self.channels;
        for i in 0..out.len() / (w * c) {
            let down = cover::<T>(first + i, self.size[1]);
            for x in 0..w {
                let across = cover::<T>(x, self.size[0]);
                for k in 0..c {
                    out[(i * w + x) * c + k] = self.pixel(&down, &across, k);
                }
            }
        }
    }

    #[inline(always)]
    fn pixel(&self, down: &Cover<T>, across: &Cover<T>, channel: usize) -> T {
        let mut value = match self.fold {
            Fold::Mean => T::zero(),
            _ => self.fine[(down.first * self.size[0] + across.first) * self.channels + channel],
        };
        for j in 0..down.count {
            for i in 0..across.count {
                let (y, x) = (down.first + j, across.first + i);
                let v = self.fine[(y * self.size[0] + x) * self.channels + channel];
                value = match self.fold {
                    Fold::Mean => value + down.weight[j] * across.weight[i] * v,
                    // NaN stays.
                    Fold::Least => {
                        if v < value || v.is_nan() {
                            v
                        } else {
                            value
                        }
                    }
                    Fold::Greatest => {
                        if v > value || v.is_nan() {
                            v
                        } else {
                            value
                        }
                    }
                };
            }
        }
        value
    }
}

/// The finer pixels that a coarser one covers, and the share of each; together 1.
struct Cover<T> {
    first: usize,
    count: usize,
    weight: [T; 3],
}

#[inline(always)]
fn cover<T: Real>(i: usize, n: usize) -> Cover<T> {
    let zero = T::zero();
    if n == 1 {
        return Cover { first: 0, count: 1, weight: [T::one(), zero, zero] };
    }
    let half = T::of(0.5);
    if n.is_multiple_of(2) {
        return Cover { first: 2 * i, count: 2, weight: [half, half, zero] };
    }
    let (m, all) = ((n / 2) as f64, n as f64);
    let (left, right) = ((m - i as f64) / all, (i as f64 + 1.0) / all);
    Cover { first: 2 * i, count: 3, weight: [T::of(left), T::of(m / all), T::of(right)] }
}
