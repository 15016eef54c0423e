//! Bindings of affine: translate, scale, rotate_axis.

use crate::elementwise;
use crate::python::array::Arrays;
use crate::transform::affine;
use bytemuck::cast;
use pyo3::prelude::*;

#[pyfunction]
pub fn translate(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |offset: [T; 3]| -> (m: [T; 16]) { cast(affine::translate(offset)) })
}

#[pyfunction]
pub fn scale(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |factors: [T; 3]| -> (m: [T; 16]) { cast(affine::scale(factors)) })
}

#[pyfunction]
pub fn rotate_axis(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |axis: [T; 3], angle: [T; 1]| -> (m: [T; 16]) {
        cast(affine::rotate_axis(axis.into(), angle[0]))
    })
}
