//! Bindings of overlap tests: three_planes, plane_aabb, plane_obb, aabb_aabb, obb_obb, sphere_sphere, sphere_aabb,
//! sphere_triangle, triangle_aabb, polygon_aabb, triangle_triangle. What is asked for beyond the answer has a binding
//! of its own, so that the answer alone costs no more than it must.

use crate::elementwise;
use crate::geometry::plane_obb::Obb;
use crate::geometry::predicate::point;
use crate::geometry::{self as kernels, polygon_aabb::Meeting};
use crate::parallel;
use crate::python::array::{Arrays, In, Out, first, run};
use crate::real::Real;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

fn of<T: Real, const N: usize>(v: [f64; N]) -> [T; N] {
    v.map(T::of)
}

#[pyfunction]
pub fn three_planes(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |a: [T; 4], b: [T; 4], c: [T; 4]| -> (p: [T; 3], volume: [T; 1]) {
        let (p, volume) = kernels::three_planes::three_planes([a, b, c]);
        (p, [volume])
    })
}

#[pyfunction]
pub fn plane_aabb(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |plane: [T; 4], low: [T; 3], high: [T; 3]| -> (side: [i8; 1]) {
        [kernels::plane_aabb::plane_aabb(plane, [low, high])]
    })
}

#[pyfunction]
pub fn plane_aabb_interval(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |plane: [T; 4], low: [T; 3], high: [T; 3]|
        -> (distance: [T; 1], radius: [T; 1]) {
        let [distance, radius] = kernels::plane_aabb::interval(plane, [low, high]);
        ([distance], [radius])
    })
}

#[pyfunction]
pub fn plane_obb(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |plane: [T; 4], center: [T; 3], axes: [T; 9], half: [T; 3]|
        -> (side: [i8; 1]) {
        [kernels::plane_obb::plane_obb(plane, center, axes, half)]
    })
}

#[pyfunction]
pub fn plane_obb_interval(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |plane: [T; 4], center: [T; 3], axes: [T; 9], half: [T; 3]|
        -> (distance: [T; 1], radius: [T; 1]) {
        let [distance, radius] = kernels::plane_obb::interval(plane, center, axes, half);
        ([distance], [radius])
    })
}

#[pyfunction]
pub fn aabb_aabb(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |al: [T; 3], ah: [T; 3], bl: [T; 3], bh: [T; 3]| -> (overlap: [bool; 1]) {
        [kernels::aabb_aabb::aabb_aabb([al, ah], [bl, bh])]
    })
}

#[pyfunction]
pub fn aabb_aabb_gaps(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |al: [T; 3], ah: [T; 3], bl: [T; 3], bh: [T; 3]| -> (gaps: [T; 3]) {
        kernels::aabb_aabb::gaps([al, ah], [bl, bh])
    })
}

#[pyfunction]
pub fn obb_obb(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |ac: [T; 3], aa: [T; 9], ah: [T; 3], bc: [T; 3], ba: [T; 9], bh: [T; 3]| -> (overlap: [bool; 1]) {
        [kernels::obb_obb::obb_obb(&Obb::new(ac, aa, ah), &Obb::new(bc, ba, bh))]
    })
}

#[pyfunction]
pub fn obb_obb_separation(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |ac: [T; 3], aa: [T; 9], ah: [T; 3], bc: [T; 3], ba: [T; 9], bh: [T; 3]|
        -> (overlap: [bool; 1], axis: [i32; 1], gap: [T; 1], direction: [T; 3]) {
        let s = kernels::obb_obb::separation(&Obb::new(ac, aa, ah), &Obb::new(bc, ba, bh));
        ([s.overlap], [s.axis], [T::of(s.gap)], of(s.direction))
    })
}

#[pyfunction]
pub fn sphere_sphere(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |a: [T; 3], ra: [T; 1], b: [T; 3], rb: [T; 1]| -> (overlap: [bool; 1]) {
        [kernels::sphere_sphere::sphere_sphere(a, ra[0], b, rb[0])]
    })
}

