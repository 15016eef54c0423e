//! Points with one in each n-th of every axis.
//!
//! M. D. McKay, R. J. Beckman, W. J. Conover, *A comparison of three methods for selecting values of input variables in
//! the analysis of output from a computer code*, 1979.

use super::hash::{Key, permute};
use super::rows;
use super::stratified::{jitter, within};
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

/// A coordinate of point `i` of `n`, of the key's own dimension.
#[inline(always)]
pub fn stratum<T: Real>(key: Key, i: u32, n: u32, jittered: bool) -> T {
    within(permute(i, n, key.at(0)), jitter(key.at(1).at(u64::from(i)), jittered), n)
}

/// All points, one row each; fewer than 2³² of them.
pub fn latin_hypercube_many<T: Real>(
    watch: &mut dyn Watch,
    seed: u64,
    dimensions: usize,
    jittered: bool,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let (key, n) = (Key::new(seed, 2), (out.len() / dimensions.max(1)) as u32);
    rows(watch, out, dimensions, |i, row| {
        for (d, x) in row.iter_mut().enumerate() {
            *x = stratum(key.at(d as u64), i as u32, n, jittered);
        }
    })
}
