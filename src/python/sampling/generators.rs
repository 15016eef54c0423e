//! Bindings of the generators.

use crate::python::array::{In, Out, run};
use crate::real;
use crate::sampling::generator;
use pyo3::prelude::*;

#[pyfunction]
pub fn philox(
    py: Python<'_>,
    counter: &Bound<'_, PyAny>,
    key: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let (c, k) = (In::<u32>::of("counter", counter)?, In::<u32>::of("key", key)?);
    let mut out = Out::<u32>::of("out", out)?;
    let (c, k, out) = (c.items()?, k.items()?, out.items()?);
    run(py, None, |watch| generator::philox_many(watch, c, k, out))
}

#[pyfunction]
pub fn uniform(
    py: Python<'_>,
    seed: u64,
    pixel: &Bound<'_, PyAny>,
    sample: &Bound<'_, PyAny>,
    dimension: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let p = In::<u64>::of("pixel", pixel)?;
        let (s, d) = (In::<u32>::of("sample", sample)?, In::<u32>::of("dimension", dimension)?);
        let mut out = Out::<T>::of("out", out)?;
        let (p, s, d, out) = (p.slice()?, s.slice()?, d.slice()?, out.slice()?);
        run(py, None, |watch| generator::uniform_many(watch, seed, p, s, d, out))
    })
}
