//! Points of the square that are stratified as a grid and along both axes at once: n-rooks within a grid.
//!
//! K. Chiu, P. Shirley, C. Wang, *Multi-jittered sampling*, 1994. A. Kensler, *Correlated multi-jittered sampling*, 2013:
//! all columns share one order of their rows, and all rows one order of their columns, which keeps neighbours apart.

use super::hash::{Key, permute};
use super::rows;
use super::stratified::within;
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

/// Point `i` of `n` on a grid of columns × rows cells, as many as `n` or a few more in the last row.
#[inline(always)]
pub fn multi_jittered<T: Real>(key: Key, i: u32, n: u32, columns: u32, correlated: bool) -> [T; 2] {
    let rows = n.div_ceil(columns);
    let s = permute(i, n, key.at(0));
    let (column, row) = (s % columns, s / columns);
    let (x, own) = (permute(column, columns, key.at(1)), key.at(3).at(u64::from(i)));
    let within_column =
        permute(row, rows, if correlated { key.at(2) } else { key.at(2).at(u64::from(column)) });
    // Uncorrelated rows: the order of the columns within each row is its own; full rows only have all places.
    let row_start = row * columns;
    let length = columns.min(n - row_start);
    let y = if correlated { column } else { permute(column, length, key.at(4).at(u64::from(row))) };
    let across = within(within_column, own.at(0).uniform::<T>(), rows);
    [within(x, across, columns), within(row_start + y, own.at(1).uniform::<T>(), n)]
}

/// All points, one row each; fewer than 2³² of them.
pub fn multi_jittered_many<T: Real>(
    watch: &mut dyn Watch,
    seed: u64,
    columns: u32,
    correlated: bool,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let (key, n) = (Key::new(seed, 3), (out.len() / 2) as u32);
    rows(watch, out, 2, |i, row| {
        row.copy_from_slice(&multi_jittered::<T>(key, i as u32, n, columns, correlated));
    })
}
