//! Bindings of rotations: about axes, by angles (euler).

use crate::elementwise;
use crate::python::array::Arrays;
use crate::transform::affine;
use crate::transform::euler::{self as angles_of, Order};
use bytemuck::cast;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

#[pyfunction]
pub fn rotate_axis(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |axis: [T; 3], angle: [T; 1]| -> (m: [T; 16]) {
        cast(affine::rotate_axis(axis.into(), angle[0]))
    })
}

#[pyfunction]
pub fn rotate_coordinate(py: Python<'_>, axis: usize, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |angle: [T; 1]| -> (m: [T; 16]) {
        cast(affine::rotate_coordinate(axis, angle[0]))
    })
}

#[pyfunction]
pub fn rotate_2d(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |angle: [T; 1]| -> (m: [T; 9]) { cast(affine::rotate_2d(angle[0])) })
}

#[pyfunction]
pub fn cross_matrix(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |vectors: [T; 3]| -> (m: [T; 9]) { cast(affine::cross_matrix(vectors.into())) })
}

fn order_of(name: &str) -> PyResult<Order> {
    Order::from_name(name).ok_or_else(|| {
        PyValueError::new_err(format!(
            "order: expected three axes, neighbours different, as \"XYZ\" (moving) or \"zxz\" (fixed), got {name:?}"
        ))
    })
}

#[pyfunction]
pub fn euler(py: Python<'_>, order: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let order = order_of(order)?;
    elementwise!(py, given, out, |angles: [T; 3]| -> (m: [T; 16]) {
        cast(affine::linear(angles_of::euler(angles, order)))
    })
}

#[pyfunction]
pub fn euler_angles(py: Python<'_>, order: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let order = order_of(order)?;
    elementwise!(py, given, out, |rotation: [T; 9]| -> (angles: [T; 3], locked: [bool; 1]) {
        let (angles, locked) = angles_of::euler_angles::<T>(cast(rotation), order);
        (angles, [locked])
    })
}
