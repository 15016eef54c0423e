//! Bindings of points: barycentric, perspective_barycentric, closest_point_triangle.

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

/// `out`: the point, its distance, its weights, its region.
#[pyfunction]
pub fn closest_point_triangle(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |p: [T; 3], a: [T; 3], b: [T; 3], c: [T; 3]|
        -> (point: [T; 3], distance: [T; 1], weights: [T; 3], region: [i8; 1]) {
            let x = kernels::closest_point_triangle::closest_point_triangle(
                p.into(),
                [a.into(), b.into(), c.into()],
            );
            (x.point.to_array(), [x.distance], x.weights, [x.region])
        }
    )
}

#[pyfunction]
pub fn perspective_barycentric(
    py: Python<'_>,
    inverse: bool,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    elementwise!(py, given, out, |weights: [T; 3], w: [T; 3]| -> (found: [T; 3]) {
        kernels::perspective_barycentric::perspective_barycentric(inverse, weights, w)
    })
}
