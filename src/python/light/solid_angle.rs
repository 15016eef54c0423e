//! Bindings of `solid_angle`.

use super::double_corners;
use crate::elementwise;
use crate::light::solid_angle as kernels;
use crate::python::array::Arrays;
use crate::python::array::unknown;
use crate::real::Real;
use crate::vec::Vec3;
use pyo3::prelude::*;

/// From a point to corners, in double.
#[inline(always)]
fn from<T: Real>(p: [T; 3], v: [T; 3]) -> Vec3<f64> {
    Vec3::from(v.map(T::to_f64)) - Vec3::from(p.map(T::to_f64))
}

#[inline(always)]
fn plain<T: Real>(v: [T; 3]) -> Vec3<f64> {
    Vec3::from(v.map(T::to_f64))
}

#[pyfunction]
pub fn solid_angle(py: Python<'_>, shape: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    match shape {
        "triangle" => {
            elementwise!(py, given, out, |p: [T; 3], a: [T; 3], b: [T; 3], c: [T; 3]| -> (w: [T; 1]) {
                [T::of(kernels::triangle(from(p, a), from(p, b), from(p, c)).abs())]
            })
        }
        "rectangle" => {
            elementwise!(py, given, out, |p: [T; 3], c: [T; 3], u: [T; 3], v: [T; 3]| -> (w: [T; 1]) {
                [T::of(kernels::rectangle(from(p, c), plain(u), plain(v)).abs())]
            })
        }
        "sphere" => elementwise!(py, given, out, |p: [T; 3], c: [T; 3], r: [T; 1]| -> (w: [T; 1]) {
            [T::of(kernels::sphere(from(p, c), r[0].to_f64()))]
        }),
        "box" => elementwise!(py, given, out, |p: [T; 3], a: [T; 3], b: [T; 3]| -> (w: [T; 1]) {
            [T::of(kernels::aabb(from(p, a), from(p, b)))]
        }),
        other => Err(unknown("shape", other)),
    }
}

#[pyfunction]
pub fn polygon_solid_angle(
    py: Python<'_>,
    corners: &Bound<'_, PyAny>,
    points: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    use crate::python::array::{In, Out, run};
    let corners = double_corners(corners)?;
    crate::real!(points, T => {
        let points = In::<T>::of("points", points)?;
        let mut out = Out::<T>::of("out", out)?;
        let (points, out) = (points.items()?, out.items()?);
        run(py, None, |watch| kernels::polygon_many(watch, &corners, points, out))
    })
}
