//! What lookups into maps of moments share: the mean of the moments over a part of the map.
//!
//! The map is plain (filtered beforehand; read between four texels), or a chain of mips (read between eight, at the
//! level whose kernel has the variance of the box asked for), or a table of sums (the box itself, with texels at its
//! border by the share that it covers).

use crate::math;
use crate::real::{Lanes, Real};
use crate::shadow::anchor::{all, double, lanes};
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
    /// of the depth map; of those receivers whose bit is set. Enters the level anew: compiled once for all lookups.
    #[inline(never)]
    pub fn means<S: Simd>(
        &self,
        s: S,
        live: u64,
        at: (T::V8<S>, T::V8<S>),
        half: [T::V8<S>; 2],
    ) -> [T::V8<S>; 4] {
        s.vectorize(
            #[inline(always)]
            || self.means_here(s, live, at, half),
        )
    }

    #[inline(always)]
    fn means_here<S: Simd>(
        &self,
        s: S,
        live: u64,
        (x, y): (T::V8<S>, T::V8<S>),
        half: [T::V8<S>; 2],
    ) -> [T::V8<S>; 4] {
        let scale = all::<T, S>(s, self.scale);
        let (x, y, half) = (x * scale, y * scale, [half[0] * scale, half[1] * scale]);
        let found = if self.table {
            self.of_boxes(s, live, [x, y], half)
        } else if self.levels.len() > 1 {
            self.of_mips(s, live, [x, y], self.level(s, half))
        } else {
            self.between(s, live, [x, y], &[0; LOT])
        };
        let mut out = [[T::zero(); LOT]; 4];
        for k in 0..LOT {
            let mut four = [T::zero(); 4];
            #[allow(clippy::manual_memcpy)] // Which would be called, outside of the level.
            for c in 0..C {
                four[c] = found[k][c];
            }
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

    /// Between the four texels of each one's level about a place of the first; beyond the border lies the nearest texel.
    #[inline(always)]
    fn between<S: Simd>(
        &self,
        s: S,
        live: u64,
        [x, y]: [T::V8<S>; 2],
        levels: &[usize; LOT],
    ) -> [[T; C]; LOT] {
        let (mut share, mut last) = ([[T::zero(); LOT]; 2], [[T::zero(); LOT]; 2]);
        for k in 0..LOT {
            let at = &self.levels[levels[k]];
            for axis in 0..2 {
                share[axis][k] = at.share[axis];
                last[axis][k] = at.last[axis];
            }
        }
        let (x0, x1, fx) = neighbours::<T, S>(s, x * lanes::<T, S>(s, share[0]), lanes::<T, S>(s, last[0]));
        let (y0, y1, fy) = neighbours::<T, S>(s, y * lanes::<T, S>(s, share[1]), lanes::<T, S>(s, last[1]));
        let (fx, fy) = (fx.as_slice(), fy.as_slice());
        let mut out = [[T::zero(); C]; LOT];
        for k in 0..LOT {
            if live >> k & 1 == 0 {
                continue;
            }
            let level = self.levels[levels[k]].level;
            let up = level.first + y0[k] as usize * level.width;
            let down = level.first + y1[k] as usize * level.width;
            let (a, b) = (self.texel(up + x0[k] as usize), self.texel(up + x1[k] as usize));
            let (c, d) = (self.texel(down + x0[k] as usize), self.texel(down + x1[k] as usize));
            for i in 0..C {
                let (upper, lower) = (a[i] + (b[i] - a[i]) * fx[k], c[i] + (d[i] - c[i]) * fx[k]);
                out[k][i] = upper + (lower - upper) * fy[k];
            }
        }
        out
    }

    /// Between two levels.
    #[inline(always)]
    fn of_mips<S: Simd>(&self, s: S, live: u64, at: [T::V8<S>; 2], level: T::V8<S>) -> [[T; C]; LOT] {
        let low = level.floor();
        let (share, low) = (level - low, T::indices::<S>(low));
        let (mut fine, mut coarse) = ([0; LOT], [0; LOT]);
        for k in 0..LOT {
            // Receivers off the map may have any level.
            fine[k] = (low[k] as usize).min(self.levels.len() - 1);
            coarse[k] = (fine[k] + 1).min(self.levels.len() - 1);
        }
        let mut out = self.between(s, live, at, &fine);
        let coarse = self.between(s, live, at, &coarse);
        for k in 0..LOT {
            for c in 0..C {
                out[k][c] += (coarse[k][c] - out[k][c]) * share.as_slice()[k];
            }
        }
        out
    }

    /// The mean over boxes, not smaller than a texel, and cut at the map's border.
    #[inline(always)]
    fn of_boxes<S: Simd>(
        &self,
        s: S,
        live: u64,
        [x, y]: [T::V8<S>; 2],
        half: [T::V8<S>; 2],
    ) -> [[T; C]; LOT] {
        let size = self.levels[0].level;
        let (wide, left, right) = span::<T, S>(s, x, half[0], size.width - 1);
        let (high, top, bottom) = span::<T, S>(s, y, half[1], size.height - 1);
        let per = all::<f64, S>(s, 1.0) / (wide * high);
        let mut out = [[T::zero(); C]; LOT];
        for k in 0..LOT {
            if live >> k & 1 == 0 {
                continue;
            }
            let last = [size.width - 2, size.height - 2];
            let (left, right) = (left.of(k, last[0]), right.of(k, last[0]));
            // SAFETY: no node lies beyond the last but one of a row or a column.
            let (upper, lower) = unsafe {
                let upper = self.difference(top.of(k, last[1]), left, right);
                (upper, self.difference(bottom.of(k, last[1]), left, right))
            };
            for c in 0..C {
                out[k][c] = T::of((lower[c] - upper[c]) * per.as_slice()[k]);
            }
        }
        out
    }

    /// The table at `right` less that at `left`, both between two rows. In double, whatever is stored.
    ///
    /// # Safety
    /// A node of a row or a column must lie before its last.
    #[inline(always)]
    unsafe fn difference(&self, row: (usize, f64), left: (usize, f64), right: (usize, f64)) -> [f64; C] {
        let width = self.levels[0].level.width;
        let mut out = [0.0; C];
        for (j, share) in [(row.0, 1.0 - row.1), (row.0 + 1, row.1)] {
            // SAFETY: of a table as high and as wide as its level, which `new` found to fit.
            let (a, b, c, d) = unsafe {
                let at = self.values.as_ptr().add(j * width);
                (*at.add(left.0), *at.add(left.0 + 1), *at.add(right.0), *at.add(right.0 + 1))
            };
            for k in 0..C {
                let (a, b, c, d): (f64, f64, f64, f64) = (a[k].real(), b[k].real(), c[k].real(), d[k].real());
                out[k] += ((c + (d - c) * right.1) - (a + (b - a) * left.1)) * share;
            }
        }
        out
    }
}

/// The texels before and after a place, and how far it is between them.
#[inline(always)]
fn neighbours<T: Real, S: Simd>(s: S, x: T::V8<S>, last: T::V8<S>) -> ([u32; LOT], [u32; LOT], T::V8<S>) {
    let x = x - all::<T, S>(s, T::of(0.5));
    let x = Lanes::min(Lanes::max(x, all::<T, S>(s, T::zero())), last);
    let low = x.floor();
    let next = Lanes::min(low + all::<T, S>(s, T::one()), last);
    (T::indices::<S>(low), T::indices::<S>(next), x - low)
}

/// Nodes of a table at or before places, with one after each, and how far it is between them.
struct Nodes<V> {
    low: [u32; LOT],
    share: V,
}

impl<V> Nodes<V> {
    /// Of one receiver, and `last` at most: what is no number has any index.
    #[inline(always)]
    fn of<S: Simd>(&self, k: usize, last: usize) -> (usize, f64)
    where
        V: SimdFloat<S, Element = f64>,
    {
        ((self.low[k] as usize).min(last), self.share.as_slice()[k])
    }
}

type Wide<S> = <f64 as Real>::V8<S>;

/// How wide boxes on [0, n] are, and the nodes of their ends: at least one texel (or the whole of a map of one).
#[inline(always)]
fn span<T: Real, S: Simd>(
    s: S,
    x: T::V8<S>,
    half: T::V8<S>,
    n: usize,
) -> (Wide<S>, Nodes<Wide<S>>, Nodes<Wide<S>>) {
    let (x, half) = (double::<T, S>(s, x), double::<T, S>(s, half));
    let (zero, one) = (all::<f64, S>(s, 0.0), all::<f64, S>(s, 1.0));
    let (end, before) = (all::<f64, S>(s, n as f64), all::<f64, S>(s, (n - 1) as f64));
    let half = Lanes::max(half, all::<f64, S>(s, 0.5));
    let low = Lanes::min(Lanes::max(x - half, zero), before);
    let high = Lanes::max(Lanes::min(x + half, end), low + one);
    (high - low, node(low, before), node(high, before))
}

#[inline(always)]
fn node<S: Simd>(x: Wide<S>, last: Wide<S>) -> Nodes<Wide<S>> {
    let low = Lanes::min(x.floor(), last);
    Nodes { low: f64::indices::<S>(low), share: x - low }
}
