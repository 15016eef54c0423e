//! Bindings of bounding volumes: bounding_aabb, bounding_sphere, bounding_obb, bounding_kdop. Points come as sets of
//! `size` each.

use crate::dispatch;
use crate::geometry::{
    bounding_aabb as aabb, bounding_kdop as kdop, bounding_obb as obb, bounding_sphere as sphere,
};
use crate::parallel::{self, Rows};
use crate::python::array::{Arrays, In, Out, run};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// How many sets make a task of some milliseconds.
fn sets_a_task(size: usize, points_a_task: usize) -> usize {
    (points_a_task / size.max(1)).max(1)
}

fn check(points: usize, size: usize, sets: usize) -> PyResult<()> {
    if points == size * sets { Ok(()) } else { Err(PyValueError::new_err("expected arrays of one length")) }
}

#[pyfunction]
pub fn bounding_aabb(py: Python<'_>, size: usize, points: Bound<'_, PyAny>, out: Arrays<'_>) -> PyResult<()> {
    let [low, high] = &out[..] else { return Err(PyValueError::new_err("expected two outputs")) };
    crate::real!(&points, T => {
        let points = In::<T>::of("points", &points)?;
        let (mut low, mut high) = (Out::<T>::of("lower", low)?, Out::<T>::of("upper", high)?);
        let (points, low, high) = (points.items::<3>()?, low.items::<3>()?, high.items::<3>()?);
        check(points.len(), size, low.len())?;
        run(py, None, |watch| parallel::for_each(watch, (low, high), sets_a_task(size, 1 << 18), |start, (low, high)| {
            for (k, (low, high)) in low.iter_mut().zip(high).enumerate() {
                let set = &points[(start + k) * size..(start + k + 1) * size];
                [*low, *high] = dispatch!(_s => aabb::bounding_aabb(set));
            }
        }))
    })
}

#[pyfunction]
pub fn bounding_sphere(
    py: Python<'_>,
    method: &str,
    size: usize,
    points: Bound<'_, PyAny>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let method = match method {
        "minimal" => sphere::Method::Minimal,
        "ritter" => sphere::Method::Ritter,
        _ => return Err(PyValueError::new_err(format!("method: unknown, got {method:?}"))),
    };
    let [center, radius, support] = &out[..] else {
        return Err(PyValueError::new_err("expected three outputs"));
    };
    crate::real!(&points, T => {
        let points = In::<T>::of("points", &points)?;
        let (mut center, mut radius) = (Out::<T>::of("center", center)?, Out::<T>::of("radius", radius)?);
        let mut support = Out::<i32>::of("support", support)?;
        let points = points.items::<3>()?;
        let (center, radius, support) = (center.items::<3>()?, radius.slice()?, support.items::<4>()?);
        check(points.len(), size, radius.len())?;
        let out = (center, radius, support);
        run(py, None, |watch| parallel::for_each(watch, out, sets_a_task(size, 1 << 15), |start, (center, radius, support)| {
            for k in 0..radius.len() {
                let s = sphere::bounding_sphere(&points[(start + k) * size..(start + k + 1) * size], method);
                (center[k], radius[k], support[k]) = (s.center, s.radius, s.support);
            }
        }))
    })
}

#[pyfunction]
pub fn bounding_obb(
    py: Python<'_>,
    method: &str,
    size: usize,
    points: Bound<'_, PyAny>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let method = match method {
        "pca" => obb::Method::Pca,
        "dito" => obb::Method::Dito,
        "calipers" => obb::Method::Calipers,
        _ => return Err(PyValueError::new_err(format!("method: unknown, got {method:?}"))),
    };
    let [center, axes, half] = &out[..] else { return Err(PyValueError::new_err("expected three outputs")) };
    crate::real!(&points, T => {
        let points = In::<T>::of("points", &points)?;
        let (mut center, mut axes) = (Out::<T>::of("center", center)?, Out::<T>::of("axes", axes)?);
        let mut half = Out::<T>::of("half_extents", half)?;
        let points = points.items::<3>()?;
        let (center, axes, half) = (center.items::<3>()?, axes.items::<9>()?, half.items::<3>()?);
        check(points.len(), size, half.len())?;
        let out = (center, axes, half);
        let (task, long) = (sets_a_task(size, 1 << 12), size > 1 << 14);
        run(py, None, |watch| {
            parallel::for_each_stoppable(watch, out, task, long, |start, (center, axes, half), stop| {
                for k in 0..half.len() {
                    let set = &points[(start + k) * size..(start + k + 1) * size];
                    (center[k], axes[k], half[k]) = obb::bounding_obb(set, method, stop);
                }
            })
        })
    })
}

/// The directions of a polytope of `k` sides.
#[pyfunction]
pub fn kdop_directions(k: usize) -> PyResult<Vec<[i8; 3]>> {
    let places = kdop::directions(k).ok_or_else(|| PyValueError::new_err(format!("k: unknown, got {k}")))?;
    Ok(places.iter().map(|&i| kdop::DIRECTIONS[i]).collect())
}

#[pyfunction]
pub fn bounding_kdop(
    py: Python<'_>,
    k: usize,
    size: usize,
    points: Bound<'_, PyAny>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let directions = kdop_directions(k)?;
    let [low, high] = &out[..] else { return Err(PyValueError::new_err("expected two outputs")) };
    crate::real!(&points, T => {
        let points = In::<T>::of("points", &points)?;
        let (mut low, mut high) = (Out::<T>::of("lower", low)?, Out::<T>::of("upper", high)?);
        let points = points.items::<3>()?;
        let n = directions.len();
        let (low, high) = (Rows { data: low.slice()?, width: n }, Rows { data: high.slice()?, width: n });
        check(points.len(), size, low.data.len() / n)?;
        run(py, None, |watch| parallel::for_each(watch, (low, high), sets_a_task(size, 1 << 15), |start, (low, high)| {
            for (i, (low, high)) in low.data.iter_mut().zip(high.data).enumerate() {
                let set = &points[(start + i / n) * size..(start + i / n + 1) * size];
                [*low, *high] = dispatch!(_s => kdop::extent(set, directions[i % n]));
            }
        }))
    })
}