#[pyfunction]
pub fn sphere_aabb(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |c: [T; 3], r: [T; 1], low: [T; 3], high: [T; 3]| -> (overlap: [bool; 1]) {
        [kernels::sphere_aabb::sphere_aabb(c, r[0], [low, high])]
    })
}

#[pyfunction]
pub fn sphere_aabb_nearest(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |c: [T; 3], low: [T; 3], high: [T; 3]| -> (nearest: [T; 3]) {
        kernels::sphere_aabb::nearest(c, [low, high])
    })
}

#[pyfunction]
pub fn sphere_triangle(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |center: [T; 3], r: [T; 1], a: [T; 3], b: [T; 3], c: [T; 3]| -> (overlap: [bool; 1]) {
        [kernels::sphere_triangle::sphere_triangle(point(center), r[0].to_f64(), [point(a), point(b), point(c)])]
    })
}

/// The number of the axis that separates them.
#[pyfunction]
pub fn triangle_aabb(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |a: [T; 3], b: [T; 3], c: [T; 3], low: [T; 3], high: [T; 3]| -> (axis: [i32; 1]) {
        [kernels::triangle_aabb::separating_axis([point(a), point(b), point(c)], [point(low), point(high)])]
    })
}

#[pyfunction]
pub fn triangle_triangle(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |a0: [T; 3], a1: [T; 3], a2: [T; 3], b0: [T; 3], b1: [T; 3], b2: [T; 3]| -> (overlap: [bool; 1]) {
        let (a, b) = ([point(a0), point(a1), point(a2)], [point(b0), point(b1), point(b2)]);
        [kernels::triangle_triangle::triangle_triangle(a, b, false).overlap]
    })
}

#[pyfunction]
pub fn triangle_triangle_segment(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |a0: [T; 3], a1: [T; 3], a2: [T; 3], b0: [T; 3], b1: [T; 3], b2: [T; 3]|
        -> (overlap: [bool; 1], coplanar: [bool; 1], start: [T; 3], end: [T; 3]) {
        let (a, b) = ([point(a0), point(a1), point(a2)], [point(b0), point(b1), point(b2)]);
        let m = kernels::triangle_triangle::triangle_triangle(a, b, true);
        ([m.overlap], [m.coplanar], of(m.segment[0]), of(m.segment[1]))
    })
}

/// `given`: polygons of `corners` points each, lower and upper corners; `out`: what of them meets, as a number.
#[pyfunction]
pub fn polygon_aabb(
    py: Python<'_>,
    corners: usize,
    given: Arrays<'_>,
    out: Bound<'_, PyAny>,
) -> PyResult<()> {
    let [_, low, high] = &given[..] else { return Err(PyValueError::new_err("expected three arrays")) };
    crate::real!(first(&given)?, T => {
        let (polygons, low, high) = (In::<T>::of("polygons", &given[0])?, In::<T>::of("lower", low)?, In::<T>::of("upper", high)?);
        let (polygons, low, high) = (polygons.items::<3>()?, low.items::<3>()?, high.items::<3>()?);
        let mut out = Out::<i8>::of("out", &out)?;
        let out = out.slice()?;
        if polygons.len() != corners * out.len() || low.len() != out.len() || high.len() != out.len() {
            return Err(PyValueError::new_err("expected arrays of one length"));
        }
        run(py, None, |watch| parallel::for_each(watch, out, 1 << 10, |start, out: &mut [i8]| {
            let mut polygon = Vec::with_capacity(corners);
            for (k, out) in out.iter_mut().enumerate() {
                let i = start + k;
                polygon.clear();
                polygon.extend(polygons[corners * i..corners * (i + 1)].iter().map(|&p| point(p)));
                let meeting: Meeting = kernels::polygon_aabb::polygon_aabb(&polygon, [point(low[i]), point(high[i])]);
                *out = meeting as i8;
            }
        }))
    })
}
