//! Bindings of frusta: frustum_planes, frustum_aabb, frustum_obb, frustum_sphere.

use crate::elementwise;
use crate::geometry as kernels;
use crate::geometry::plane_obb::Obb;
use crate::python::array::Arrays;
use crate::transform::projection::Depth;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pub(super) fn depth_named(name: &str) -> PyResult<Depth> {
    match name {
        "standard" => Ok(Depth::Standard),
        "zero_to_one" => Ok(Depth::ZeroToOne),
        "reversed" => Ok(Depth::Reversed),
        _ => Err(PyValueError::new_err(format!("depth: unknown, got {name:?}"))),
    }
}

#[pyfunction]
pub fn frustum_planes(py: Python<'_>, depth: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let depth = depth_named(depth)?;
    elementwise!(py, given, out, |matrix: [T; 16]| -> (planes: [T; 24]) {
        kernels::frustum_planes::frustum_planes(matrix, depth)
    })
}

#[pyfunction]
pub fn frustum_aabb(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |planes: [T; 24], low: [T; 3], high: [T; 3]| -> (side: [i8; 1], plane: [i32; 1]) {
        let v = kernels::frustum_aabb::frustum_aabb(&planes, [low, high]);
        ([v.side], [v.plane])
    })
}

#[pyfunction]
pub fn frustum_obb(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |planes: [T; 24], center: [T; 3], axes: [T; 9], half: [T; 3]| -> (side: [i8; 1], plane: [i32; 1]) {
        let v = kernels::frustum_obb::frustum_obb(&planes, &Obb::new(center, axes, half));
        ([v.side], [v.plane])
    })
}

#[pyfunction]
pub fn frustum_sphere(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |planes: [T; 24], center: [T; 3], radius: [T; 1]| -> (side: [i8; 1], plane: [i32; 1]) {
        let v = kernels::frustum_sphere::frustum_sphere(&planes, center, radius[0]);
        ([v.side], [v.plane])
    })
}
