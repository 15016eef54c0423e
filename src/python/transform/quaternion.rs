//! Bindings of quaternion.

use crate::elementwise;
use crate::python::array::Arrays;
use crate::transform::{affine, quaternion};
use bytemuck::cast;
use pyo3::prelude::*;

#[pyfunction]
pub fn quaternion_from_axis(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |axis: [T; 3], angle: [T; 1]| -> (q: [T; 4]) {
        quaternion::from_axis(axis.into(), angle[0]).to_array()
    })
}

#[pyfunction]
pub fn quaternion_multiply(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |a: [T; 4], b: [T; 4]| -> (q: [T; 4]) {
        quaternion::multiply(a.into(), b.into()).to_array()
    })
}

#[pyfunction]
pub fn quaternion_conjugate(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |q: [T; 4]| -> (conjugate: [T; 4]) { quaternion::conjugate(q.into()).to_array() })
}

#[pyfunction]
pub fn quaternion_inverse(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |q: [T; 4]| -> (inverse: [T; 4]) { quaternion::inverse(q.into()).to_array() })
}

#[pyfunction]
pub fn quaternion_rotate(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |q: [T; 4], vectors: [T; 3]| -> (rotated: [T; 3]) {
        quaternion::rotate(q.into(), vectors.into()).to_array()
    })
}

#[pyfunction]
pub fn quaternion_slerp(py: Python<'_>, shortest: bool, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |a: [T; 4], b: [T; 4], t: [T; 1]| -> (q: [T; 4]) {
        quaternion::slerp(a.into(), b.into(), t[0], shortest).to_array()
    })
}

#[pyfunction]
pub fn quaternion_to_matrix(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |q: [T; 4]| -> (m: [T; 16]) {
        cast(affine::linear(quaternion::to_matrix(q.into())))
    })
}

#[pyfunction]
pub fn quaternion_from_matrix(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |rotation: [T; 9]| -> (q: [T; 4]) {
        quaternion::from_matrix::<T>(cast(rotation)).to_array()
    })
}
