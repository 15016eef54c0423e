//! Bindings of view: look_at, viewport, rigid_inverse, change_of_basis.

use crate::elementwise;
use crate::python::array::Arrays;
use crate::transform::{projection, view};
use bytemuck::cast;
use pyo3::prelude::*;

#[pyfunction]
pub fn look_at(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |eye: [T; 3], target: [T; 3], up: [T; 3]| -> (m: [T; 16]) {
        cast(view::look_at(eye.into(), target.into(), up.into()))
    })
}

#[pyfunction]
pub fn rigid_inverse(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |matrix: [T; 16]| -> (m: [T; 16]) {
        cast(view::rigid_inverse::<T>(cast(matrix)))
    })
}

#[pyfunction]
pub fn change_of_basis(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |x: [T; 3], y: [T; 3], z: [T; 3], origin: [T; 3]| -> (m: [T; 16]) {
        cast(view::change_of_basis([x.into(), y.into(), z.into()], origin.into()))
    })
}

#[pyfunction]
pub fn viewport(size: [f64; 2], origin: [f64; 2]) -> [[f64; 4]; 4] {
    projection::viewport(size, origin)
}
