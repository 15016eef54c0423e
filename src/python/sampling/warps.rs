//! Bindings of the warps.

use crate::parallel::{Interrupted, Watch};
use crate::python::array::{In, Out, run, unknown};
use crate::real;
use crate::real::Real;
use crate::sampling::{cosine_hemisphere, disk, triangle};
use numpy::Element;
use pyo3::prelude::*;

/// One array in, one out, item by item.
fn warp<T: Real + Element, const A: usize, const B: usize>(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
    kernel: impl FnOnce(&mut dyn Watch, &[[T; A]], &mut [[T; B]]) -> Result<(), Interrupted> + Send,
) -> PyResult<()> {
    let (input, mut out) = (In::<T>::of("input", input)?, Out::<T>::of("out", out)?);
    let (input, out) = (input.items()?, out.items()?);
    run(py, None, |watch| kernel(watch, input, out))
}

fn disk_method(method: &str) -> PyResult<disk::Method> {
    match method {
        "concentric" => Ok(disk::Method::Concentric),
        "polar" => Ok(disk::Method::Polar),
        _ => Err(unknown("method", method)),
    }
}

fn triangle_method(method: &str) -> PyResult<triangle::Method> {
    match method {
        "fold" => Ok(triangle::Method::Fold),
        "root" => Ok(triangle::Method::Root),
        _ => Err(unknown("method", method)),
    }
}

#[pyfunction]
pub fn square_to_disk(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    method: &str,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let method = disk_method(method)?;
    real!(out, T => warp(py, input, out, |w, i, o| disk::square_to_disk_many::<T>(w, i, method, o)))
}

#[pyfunction]
pub fn disk_to_square(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    method: &str,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let method = disk_method(method)?;
    real!(out, T => warp(py, input, out, |w, i, o| disk::disk_to_square_many::<T>(w, i, method, o)))
}

#[pyfunction]
pub fn square_to_disk_pdf(py: Python<'_>, input: &Bound<'_, PyAny>, out: &Bound<'_, PyAny>) -> PyResult<()> {
    real!(out, T => warp(py, input, out, disk::square_to_disk_pdf_many::<T>))
}

#[pyfunction]
pub fn square_to_triangle(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    method: &str,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let method = triangle_method(method)?;
    real!(out, T => warp(py, input, out, |w, i, o| triangle::square_to_triangle_many::<T>(w, i, method, o)))
}

#[pyfunction]
pub fn triangle_to_square(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    method: &str,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let method = triangle_method(method)?;
    real!(out, T => warp(py, input, out, |w, i, o| triangle::triangle_to_square_many::<T>(w, i, method, o)))
}

#[pyfunction]
pub fn square_to_triangle_pdf(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => warp(py, input, out, triangle::square_to_triangle_pdf_many::<T>))
}

#[pyfunction]
pub fn square_to_cosine_hemisphere(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    method: &str,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let method = disk_method(method)?;
    real!(out, T => warp(py, input, out, |w, i, o| cosine_hemisphere::square_to_cosine_hemisphere_many::<T>(w, i, method, o)))
}

#[pyfunction]
pub fn cosine_hemisphere_to_square(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    method: &str,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let method = disk_method(method)?;
    real!(out, T => warp(py, input, out, |w, i, o| cosine_hemisphere::cosine_hemisphere_to_square_many::<T>(w, i, method, o)))
}

#[pyfunction]
pub fn square_to_cosine_hemisphere_pdf(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => warp(py, input, out, cosine_hemisphere::square_to_cosine_hemisphere_pdf_many::<T>))
}
