//! Drawing an index in proportion to weights with one comparison, however many there are: n columns of equal width, each
//! shared by its own index and one other, its alias.
//!
//! A. J. Walker, *An efficient method for generating discrete random variables with general distributions*, 1977;
//! M. D. Vose, *A linear algorithm for generating random numbers with a given distribution*, 1991.

use super::tabulated::{Invalid, total};
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use std::sync::atomic::{AtomicBool, Ordering};

/// Fills, for each column, the share that keeps its own index, and the index that the rest goes to. Shares are summed in
/// f64; an index without weight keeps none, and is nobody's alias.
pub fn alias_table<T: Real>(
    watch: &mut dyn Watch,
    weights: &[T],
    share: &mut [T],
    alias: &mut [u32],
) -> Result<Result<(), Invalid>, Interrupted> {
    parallel::run_forking(watch, |stop| fill(weights, share, alias, stop))
}

/// Returns soon once `stop` is set.
fn fill<T: Real>(
    weights: &[T],
    share: &mut [T],
    alias: &mut [u32],
    stop: &AtomicBool,
) -> Result<(), Invalid> {
    let n = weights.len();
    if n == 0 || n > u32::MAX as usize {
        return Err(Invalid::Length(n));
    }
    if let Some(bad) = weights.iter().position(|&w| !(w >= T::zero() && w.is_finite())) {
        return Err(Invalid::Weight(bad));
    }
    let largest = weights.iter().map(|w| w.to_f64()).fold(0.0, f64::max);
    if largest == 0.0 {
        return Err(Invalid::Empty);
    }
    let total = total(weights, 1.0 / largest.max(1e-300));
    let mut left: Vec<f64> =
        weights.iter().map(|w| w.to_f64() / largest.max(1e-300) / total * n as f64).collect();
    // Columns not full, and those that overflow; the last to overflow fills what rounding leaves.
    let (mut small, mut large): (Vec<u32>, Vec<u32>) = (0..n as u32).partition(|&i| left[i as usize] < 1.0);
    let mut steps = 0u32;
    while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
        steps += 1;
        if steps.is_multiple_of(1 << 16) && stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        small.pop();
        share[s as usize] = T::of(left[s as usize]);
        alias[s as usize] = l;
        // In this order the sum loses least.
        left[l as usize] = (left[l as usize] + left[s as usize]) - 1.0;
        if left[l as usize] < 1.0 {
            large.pop();
            small.push(l);
        }
    }
    let heaviest = (0..n).fold(0, |a, b| if weights[b] > weights[a] { b } else { a }) as u32;
    for i in small.into_iter().chain(large) {
        // Full up to rounding; without weight it must stay empty.
        let empty = weights[i as usize] == T::zero();
        share[i as usize] = if empty { T::zero() } else { T::one() };
        alias[i as usize] = if empty { heaviest } else { i };
    }
    Ok(())
}

/// The index for `u` in [0, 1], and what of `u` is left within it, uniform in [0, 1) again.
#[inline(always)]
pub fn sample_alias<T: Real>(share: &[T], alias: &[u32], u: T) -> (u32, T) {
    let n = share.len();
    let scaled = u * T::of(n as f64);
    let i = (scaled.to_f64() as usize).min(n - 1);
    let within = scaled - T::of(i as f64);
    let keep = share[i];
    let (index, rest) = if within < keep || keep >= T::one() {
        (i as u32, within / keep)
    } else {
        (alias[i], (within - keep) / (T::one() - keep))
    };
    let one = T::one();
    (index, if rest >= one { one.next_down() } else { rest })
}
