//! Points on a spiral that fill the disk as a sunflower's seeds fill its head.
//!
//! H. Vogel, *A better way to construct the sunflower head*, 1979.

use super::generator::fraction;
use super::rows;
use crate::math::sin_cos;
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

/// sin and cos of 2π (`offset` + i · `step`), which are fractions of 2¹²⁸ of a turn.
#[inline(always)]
pub(crate) fn turn<T: Real>(i: u64, step: u128, offset: u128) -> (T, T) {
    let x = offset.wrapping_add(step.wrapping_mul(u128::from(i)));
    sin_cos(T::of(2.0) * T::PI * fraction::<T>((x >> 96) as u32, (x >> 64) as u32))
}

/// All points, one row each: equal areas, radii ascending.
pub fn vogel_disk_many<T: Real>(
    watch: &mut dyn Watch,
    step: u128,
    offset: u128,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let n = (out.len() / 2) as f64;
    rows(watch, out, 2, |i, row| {
        let (sin, cos) = turn::<T>(i, step, offset);
        let radius = T::of(((i as f64 + 0.5) / n).sqrt());
        (row[0], row[1]) = (radius * cos, radius * sin);
    })
}
