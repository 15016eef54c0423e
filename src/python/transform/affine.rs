//! Bindings of affine and compose.

use crate::elementwise;
use crate::python::array::Arrays;
use crate::transform::affine;
use crate::transform::compose::{self as parts, Parts};
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
pub fn shear(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |xy: [T; 1], xz: [T; 1], yx: [T; 1], yz: [T; 1], zx: [T; 1], zy: [T; 1]|
        -> (m: [T; 16]) {
        cast(affine::shear([xy[0], xz[0], yx[0], yz[0], zx[0], zy[0]]))
    })
}

#[pyfunction]
pub fn translate_2d(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |offset: [T; 2]| -> (m: [T; 9]) { cast(affine::translate_2d(offset)) })
}

#[pyfunction]
pub fn scale_2d(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |factors: [T; 2]| -> (m: [T; 9]) { cast(affine::scale_2d(factors)) })
}

#[pyfunction]
pub fn shear_2d(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |xy: [T; 1], yx: [T; 1]| -> (m: [T; 9]) {
        cast(affine::shear_2d([xy[0], yx[0]]))
    })
}

#[pyfunction]
pub fn compose(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |translation: [T; 3], rotation: [T; 4], scale: [T; 3], shear: [T; 3]|
        -> (m: [T; 16]) {
        cast(parts::compose(Parts { translation, rotation: rotation.into(), scale, shear }))
    })
}

#[pyfunction]
pub fn decompose(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |matrix: [T; 16]|
        -> (translation: [T; 3], rotation: [T; 4], scale: [T; 3], shear: [T; 3], mirrored: [bool; 1]) {
        let (p, mirrored) = parts::decompose::<T>(cast(matrix));
        (p.translation, p.rotation.to_array(), p.scale, p.shear, [mirrored])
    })
}
