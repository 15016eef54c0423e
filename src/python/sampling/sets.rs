//! Bindings of point sets whose points know of each other, and of spirals.

use crate::python::array::{Out, run, unknown};
use crate::real;
use crate::sampling::poisson_disk::{self as dart, Domain};
use crate::sampling::{blue_noise_mask as mask, fibonacci_sphere as sphere, vogel_disk as disk};
use numpy::PyArray1;
use pyo3::prelude::*;

fn whole((upper, lower): (u64, u64)) -> u128 {
    u128::from(upper) << 64 | u128::from(lower)
}

/// Step and offset as fractions of 2¹²⁸ turns: (upper, lower) halves.
#[pyfunction]
pub fn fibonacci_sphere(
    py: Python<'_>,
    step: (u64, u64),
    offset: (u64, u64),
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let mut out = Out::<T>::of("out", out)?;
        let out = out.slice()?;
        run(py, None, |watch| sphere::fibonacci_sphere_many(watch, whole(step), whole(offset), out))
    })
}

#[pyfunction]
pub fn vogel_disk(
    py: Python<'_>,
    step: (u64, u64),
    offset: (u64, u64),
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let mut out = Out::<T>::of("out", out)?;
        let out = out.slice()?;
        run(py, None, |watch| disk::vogel_disk_many(watch, whole(step), whole(offset), out))
    })
}

/// All coordinates, one point after the other.
#[pyfunction]
pub fn poisson_disk<'py>(
    py: Python<'py>,
    domain: &str,
    dimensions: usize,
    radius: f64,
    attempts: u32,
    seed: u64,
) -> PyResult<Bound<'py, PyAny>> {
    let domain = match domain {
        "square" => Domain::Square,
        "torus" => Domain::Torus,
        "disk" => Domain::Disk,
        other => return Err(unknown("domain", other)),
    };
    let flat = match dimensions {
        2 => run(py, None, |w| dart::poisson_disk::<2>(w, domain, radius, attempts, seed))?.into_flattened(),
        3 => run(py, None, |w| dart::poisson_disk::<3>(w, domain, radius, attempts, seed))?.into_flattened(),
        other => return Err(unknown("dimensions", &other.to_string())),
    };
    Ok(PyArray1::from_vec(py, flat).into_any())
}

#[pyfunction]
pub fn blue_noise_mask<'py>(
    py: Python<'py>,
    width: usize,
    height: usize,
    sigma: f64,
    seed: u64,
) -> PyResult<Bound<'py, PyAny>> {
    let ranks = run(py, None, |watch| mask::blue_noise_mask(watch, width, height, sigma, seed))?;
    Ok(PyArray1::from_vec(py, ranks).into_any())
}
