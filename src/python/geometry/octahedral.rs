//! Bindings of octahedral: octahedral_encode, octahedral_quantize, octahedral_decode.

use crate::elementwise;
use crate::geometry::octahedral::{decode, encode, quantize};
use crate::python::array::Arrays;
use crate::real::Real;
use pyo3::prelude::*;

#[pyfunction]
pub fn octahedral_encode(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |v: [T; 3]| -> (p: [T; 2]) { encode(v.into()) })
}

#[pyfunction]
pub fn octahedral_quantize(
    py: Python<'_>,
    precise: bool,
    scale: f64,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    elementwise!(py, given, out, |v: [T; 3]| -> (code: [i32; 2]) {
        quantize(precise, <T as Real>::of(scale), v.into())
    })
}

/// Points of the square over `scale`.
#[pyfunction]
pub fn octahedral_decode(py: Python<'_>, scale: f64, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |p: [T; 2]| -> (v: [T; 3]) {
        decode(p.map(|x| x / <T as Real>::of(scale))).to_array()
    })
}
