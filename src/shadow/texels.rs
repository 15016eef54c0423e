//! What a shadow map's depths are stored as: numbers, integers of equal steps, or pages of which only some are there.

use crate::real::Real;
use crate::shadow::anchor::lanes;
use crate::shadow::lookup::LOT;
use crate::simd::*;

/// From stored integers to depth: `low + step · q`; from `nothing` on, nothing was hit.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    pub low: f64,
    pub step: f64,
    pub nothing: u32,
}

impl Steps {
    /// In double, and rounded once.
    #[inline(always)]
    fn depth<T: Real>(&self, q: u32) -> T {
        if q >= self.nothing { T::INFINITY } else { T::of(self.low + self.step * f64::from(q)) }
    }

    /// The nearest step; anything that is not a depth is nothing.
    #[inline(always)]
    pub fn stored<T: Real>(&self, depth: T) -> u32 {
        let depth = depth.to_f64();
        if !(depth < f64::INFINITY) {
            return self.nothing;
        }
        let q = if self.step > 0.0 { ((depth - self.low) / self.step).round_ties_even() } else { 0.0 };
        (q as u32).min(self.nothing - 1)
    }
}

/// Pages of a large map, each `side` = 2^`bits` texels square: where in `pages` each one lies, in units of a page, or
/// -1. What is not there is empty.
#[derive(Clone, Copy)]
pub struct Pages<'a, T> {
    pub pages: &'a [T],
    pub table: &'a [i32],
    pub bits: u32,
    pub columns: usize,
}

impl<'a, T> Pages<'a, T> {
    /// `None` unless the table covers a map of that size, and all that it names is there.
    pub fn new(pages: &'a [T], table: &'a [i32], bits: u32, [width, height]: [usize; 2]) -> Option<Self> {
        if bits > 14 {
            return None;
        }
        let (columns, rows) = (width.div_ceil(1 << bits), height.div_ceil(1 << bits));
        let held = pages.len() >> (2 * bits);
        let fits = columns.checked_mul(rows) == Some(table.len())
            && table.iter().all(|&slot| slot < 0 || (slot as usize) < held);
        if fits { Some(Pages { pages, table, bits, columns }) } else { None }
    }

    /// Where texel (x, y) lies, if it is there; both must lie in the map.
    #[inline(always)]
    fn place(&self, x: u32, y: u32) -> Option<usize> {
        let at = (y >> self.bits) as usize * self.columns + (x >> self.bits) as usize;
        let slot = self.table[at];
        let mask = (1u32 << self.bits) - 1;
        let within = ((y & mask) << self.bits | (x & mask)) as usize;
        if slot < 0 { None } else { Some(((slot as usize) << (2 * self.bits)) + within) }
    }
}

/// Depths of a map, row by row.
#[derive(Clone, Copy)]
pub enum Texels<'a, T> {
    Real(&'a [T]),
    Short(&'a [u16], Steps),
    Long(&'a [u32], Steps),
    Paged(Pages<'a, T>),
}

impl<T: Real> Texels<'_, T> {
    /// Whether there is a texel for each of a map of that size.
    pub fn fill(&self, [width, height]: [usize; 2]) -> bool {
        let wanted = width.checked_mul(height);
        match self {
            Texels::Real(d) => wanted == Some(d.len()),
            Texels::Short(d, _) => wanted == Some(d.len()),
            Texels::Long(d, _) => wanted == Some(d.len()),
            Texels::Paged(p) => {
                let n = 1 << p.bits;
                wanted.is_some() && width.div_ceil(n).checked_mul(height.div_ceil(n)) == Some(p.table.len())
            }
        }
    }

    /// The depth of a texel of a map `width` wide.
    #[inline(always)]
    pub fn at(&self, width: usize, x: usize, y: usize) -> T {
        match self {
            Texels::Real(d) => d[y * width + x],
            Texels::Short(d, steps) => steps.depth(u32::from(d[y * width + x])),
            Texels::Long(d, steps) => steps.depth(d[y * width + x]),
            Texels::Paged(p) => match p.place(x as u32, y as u32) {
                Some(at) => p.pages[at],
                None => T::INFINITY,
            },
        }
    }

    /// Whether a texel of the map is there.
    #[inline(always)]
    pub fn stored(&self, x: u32, y: u32) -> bool {
        match self {
            Texels::Paged(p) => p.place(x, y).is_some(),
            _ => true,
        }
    }

    /// The depths of some texels of a map `width` wide.
    ///
    /// # Safety
    /// All must lie in the map, which [`Texels::fill`] must have found to be full.
    #[inline(always)]
    pub unsafe fn lot<S: Simd>(&self, s: S, width: usize, x: T::V8<S>, y: T::V8<S>) -> T::V8<S> {
        let Texels::Real(d) = self else {
            let (x, y) = (T::indices::<S>(x), T::indices::<S>(y));
            return lanes::<T, S>(s, self.decoded(width, &x, &y));
        };
        let at = T::places::<S>(x, y, width as u32);
        // Written out: an array that is filled in a loop passes through memory, and is waited for.
        macro_rules! each {
            ($($k:literal)+) => {
                // SAFETY: the caller's promise.
                [$(unsafe { *d.get_unchecked(at[$k] as usize) }),+]
            };
        }
        lanes::<T, S>(s, each!(0 1 2 3 4 5 6 7))
    }

    /// The same of what is stored otherwise; apart, so that it takes no registers from the usual case.
    #[inline(never)]
    fn decoded(&self, width: usize, ix: &[u32; LOT], iy: &[u32; LOT]) -> [T; LOT] {
        let mut depth = [T::zero(); LOT];
        for k in 0..LOT {
            depth[k] = self.at(width, ix[k] as usize, iy[k] as usize);
        }
        depth
    }
}
