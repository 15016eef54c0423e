//! Points on a spiral from pole to pole, in bands of equal area, each turned from the last by the golden angle.
//!
//! R. Swinbank, R. J. Purser, *Fibonacci grids: a novel approach to global modelling*, 2006. Á. González, *Measurement
//! of areas on a sphere using Fibonacci and latitude-longitude lattices*, 2010.

use super::rows;
use super::vogel_disk::turn;
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

/// All points, one row each, from z near 1 to z near -1.
pub fn fibonacci_sphere_many<T: Real>(
    watch: &mut dyn Watch,
    step: u128,
    offset: u128,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let n = (out.len() / 3) as f64;
    rows(watch, out, 3, |i, row| {
        let (sin, cos) = turn::<T>(i, step, offset);
        // 1 - z² as a product of its factors, which loses nothing near the poles.
        let (above, below) = (2.0 * i as f64 + 1.0, 2.0 * (n - i as f64) - 1.0);
        let radius = T::of((above * below).sqrt() / n);
        (row[0], row[1], row[2]) = (radius * cos, radius * sin, T::of((n - above) / n));
    })
}
