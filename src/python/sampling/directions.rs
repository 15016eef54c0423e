//! Bindings of the warps of directions: sphere, cone, spherical_triangle, spherical_rectangle, area_to_solid_angle.

use super::warps::disk_method;
use crate::python::array::Arrays;
use crate::sampling::cone::Cone;
use crate::sampling::spherical_rectangle::SphericalRectangle;
use crate::sampling::spherical_triangle::SphericalTriangle;
use crate::sampling::{area_to_solid_angle as measure, sphere};
use crate::{elementwise, lanewise};
use pyo3::prelude::*;

#[pyfunction]
pub fn square_to_sphere(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |u: 2| -> (d: 3) {
        sphere::square_to_sphere(u).to_array()
    })
}

#[pyfunction]
pub fn sphere_to_square(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |d: [T; 3]| -> (u: [T; 2]) {
        sphere::sphere_to_square(d.into())
    })
}

#[pyfunction]
pub fn square_to_sphere_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |d: [T; 3]| -> (pdf: [T; 1]) {
        [sphere::square_to_sphere_pdf(d.into())]
    })
}

#[pyfunction]
pub fn square_to_cone(py: Python<'_>, method: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let method = disk_method(method)?;
    elementwise!(py, given, out, |u: [T; 2], angle: [T; 1]| -> (d: [T; 3]) {
        Cone::new(angle[0]).sample(u, method).to_array()
    })
}

#[pyfunction]
pub fn cone_to_square(py: Python<'_>, method: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let method = disk_method(method)?;
    elementwise!(py, given, out, |d: [T; 3], angle: [T; 1]| -> (u: [T; 2]) {
        Cone::new(angle[0]).invert(d.into(), method)
    })
}

#[pyfunction]
pub fn square_to_cone_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |d: [T; 3], angle: [T; 1]| -> (pdf: [T; 1]) {
        [Cone::new(angle[0]).pdf(d.into())]
    })
}

#[pyfunction]
pub fn square_to_spherical_triangle(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |u: [T; 2], a: [T; 3], b: [T; 3], c: [T; 3]| -> (d: [T; 3], size: [T; 1]) {
        let x = SphericalTriangle::new(a.into(), b.into(), c.into());
        (x.sample(u).to_array(), [x.solid_angle()])
    })
}

#[pyfunction]
pub fn spherical_triangle_to_square(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |d: [T; 3], a: [T; 3], b: [T; 3], c: [T; 3]| -> (u: [T; 2]) {
        SphericalTriangle::new(a.into(), b.into(), c.into()).invert(d.into())
    })
}

#[pyfunction]
pub fn square_to_spherical_triangle_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |d: [T; 3], a: [T; 3], b: [T; 3], c: [T; 3]| -> (pdf: [T; 1]) {
        [SphericalTriangle::new(a.into(), b.into(), c.into()).pdf(d.into())]
    })
}

#[pyfunction]
pub fn square_to_spherical_rectangle(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |u: [T; 2], center: [T; 3], edge_u: [T; 3], edge_v: [T; 3]| -> (d: [T; 3], size: [T; 1]) {
        let x = SphericalRectangle::new(center.into(), edge_u.into(), edge_v.into());
        (x.sample(u).to_array(), [x.solid_angle()])
    })
}

#[pyfunction]
pub fn spherical_rectangle_to_square(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |d: [T; 3], center: [T; 3], edge_u: [T; 3], edge_v: [T; 3]| -> (u: [T; 2]) {
        SphericalRectangle::new(center.into(), edge_u.into(), edge_v.into()).invert(d.into())
    })
}

#[pyfunction]
pub fn square_to_spherical_rectangle_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |d: [T; 3], center: [T; 3], edge_u: [T; 3], edge_v: [T; 3]| -> (pdf: [T; 1]) {
        [SphericalRectangle::new(center.into(), edge_u.into(), edge_v.into()).pdf(d.into())]
    })
}

#[pyfunction]
pub fn area_to_solid_angle(
    py: Python<'_>,
    inverse: bool,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    elementwise!(py, given, out, |density: [T; 1], point: [T; 3], normal: [T; 3], origin: [T; 3]| -> (pdf: [T; 1]) {
        [measure::area_to_solid_angle(inverse, density[0], point.into(), normal.into(), origin.into())]
    })
}
