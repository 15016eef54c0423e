//! Gibbs' sampler over a picture: in turn a place within the row, and a place within the column, each in proportion to
//! the pixels' weights there. Every step is accepted.
//!
//! S. Geman, D. Geman, *Stochastic relaxation, Gibbs distributions, and the Bayesian restoration of images*, 1984.

use super::generator::Generator;
use super::metropolis_hastings::{Record, run};
use super::tabulated::Tabulated2D;
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

/// Chains over the picture of `rows`, with `columns` its transpose.
pub fn gibbs<T: Real>(
    watch: &mut dyn Watch,
    rows: &Tabulated2D<T>,
    columns: &Tabulated2D<T>,
    record: Record,
    state: &mut [[T; 2]],
    samples: &mut [[T; 2]],
) -> Result<(), Interrupted> {
    let generator = Generator::new(record.seed);
    let mut moved = vec![0; state.len()];
    run(watch, record, state, samples, &mut moved, |chain, number, state| {
        let [a, b, ..] = generator.quad::<f64>(chain as u64, number as u32, (number >> 32) as u32);
        state[0] = rows.sample_within(state[1], T::of(a)).x;
        state[1] = columns.sample_within(state[0], T::of(b)).x;
        true
    })
}
