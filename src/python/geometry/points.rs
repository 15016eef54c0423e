//! Bindings of points: barycentric.

use crate::elementwise;
use crate::geometry as kernels;
use crate::python::array::Arrays;
use pyo3::prelude::*;

#[pyfunction]
pub fn barycentric(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |p: [T; 3], a: [T; 3], b: [T; 3], c: [T; 3]| -> (w: [T; 3]) {
        kernels::barycentric::barycentric(p.into(), a.into(), b.into(), c.into()).to_array()
    })
}
