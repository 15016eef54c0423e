//! Bindings of rays: ray_plane, ray_sphere, ray_triangle.

use crate::elementwise;
use crate::geometry as kernels;
use crate::python::array::{Arrays, unknown};
use pyo3::prelude::*;

/// With `full` three more results: the line's parameter, the origin's distance, the cosine.
#[pyfunction]
pub fn ray_plane(py: Python<'_>, full: bool, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    use kernels::ray_plane::ray_plane;
    if !full {
        return elementwise!(py, given, out,
            |o: [T; 3], d: [T; 3], plane: [T; 4], low: [T; 1], high: [T; 1]| -> (t: [T; 1]) {
                [ray_plane(o.into(), d.into(), plane, low[0], high[0]).t]
            }
        );
    }
    elementwise!(py, given, out,
        |o: [T; 3], d: [T; 3], plane: [T; 4], low: [T; 1], high: [T; 1]|
        -> (t: [T; 1], line: [T; 1], distance: [T; 1], cosine: [T; 1]) {
            let x = ray_plane(o.into(), d.into(), plane, low[0], high[0]);
            ([x.t], [x.line], [x.distance], [x.cosine])
        }
    )
}

/// With `full` three more results: the line's nearest point, its distance, the discriminant.
#[pyfunction]
pub fn ray_sphere(
    py: Python<'_>,
    method: &str,
    full: bool,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    use kernels::ray_sphere::{Method, ray_sphere};
    let method = match method {
        "robust" => Method::Robust,
        "quadratic" => Method::Quadratic,
        "geometric" => Method::Geometric,
        _ => return Err(unknown("method", method)),
    };
    if !full {
        return elementwise!(py, given, out,
            |o: [T; 3], d: [T; 3], c: [T; 3], r: [T; 1], low: [T; 1], high: [T; 1]|
            -> (t: [T; 1], near: [T; 1], far: [T; 1]) {
                let hit = ray_sphere(method, o.into(), d.into(), c.into(), r[0], low[0], high[0]);
                ([hit.t], [hit.near], [hit.far])
            }
        );
    }
    elementwise!(py, given, out,
        |o: [T; 3], d: [T; 3], c: [T; 3], r: [T; 1], low: [T; 1], high: [T; 1]|
        -> (t: [T; 1], near: [T; 1], far: [T; 1], closest: [T; 1], distance: [T; 1], discriminant: [T; 1]) {
            let hit = ray_sphere(method, o.into(), d.into(), c.into(), r[0], low[0], high[0]);
            ([hit.t], [hit.near], [hit.far], [hit.closest], [hit.distance], [hit.discriminant])
        }
    )
}

/// `out`: t, u, v.
#[pyfunction]
pub fn ray_triangle(py: Python<'_>, method: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    use kernels::ray_triangle::{Method, ray_triangle};
    let method = match method {
        "watertight" => Method::Watertight,
        "moller_trumbore" => Method::MollerTrumbore,
        "plane" => Method::Plane,
        _ => return Err(unknown("method", method)),
    };
    elementwise!(py, given, out,
        |o: [T; 3], d: [T; 3], a: [T; 3], b: [T; 3], c: [T; 3], low: [T; 1], high: [T; 1]|
        -> (t: [T; 1], u: [T; 1], v: [T; 1]) {
            let triangle = [a.into(), b.into(), c.into()];
            let hit = ray_triangle(method, o.into(), d.into(), triangle, low[0], high[0]);
            ([hit.t], [hit.u], [hit.v])
        }
    )
}
