//! What lookups into maps of moments share: the mean of the moments over a part of the map.
//!
//! The map is plain (filtered beforehand; read between four texels), or a chain of mips (read between eight, at the
//! level whose kernel has the variance of the box asked for), or a table of sums (the box itself, with texels at its
//! border by the share that it covers).

use crate::math;
use crate::real::{Lanes, Real};
use crate::shadow::anchor::{all, lanes};
use crate::shadow::lookup::LOT;
use crate::shadow::moment_map::{Stored, Warp, powers};
use crate::simd::*;

/// Where a level lies among the values, in texels.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    pub first: usize,
    pub width: usize,
    pub height: usize,
}

/// A level as it is looked up: its size against the first's, and its last texel.
#[derive(Clone, Copy)]
struct Scaled<T> {
    level: Level,
    share: [T; 2],
    last: [T; 2],
}

/// Moments of `C` channels.
pub struct Filtered<'a, T, E, const C: usize> {
    values: &'a [[E; C]],
    /// One, or those of a chain; of a table its own size.
    levels: Vec<Scaled<T>>,
    table: bool,
    /// Texels of this map in one of the depth map.
    scale: T,
    pub warp: Warp<T>,
}

impl<'a, T: Real, E: Stored, const C: usize> Filtered<'a, T, E, C> {
    /// `None` unless the values hold all levels; a table has one row and one column more than texels.
    pub fn new(
        values: &'a [[E; C]],
        levels: Vec<Level>,
        table: bool,
        reduce: usize,
        warp: Warp<T>,
    ) -> Option<Self> {
        let least = if table { 2 } else { 1 };
        let mut fits = !levels.is_empty() && reduce > 0;
        for l in &levels {
            let end = l.width.checked_mul(l.height).and_then(|n| n.checked_add(l.first));
            fits &= l.width.min(l.height) >= least && end.is_some_and(|n| n <= values.len());
            fits &= l.width.max(l.height) < 1 << 22;
        }
        if !fits {
            return None;
        }
        let whole = levels[0];
        let scaled = |level: Level| Scaled {
            level,
            share: [
                T::of(level.width as f64 / whole.width as f64),
                T::of(level.height as f64 / whole.height as f64),
            ],
            last: [T::of((level.width - 1) as f64), T::of((level.height - 1) as f64)],
        };
        let levels = levels.into_iter().map(scaled).collect();
        Some(Filtered { values, levels, table, scale: T::one() / T::of(reduce as f64), warp })
    }

    /// The means, as powers whatever they are stored as, over boxes about (x, y) of the given half sides, all in texels
    /// of the depth map; of those receivers whose bit is set.
    #[inline(always)]
    pub fn means<S: Simd>(
        &self,
        s: S,
        live: u64,
        (x, y): (T::V8<S>, T::V8<S>),
        half: [T::V8<S>; 2],
    ) -> [T::V8<S>; 4] {
        let scale = all::<T, S>(s, self.scale);
        let (x, y, half) = (x * scale, y * scale, [half[0] * scale, half[1] * scale]);
        let level = self.level(s, half);
        let mut out = [[T::zero(); LOT]; 4];
        for k in 0..LOT {
            if live >> k & 1 == 0 {
                continue;
            }
            let (x, y) = (x.as_slice()[k], y.as_slice()[k]);
            let m = if self.table {
                self.of_box(x, y, [half[0].as_slice()[k], half[1].as_slice()[k]])
            } else if self.levels.len() > 1 {
                self.of_mips(x, y, level.as_slice()[k])
            } else {
                self.between(&self.levels[0], x, y)
            };
            let mut four = [T::zero(); 4];
            four[..C].copy_from_slice(&m);
            let four = if E::QUANTIZED { powers(four) } else { four };
            for c in 0..4 {
                out[c][k] = four[c];
            }
        }
        [
            lanes::<T, S>(s, out[0]),
            lanes::<T, S>(s, out[1]),
            lanes::<T, S>(s, out[2]),
            lanes::<T, S>(s, out[3]),
        ]
    }

    /// The mip whose kernel has the variance of a box: a texel of width w, read between its neighbours, has that of a
    /// box of width √3 w.
    #[inline(always)]
    fn level<S: Simd>(&self, s: S, half: [T::V8<S>; 2]) -> T::V8<S> {
        if self.table || self.levels.len() == 1 {
            return all::<T, S>(s, T::zero());
        }
        let wide = Lanes::max(half[0], half[1]) * all::<T, S>(s, T::of(2.0 / 1.732_050_807_568_877_2));
        let level = math::ln(Lanes::max(wide, all::<T, S>(s, T::one())));
        let level = level * all::<T, S>(s, T::of(1.0 / std::f64::consts::LN_2));
        Lanes::min(level, all::<T, S>(s, T::of((self.levels.len() - 1) as f64)))
    }

