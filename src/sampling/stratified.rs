//! One jittered point in each cell of a grid.
//!
//! R. L. Cook, *Stochastic sampling in computer graphics*, 1986.

use super::hash::{Key, permute};
use super::rows;
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

/// (k + jitter) / n, below one.
#[inline(always)]
pub(crate) fn within<T: Real>(k: u32, jitter: T, n: u32) -> T {
    let x = (T::of(f64::from(k)) + jitter) / T::of(f64::from(n));
    if x < T::one() { x } else { T::one().next_down() }
}

/// How far from a cell's corner: uniform, or the middle.
#[inline(always)]
pub(crate) fn jitter<T: Real>(key: Key, jittered: bool) -> T {
    if jittered { key.uniform() } else { T::of(0.5) }
}

/// Point `i` of columns × rows cells in random order, `i` below their number.
#[inline(always)]
pub fn shuffled_cell<T: Real>(key: Key, i: u32, columns: u32, rows: u32) -> [T; 2] {
    let (cell, key) = (permute(i, columns * rows, key.at(0)), key.at(1).at(u64::from(i)));
    [
        within(cell % columns, key.at(0).uniform::<T>(), columns),
        within(cell / columns, key.at(1).uniform::<T>(), rows),
    ]
}

/// One point for each cell of a grid of `counts` cells, the last axis the fastest.
pub fn stratified_many<T: Real>(
    watch: &mut dyn Watch,
    seed: u64,
    counts: &[u32],
    jittered: bool,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let key = Key::new(seed, 1);
    rows(watch, out, counts.len(), |i, row| {
        let (mut rest, key) = (i, key.at(i));
        for d in (0..row.len()).rev() {
            let n = u64::from(counts[d]);
            row[d] = within((rest % n) as u32, jitter(key.at(d as u64), jittered), counts[d]);
            rest /= n;
        }
    })
}
