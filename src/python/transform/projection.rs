//! Bindings of projection: perspective, orthographic, linear_depth; of depth_precision.

use crate::elementwise;
use crate::python::array::Arrays;
use crate::transform::depth_precision::{self as precision, Storage};
use crate::transform::projection::{self, Depth, Frustum};
use bytemuck::cast;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

fn depth_of(name: &str) -> PyResult<Depth> {
    match name {
        "standard" => Ok(Depth::Standard),
        "zero_to_one" => Ok(Depth::ZeroToOne),
        "reversed" => Ok(Depth::Reversed),
        _ => Err(PyValueError::new_err(format!("depth: unknown convention {name:?}"))),
    }
}

#[pyfunction]
pub fn perspective(py: Python<'_>, depth: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let depth = depth_of(depth)?;
    elementwise!(py, given, out, |left: [T; 1], right: [T; 1], bottom: [T; 1], top: [T; 1], near: [T; 1], far: [T; 1]|
        -> (m: [T; 16]) {
        cast(projection::perspective(Frustum([left[0], right[0], bottom[0], top[0], near[0], far[0]]), depth))
    })
}

#[pyfunction]
pub fn perspective_fov(py: Python<'_>, depth: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let depth = depth_of(depth)?;
    elementwise!(py, given, out, |fov_y: [T; 1], aspect: [T; 1], near: [T; 1], far: [T; 1]| -> (m: [T; 16]) {
        cast(projection::perspective(Frustum::from_fov(fov_y[0], aspect[0], near[0], far[0]), depth))
    })
}

#[pyfunction]
pub fn orthographic(py: Python<'_>, depth: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let depth = depth_of(depth)?;
    elementwise!(py, given, out, |left: [T; 1], right: [T; 1], bottom: [T; 1], top: [T; 1], near: [T; 1], far: [T; 1]|
        -> (m: [T; 16]) {
        cast(projection::orthographic(Frustum([left[0], right[0], bottom[0], top[0], near[0], far[0]]), depth))
    })
}

/// `entries`: those of the projection that concern depth.
#[pyfunction]
pub fn linear_depth(
    py: Python<'_>,
    entries: [[f64; 2]; 2],
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    elementwise!(py, given, out, |depth: [T; 1]| -> (distance: [T; 1]) {
        [projection::linear_depth(depth[0], entries.map(|row| row.map(|x| x as T)))]
    })
}

#[pyfunction]
pub fn depth_precision(
    py: Python<'_>,
    depth: &str,
    storage: &str,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let depth = depth_of(depth)?;
    let storage = match storage {
        "float32" => Storage::Float32,
        "unorm24" => Storage::Unorm((1 << 24) - 1),
        "unorm16" => Storage::Unorm((1 << 16) - 1),
        _ => return Err(PyValueError::new_err(format!("storage: unknown format {storage:?}"))),
    };
    elementwise!(py, given, out, |distance: [T; 1], near: [T; 1], far: [T; 1]| -> (step: [T; 1], bits: [T; 1]) {
        let [step, bits] = precision::depth_precision(distance[0], [near[0], far[0]], depth, storage);
        ([step], [bits])
    })
}