    #[inline(always)]
    fn texel(&self, at: usize) -> [T; C] {
        let v = self.values[at];
        let mut out = [T::zero(); C];
        for c in 0..C {
            out[c] = v[c].real();
        }
        out
    }

    /// Between the four texels of a level about a place of the first; beyond the border lies the nearest texel.
    #[inline(always)]
    fn between(&self, at: &Scaled<T>, x: T, y: T) -> [T; C] {
        let level = at.level;
        let (x0, x1, fx) = neighbours(x * at.share[0] - T::of(0.5), at.last[0]);
        let (y0, y1, fy) = neighbours(y * at.share[1] - T::of(0.5), at.last[1]);
        let (up, down) = (level.first + y0 * level.width, level.first + y1 * level.width);
        let (a, b) = (self.texel(up + x0), self.texel(up + x1));
        let (c, d) = (self.texel(down + x0), self.texel(down + x1));
        let mut out = [T::zero(); C];
        for k in 0..C {
            let (upper, lower) = (a[k] + (b[k] - a[k]) * fx, c[k] + (d[k] - c[k]) * fx);
            out[k] = upper + (lower - upper) * fy;
        }
        out
    }

    /// Between two levels.
    #[inline(always)]
    fn of_mips(&self, x: T, y: T, level: T) -> [T; C] {
        let low = level.floor();
        let (l, share) = (low.to_f64() as usize, level - low);
        let fine = self.between(&self.levels[l], x, y);
        if !(share > T::zero()) {
            return fine;
        }
        let coarse = self.between(&self.levels[l + 1], x, y);
        let mut out = [T::zero(); C];
        for k in 0..C {
            out[k] = fine[k] + (coarse[k] - fine[k]) * share;
        }
        out
    }

    /// The mean over a box, not smaller than a texel, and cut at the map's border.
    #[inline(always)]
    fn of_box(&self, x: T, y: T, half: [T; 2]) -> [T; C] {
        let size = self.levels[0].level;
        let (x0, x1) = span(x, half[0], size.width - 1);
        let (y0, y1) = span(y, half[1], size.height - 1);
        let per = 1.0 / ((x1 - x0) * (y1 - y0));
        let (left, right) = (node(x0, size.width), node(x1, size.width));
        let (top, bottom) = (node(y0, size.height), node(y1, size.height));
        let mut out = [T::zero(); C];
        let upper = self.difference(top, left, right);
        let lower = self.difference(bottom, left, right);
        for k in 0..C {
            out[k] = T::of((lower[k] - upper[k]) * per);
        }
        out
    }

    /// The table at `right` less that at `left`, both between two rows. In double, whatever is stored.
    #[inline(always)]
    fn difference(&self, row: (usize, f64), left: (usize, f64), right: (usize, f64)) -> [f64; C] {
        let width = self.levels[0].level.width;
        let mut out = [0.0; C];
        for (j, share) in [(row.0, 1.0 - row.1), (row.0 + 1, row.1)] {
            let at = j * width;
            let (a, b) = (self.values[at + left.0], self.values[at + left.0 + 1]);
            let (c, d) = (self.values[at + right.0], self.values[at + right.0 + 1]);
            for k in 0..C {
                let (a, b, c, d): (f64, f64, f64, f64) = (a[k].real(), b[k].real(), c[k].real(), d[k].real());
                out[k] += ((c + (d - c) * right.1) - (a + (b - a) * left.1)) * share;
            }
        }
        out
    }
}

/// The texels before and after a place, where texel i is at i, and how far it is between them.
#[inline(always)]
fn neighbours<T: Real>(x: T, last: T) -> (usize, usize, T) {
    let x = Lanes::min(Lanes::max(x, T::zero()), last);
    let low = x.floor();
    let next = Lanes::min(low + T::one(), last);
    (low.to_f64() as usize, next.to_f64() as usize, x - low)
}

/// From and to of a box on [0, n], at least one texel wide (or the whole of a map of one).
#[inline(always)]
fn span<T: Real>(x: T, half: T, n: usize) -> (f64, f64) {
    let (x, n) = (x.to_f64(), n as f64);
    let half = Lanes::max(half.to_f64(), 0.5);
    let low = Lanes::min(Lanes::max(x - half, 0.0), n - 1.0);
    let high = Lanes::max(Lanes::min(x + half, n), low + 1.0);
    (low, high)
}

/// The node of a table at or before a place, with one after it, and how far it is between them.
#[inline(always)]
fn node(x: f64, nodes: usize) -> (usize, f64) {
    let i = Lanes::min(x.floor(), (nodes - 2) as f64);
    (i as usize, x - i)
}
