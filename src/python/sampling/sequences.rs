//! Bindings of the sequences and point sets.

use crate::python::array::{Out, run, unknown};
use crate::real;
use crate::sampling::halton::{self as halton_sequence, Scrambling};
use crate::sampling::{latin_hypercube as latin, multi_jittered as jittered, r2 as additive};
use crate::sampling::{sobol as sequence, stratified as strata};
use pyo3::prelude::*;

/// How many dimensions `sobol` and `halton` have.
pub const SEQUENCE_DIMENSIONS: usize = sequence::DIMENSIONS;

/// `seed` None leaves the points unscrambled.
#[pyfunction]
pub fn sobol(py: Python<'_>, seed: Option<u64>, start: u64, out: &Bound<'_, PyAny>) -> PyResult<()> {
    real!(out, T => {
        let mut out = Out::<T>::of("out", out)?;
        let dimensions = out.shape()[1];
        let out = out.slice()?;
        run(py, None, |watch| sequence::sobol_many(watch, seed, start, dimensions, out))
    })
}

#[pyfunction]
pub fn halton(
    py: Python<'_>,
    scramble: Option<&str>,
    seed: u64,
    start: u64,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let scrambling = match scramble {
        None => Scrambling::None,
        Some("digits") => Scrambling::Digits,
        Some("owen") => Scrambling::Owen,
        Some(other) => return Err(unknown("scramble", other)),
    };
    real!(out, T => {
        let mut out = Out::<T>::of("out", out)?;
        let dimensions = out.shape()[1];
        let out = out.slice()?;
        run(py, None, |watch| halton_sequence::halton_many(watch, scrambling, seed, start, dimensions, out))
    })
}

/// Steps and offsets as fractions of 2¹²⁸: (upper, lower) halves.
#[pyfunction]
pub fn r2(
    py: Python<'_>,
    steps: Vec<(u64, u64)>,
    offsets: Vec<(u64, u64)>,
    start: u64,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let whole = |halves: Vec<(u64, u64)>| -> Vec<u128> {
        halves.iter().map(|&(a, b)| u128::from(a) << 64 | u128::from(b)).collect()
    };
    let (steps, offsets) = (whole(steps), whole(offsets));
    real!(out, T => {
        let mut out = Out::<T>::of("out", out)?;
        let out = out.slice()?;
        run(py, None, |watch| additive::r2_many(watch, &steps, &offsets, start, out))
    })
}

#[pyfunction]
pub fn stratified(
    py: Python<'_>,
    seed: u64,
    counts: Vec<u32>,
    jitter: bool,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let mut out = Out::<T>::of("out", out)?;
        let out = out.slice()?;
        run(py, None, |watch| strata::stratified_many(watch, seed, &counts, jitter, out))
    })
}

#[pyfunction]
pub fn latin_hypercube(py: Python<'_>, seed: u64, jitter: bool, out: &Bound<'_, PyAny>) -> PyResult<()> {
    real!(out, T => {
        let mut out = Out::<T>::of("out", out)?;
        let dimensions = out.shape()[1];
        let out = out.slice()?;
        run(py, None, |watch| latin::latin_hypercube_many(watch, seed, dimensions, jitter, out))
    })
}

#[pyfunction]
pub fn multi_jittered(
    py: Python<'_>,
    seed: u64,
    columns: u32,
    correlated: bool,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let mut out = Out::<T>::of("out", out)?;
        let out = out.slice()?;
        run(py, None, |watch| jittered::multi_jittered_many(watch, seed, columns, correlated, out))
    })
}
