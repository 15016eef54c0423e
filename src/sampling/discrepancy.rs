//! Discrepancies in the mean square: how far the share of points in a box is from its volume, over all boxes of a kind,
//! and over all projections onto fewer axes.
//!
//! Closed forms of sums over pairs. T. T. Warnock, *Computational investigations of low-discrepancy point sets*, 1972
//! (star). F. J. Hickernell, *A generalized discrepancy and quadrature error bound*, 1998 (centred, wrap-around).
//! Y.-D. Zhou, K.-T. Fang, J.-H. Ning, *Mixture discrepancy for quasi-random point sets*, 2013.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Boxes from the origin.
    Star,
    /// Boxes from the nearest corner of the cube.
    Centered,
    /// Boxes on the torus.
    Wraparound,
    /// Between the last two.
    Mixture,
}

impl Kind {
    /// The integral of the pair's factor over both.
    fn both(self) -> f64 {
        match self {
            Kind::Star => 1.0 / 3.0,
            Kind::Centered => 13.0 / 12.0,
            Kind::Wraparound => 4.0 / 3.0,
            Kind::Mixture => 19.0 / 12.0,
        }
    }
    /// Over one of them.
    #[inline(always)]
    fn one(self, x: f64) -> f64 {
        let c = (x - 0.5).abs();
        match self {
            Kind::Star => 0.5 * (1.0 - x * x),
            Kind::Centered => 1.0 + 0.5 * c - 0.5 * c * c,
            Kind::Wraparound => 4.0 / 3.0,
            Kind::Mixture => 5.0 / 3.0 - 0.25 * c - 0.25 * c * c,
        }
    }
    #[inline(always)]
    fn pair(self, x: f64, y: f64) -> f64 {
        let (a, b, d) = ((x - 0.5).abs(), (y - 0.5).abs(), (x - y).abs());
        match self {
            Kind::Star => 1.0 - if x > y { x } else { y },
            Kind::Centered => 1.0 + 0.5 * (a + b - d),
            Kind::Wraparound => 1.5 - d * (1.0 - d),
            Kind::Mixture => 1.875 - 0.25 * (a + b) - 0.75 * d + 0.5 * d * d,
        }
    }
}

/// The square of the discrepancy of points of `dimensions` coordinates, one row each.
pub fn discrepancy(
    watch: &mut dyn Watch,
    kind: Kind,
    points: &[f64],
    dimensions: usize,
) -> Result<f64, Interrupted> {
    let columns: Vec<Vec<f64>> =
        (0..dimensions).map(|d| points.iter().skip(d).step_by(dimensions).copied().collect()).collect();
    let n = points.len() / dimensions;
    // What each point adds: its single term, its own pair, and twice its pairs with those after it.
    let mut sums = vec![[0.0; 2]; n];
    let piece = ((1 << 22) / (n * dimensions).max(1)).max(1);
    parallel::for_each(watch, &mut sums[..], piece, |first, sums| {
        dispatch!(_s => match kind {
            Kind::Star => body(Kind::Star, &columns, first, sums),
            Kind::Centered => body(Kind::Centered, &columns, first, sums),
            Kind::Wraparound => body(Kind::Wraparound, &columns, first, sums),
            Kind::Mixture => body(Kind::Mixture, &columns, first, sums),
        })
    })?;
    let total = |k: usize| sums.iter().map(|s| s[k]).fold((0.0, 0.0), add).0 / n as f64;
    let both = (0..dimensions).fold(1.0, |product, _| product * kind.both());
    let (single, pairs) = (total(0), total(1) / n as f64);
    // The wrap-around's terms of one point cancel that of none twice.
    Ok(if kind == Kind::Wraparound { pairs - both } else { both - 2.0 * single + pairs })
}

/// A sum with what rounding took from it.
fn add((sum, lost): (f64, f64), x: f64) -> (f64, f64) {
    let y = x - lost;
    let next = sum + y;
    (next, (next - sum) - y)
}

const CHUNK: usize = 64;

#[inline(always)]
fn body(kind: Kind, columns: &[Vec<f64>], first: usize, sums: &mut [[f64; 2]]) {
    let n = columns[0].len();
    for k in 0..sums.len() {
        let i = first + k;
        let (mut single, mut own) = (1.0, 1.0);
        for column in columns {
            single *= kind.one(column[i]);
            own *= kind.pair(column[i], column[i]);
        }
        let (mut at, mut later) = (i + 1, 0.0);
        while at < n {
            let count = CHUNK.min(n - at);
            let mut product = [1.0; CHUNK];
            for column in columns {
                let (x, ys) = (column[i], &column[at..at + count]);
                for j in 0..count {
                    product[j] *= kind.pair(x, ys[j]);
                }
            }
            for j in count..CHUNK {
                product[j] = 0.0;
            }
            // A tree of fixed shape.
            let mut width = CHUNK / 2;
            while width > 0 {
                for j in 0..width {
                    product[j] += product[j + width];
                }
                width /= 2;
            }
            later += product[0];
            at += count;
        }
        sums[k] = [single, own + 2.0 * later];
    }
}
