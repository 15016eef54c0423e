//! Bindings of the warps of disks, triangles and the hemisphere: disk, triangle, cosine_hemisphere, hemisphere.

use crate::python::array::{Arrays, unknown};
use crate::sampling::{cosine_hemisphere as cosine, disk, hemisphere, triangle};
use crate::{elementwise, lanewise};
use pyo3::prelude::*;

pub fn disk_method(method: &str) -> PyResult<disk::Method> {
    match method {
        "concentric" => Ok(disk::Method::Concentric),
        "polar" => Ok(disk::Method::Polar),
        _ => Err(unknown("method", method)),
    }
}

fn triangle_method(method: &str) -> PyResult<triangle::Method> {
    match method {
        "fold" => Ok(triangle::Method::Fold),
        "root" => Ok(triangle::Method::Root),
        _ => Err(unknown("method", method)),
    }
}

/// `body` with the method as a constant, so that its loop has no branch.
macro_rules! by_method {
    ($method:expr, |$m:ident| $body:expr) => {
        match disk_method($method)? {
            disk::Method::Concentric => {
                #[allow(non_upper_case_globals)]
                const $m: disk::Method = disk::Method::Concentric;
                $body
            }
            disk::Method::Polar => {
                #[allow(non_upper_case_globals)]
                const $m: disk::Method = disk::Method::Polar;
                $body
            }
        }
    };
}

#[pyfunction]
pub fn square_to_disk(py: Python<'_>, method: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    by_method!(method, |Chosen| lanewise!(py, given, out, |u: 2| -> (p: 2) {
        disk::square_to_disk(u, Chosen)
    }))
}

#[pyfunction]
pub fn disk_to_square(py: Python<'_>, method: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let method = disk_method(method)?;
    elementwise!(py, given, out, |p: [T; 2]| -> (u: [T; 2]) { disk::disk_to_square(p, method) })
}

#[pyfunction]
pub fn square_to_disk_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |p: [T; 2]| -> (pdf: [T; 1]) { [disk::square_to_disk_pdf(p)] })
}

#[pyfunction]
pub fn square_to_triangle(py: Python<'_>, method: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let method = triangle_method(method)?;
    elementwise!(py, given, out, |u: [T; 2]| -> (p: [T; 2]) { triangle::square_to_triangle(u, method) })
}

#[pyfunction]
pub fn triangle_to_square(py: Python<'_>, method: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let method = triangle_method(method)?;
    elementwise!(py, given, out, |p: [T; 2]| -> (u: [T; 2]) { triangle::triangle_to_square(p, method) })
}

#[pyfunction]
pub fn square_to_triangle_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |p: [T; 2]| -> (pdf: [T; 1]) { [triangle::square_to_triangle_pdf(p)] })
}

#[pyfunction]
pub fn square_to_cosine_hemisphere(
    py: Python<'_>,
    method: &str,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    by_method!(method, |Chosen| lanewise!(py, given, out, |u: 2| -> (d: 3) {
        cosine::square_to_cosine_hemisphere(u, Chosen).to_array()
    }))
}

#[pyfunction]
pub fn cosine_hemisphere_to_square(
    py: Python<'_>,
    method: &str,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let method = disk_method(method)?;
    elementwise!(py, given, out, |d: [T; 3]| -> (u: [T; 2]) {
        cosine::cosine_hemisphere_to_square(d.into(), method)
    })
}

#[pyfunction]
pub fn square_to_cosine_hemisphere_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |d: [T; 3]| -> (pdf: [T; 1]) {
        [cosine::square_to_cosine_hemisphere_pdf(d.into())]
    })
}

#[pyfunction]
pub fn square_to_hemisphere(
    py: Python<'_>,
    method: &str,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    by_method!(method, |Chosen| lanewise!(py, given, out, |u: 2| -> (d: 3) {
        hemisphere::square_to_hemisphere(u, Chosen).to_array()
    }))
}

#[pyfunction]
pub fn hemisphere_to_square(
    py: Python<'_>,
    method: &str,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let method = disk_method(method)?;
    elementwise!(py, given, out, |d: [T; 3]| -> (u: [T; 2]) {
        hemisphere::hemisphere_to_square(d.into(), method)
    })
}

#[pyfunction]
pub fn square_to_hemisphere_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |d: [T; 3]| -> (pdf: [T; 1]) {
        [hemisphere::square_to_hemisphere_pdf(d.into())]
    })
}
