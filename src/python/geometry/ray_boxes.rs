//! Bindings of rays at boxes: ray_aabb, ray_obb.

use crate::elementwise;
use crate::geometry as kernels;
use crate::geometry::ray_aabb::Crossing;
use crate::python::array::{Arrays, unknown};
use crate::real::Real;
use crate::vec::Vec3;
use pyo3::prelude::*;

/// Entries into the slabs, then exits.
#[inline(always)]
fn borders<T: Real>(x: Crossing<T>) -> [T; 6] {
    let ([a, b, c], [d, e, f]) = (x.near, x.far);
    [a, b, c, d, e, f]
}

/// The rows of a matrix.
#[inline(always)]
fn rows<T: Real>([a, b, c, d, e, f, g, h, i]: [T; 9]) -> [Vec3<T>; 3] {
    [Vec3::new(a, b, c), Vec3::new(d, e, f), Vec3::new(g, h, i)]
}

/// With `full` two more results: entries into slabs and exits, and the faces.
#[pyfunction]
pub fn ray_aabb(
    py: Python<'_>,
    method: &str,
    full: bool,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    use kernels::ray_aabb::{Method, ray_aabb};
    let method = match method {
        "exact" => Method::Exact,
        "conservative" => Method::Conservative,
        "slabs" => Method::Slabs,
        _ => return Err(unknown("method", method)),
    };
    if !full {
        return elementwise!(py, given, out,
            |o: [T; 3], d: [T; 3], lower: [T; 3], upper: [T; 3], low: [T; 1], high: [T; 1]|
            -> (t: [T; 1], enter: [T; 1], exit: [T; 1]) {
                let x = ray_aabb(method, o.into(), d.into(), [lower, upper], low[0], high[0]);
                ([x.t], [x.enter], [x.exit])
            }
        );
    }
    elementwise!(py, given, out,
        |o: [T; 3], d: [T; 3], lower: [T; 3], upper: [T; 3], low: [T; 1], high: [T; 1]|
        -> (t: [T; 1], enter: [T; 1], exit: [T; 1], slabs: [T; 6], faces: [i32; 2]) {
            let x = ray_aabb(method, o.into(), d.into(), [lower, upper], low[0], high[0]);
            ([x.t], [x.enter], [x.exit], borders(x), x.faces)
        }
    )
}

/// With `full` two more results: entries into slabs and exits, and the faces.
#[pyfunction]
pub fn ray_obb(py: Python<'_>, full: bool, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    use kernels::ray_obb::ray_obb;
    if !full {
        return elementwise!(py, given, out,
            |o: [T; 3], d: [T; 3], center: [T; 3], axes: [T; 9], half: [T; 3], low: [T; 1], high: [T; 1]|
            -> (t: [T; 1], enter: [T; 1], exit: [T; 1]) {
                let x = ray_obb(o.into(), d.into(), center.into(), rows(axes), half, low[0], high[0]);
                ([x.t], [x.enter], [x.exit])
            }
        );
    }
    elementwise!(py, given, out,
        |o: [T; 3], d: [T; 3], center: [T; 3], axes: [T; 9], half: [T; 3], low: [T; 1], high: [T; 1]|
        -> (t: [T; 1], enter: [T; 1], exit: [T; 1], slabs: [T; 6], faces: [i32; 2]) {
            let x = ray_obb(o.into(), d.into(), center.into(), rows(axes), half, low[0], high[0]);
            ([x.t], [x.enter], [x.exit], borders(x), x.faces)
        }
    )
}
