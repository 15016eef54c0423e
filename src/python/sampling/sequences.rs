//! Bindings of the sequences.

use crate::python::array::{Out, run};
use crate::real;
use crate::sampling::sobol as sequence;
use pyo3::prelude::*;

/// How many dimensions `sobol` has.
pub const SOBOL_DIMENSIONS: usize = sequence::DIMENSIONS;

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
