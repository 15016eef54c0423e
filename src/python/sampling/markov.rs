//! Bindings of Markov chains over pictures: metropolis_hastings, gibbs.

use super::tabulated::Table2D;
use crate::python::array::{In, Out, run, unknown};
use crate::real;
use crate::sampling::gibbs as alternate;
use crate::sampling::metropolis_hastings::{self as walks, Acceptance, Picture, Record, Walk};
use pyo3::prelude::*;

fn recorded((seed, burn_in, thin): (u64, usize, usize)) -> Record {
    Record { seed, burn_in, thin }
}

/// `state` and `samples` are (chains, 2) and (chains, kept, 2); `moved` counts accepted steps.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn metropolis_hastings(
    py: Python<'_>,
    weights: &Bound<'_, PyAny>,
    walk: (f64, f64, String),
    record: (u64, usize, usize),
    state: &Bound<'_, PyAny>,
    samples: &Bound<'_, PyAny>,
    moved: &Bound<'_, PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let (scale, leap, acceptance) = walk;
    let acceptance = match acceptance.as_str() {
        "hastings" => Acceptance::Hastings,
        "plain" => Acceptance::Plain,
        _ => return Err(unknown("acceptance", &acceptance)),
    };
    let (walk, record) = (Walk { scale, leap, acceptance }, recorded(record));
    real!(weights, T => {
        let weights = In::<T>::of("weights", weights)?;
        let picture = Picture { width: weights.shape()[1], weights: weights.slice()? };
        let (mut state, mut samples) = (Out::<T>::of("state", state)?, Out::<T>::of("samples", samples)?);
        let mut moved = Out::<u64>::of("moved", moved)?;
        let (state, samples, moved) = (state.items()?, samples.items()?, moved.slice()?);
        run(py, progress, |watch| walks::metropolis_hastings(watch, picture, walk, record, state, samples, moved))
    })
}

#[pyfunction]
pub fn gibbs(
    py: Python<'_>,
    tables: (Bound<'_, Table2D>, Bound<'_, Table2D>),
    record: (u64, usize, usize),
    state: &Bound<'_, PyAny>,
    samples: &Bound<'_, PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let record = recorded(record);
    real!(state, T => {
        let (rows, columns) = (tables.0.get().of::<T>()?, tables.1.get().of::<T>()?);
        let (mut state, mut samples) = (Out::<T>::of("state", state)?, Out::<T>::of("samples", samples)?);
        let (state, samples) = (state.items()?, samples.items()?);
        run(py, progress, |watch| alternate::gibbs(watch, rows, columns, record, state, samples))
    })
}
