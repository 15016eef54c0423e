//! Bindings of the generators.

use crate::python::array::{In, Out, run, unknown};
use crate::real;
use crate::sampling::generator;
use crate::sampling::sampler::{self as samplers, Sampler};
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

/// The names of the samplers.
#[pyfunction]
pub fn sampler_names() -> Vec<&'static str> {
    samplers::NAMES.to_vec()
}

#[pyfunction]
pub fn sampler(
    py: Python<'_>,
    name: &str,
    seed: u64,
    samples: u32,
    pixel: &Bound<'_, PyAny>,
    sample: &Bound<'_, PyAny>,
    dimension: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let sampler = Sampler::new(name, seed, samples).ok_or_else(|| unknown("kind", name))?;
    real!(out, T => {
        let p = In::<u64>::of("pixel", pixel)?;
        let (s, d) = (In::<u32>::of("sample", sample)?, In::<u32>::of("dimension", dimension)?);
        let mut out = Out::<T>::of("out", out)?;
        let (p, s, d, out) = (p.slice()?, s.slice()?, d.slice()?, out.slice()?);
        run(py, None, |watch| samplers::sampler_many(watch, sampler, p, s, d, out))
    })
}
