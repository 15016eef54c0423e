//! Bindings of vectors and orthonormal_basis.

use crate::elementwise;
use crate::python::array::Arrays;
use crate::transform::orthonormal_basis::Frame;
use crate::transform::vectors;
use crate::vec::{Mat3, Vec3};
use bytemuck::cast;
use pyo3::prelude::*;

#[pyfunction]
pub fn orthonormal_basis(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |normals: [T; 3]| -> (m: [T; 9]) {
        let Frame { x, y, z } = Frame::about(Vec3::from(normals).normalize());
        cast(Mat3([x, y, z]).rows())
    })
}

#[pyfunction]
pub fn angle_between(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |a: [T; 3], b: [T; 3]| -> (angle: [T; 1]) {
        [vectors::angle_between(a.into(), b.into())]
    })
}

#[pyfunction]
pub fn project_onto(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |v: [T; 3], onto: [T; 3]|
        -> (length: [T; 1], parallel: [T; 3], perpendicular: [T; 3]) {
        let (length, parallel, perpendicular) = vectors::project_onto(v.into(), onto.into());
        ([length], parallel.to_array(), perpendicular.to_array())
    })
}
