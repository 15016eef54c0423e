//! What lookups into maps of moments share: the mean of the moments over a part of the map.
//!
//! The map is plain (filtered beforehand; read between four texels), or a chain of mips (read between eight, at the
//! level whose kernel has the variance of the box asked for), or a table of sums (the box itself, with texels at its
//! border by the share that it covers).

use crate::math;
use crate::real::{Lanes, Real};
use crate::shadow::moment_map::{Stored, Warp, powers};

/// Where a level lies among the values, in texels.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    pub first: usize,
    pub width: usize,
    pub height: usize,
}

/// Moments of `C` channels.
pub struct Filtered<'a, T, E, const C: usize> {
    values: &'a [[E; C]],
    /// One, or those of a chain; of a table its own size.
    levels: Vec<Level>,
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
        fits.then(|| Filtered { values, levels, table, scale: T::one() / T::of(reduce as f64), warp })
    }

    /// The mean over a box about (x, y), of the given half sides, all in texels of the depth map.
    #[inline(always)]
    pub fn mean(&self, x: T, y: T, half: [T; 2]) -> [T; C] {
        let (x, y, half) = (x * self.scale, y * self.scale, [half[0] * self.scale, half[1] * self.scale]);
        if self.table {
            self.of_box(x, y, half)
        } else if self.levels.len() > 1 {
            self.of_mips(x, y, half)
        } else {
            self.between(self.levels[0], x, y)
        }
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

    /// Between the four texels of a level about a place; beyond the border lies the nearest texel.
    #[inline(always)]
    fn between(&self, level: Level, x: T, y: T) -> [T; C] {
        let (x0, x1, fx) = neighbours(x - T::of(0.5), level.width);
        let (y0, y1, fy) = neighbours(y - T::of(0.5), level.height);
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

    /// Between two levels. A texel of width w, read between its neighbours, has the variance of a box of width √3 w.
    #[inline(always)]
    fn of_mips(&self, x: T, y: T, half: [T; 2]) -> [T; C] {
        let wide = (half[0].max(half[1])) * T::of(2.0 / 1.732_050_807_568_877_2);
        let top = self.levels.len() - 1;
        let level = math::ln(wide.max(T::one())) * T::of(1.0 / std::f64::consts::LN_2);
        let level = Lanes::min(level, T::of(top as f64));
        let low = level.floor();
        let (l, share) = (low.to_f64() as usize, level - low);
        let fine = self.at_level(l, x, y);
        if !(share > T::zero()) {
            return fine;
        }
        let coarse = self.at_level(l + 1, x, y);
        let mut out = [T::zero(); C];
        for k in 0..C {
            out[k] = fine[k] + (coarse[k] - fine[k]) * share;
        }
        out
    }

    #[inline(always)]
    fn at_level(&self, l: usize, x: T, y: T) -> [T; C] {
        let (whole, level) = (self.levels[0], self.levels[l]);
        let across = T::of(level.width as f64 / whole.width as f64);
        let down = T::of(level.height as f64 / whole.height as f64);
        self.between(level, x * across, y * down)
    }

    /// The mean over a box, not smaller than a texel, and cut at the map's border.
    #[inline(always)]
    fn of_box(&self, x: T, y: T, half: [T; 2]) -> [T; C] {
        let size = self.levels[0];
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
        let width = self.levels[0].width;
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

    /// The mean as powers, whatever they are stored as.
    #[inline(always)]
    pub fn mean_powers(&self, x: T, y: T, half: [T; 2]) -> [T; 4] {
        let m = self.mean(x, y, half);
        let mut four = [T::zero(); 4];
        four[..C].copy_from_slice(&m);
        if E::QUANTIZED { powers(four) } else { four }
    }
}

/// The texels before and after a place, where texel i is at i, and how far it is between them.
#[inline(always)]
fn neighbours<T: Real>(x: T, n: usize) -> (usize, usize, T) {
    let last = T::of((n - 1) as f64);
    let x = Lanes::min(Lanes::max(x, T::zero()), last);
    let low = x.floor();
    let i = low.to_f64() as usize;
    (i, if i + 1 < n { i + 1 } else { i }, x - low)
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
