//! Points against the hierarchy: closest_point, winding_number, pseudonormals.

use super::Tree;
use crate::accel::bvh::closest::{Found, closest_points};
use crate::accel::bvh::winding;
use crate::accel::pseudonormals::{self, NearestPoints};
use crate::parallel::run_forking;
use crate::python::array::{In, Out, run, same_length};
use crate::real;
use pyo3::prelude::*;
use std::sync::atomic::AtomicBool;

/// `out` is point, distance, face, u, v, feature.
#[pyfunction]
pub fn closest_point(
    py: Python<'_>,
    tree: &Tree,
    points: &Bound<'_, PyAny>,
    max_distance: &Bound<'_, PyAny>,
    out: [Bound<'_, PyAny>; 6],
    brute_force: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    real!(points, T => {
        let (points, limit) = (In::<T>::of("points", points)?, In::<T>::of("max_distance", max_distance)?);
        let (tree, points, limit) = (tree.of::<T>()?, points.items()?, limit.slice()?);
        let [point, distance, face, u, v, feature] = &out;
        let (mut point, mut distance) = (Out::<T>::of("point", point)?, Out::<T>::of("distance", distance)?);
        let (mut face, mut feature) = (Out::<i32>::of("face", face)?, Out::<i32>::of("feature", feature)?);
        let (mut u, mut v) = (Out::<T>::of("u", u)?, Out::<T>::of("v", v)?);
        let found = Found {
            point: point.items()?,
            distance: distance.slice()?,
            face: face.slice()?,
            u: u.slice()?,
            v: v.slice()?,
            feature: feature.slice()?,
        };
        run(py, progress, |watch| {
            if brute_force {
                closest_points::<true, T>(watch, tree, points, limit, found)
            } else {
                closest_points::<false, T>(watch, tree, points, limit, found)
            }
        })
    })
}

/// The moments of a tree's nodes.
#[pyclass(frozen)]
pub struct Moments(winding::Moments);

#[pymethods]
impl Moments {
    #[new]
    fn new(py: Python<'_>, tree: &Tree) -> PyResult<Self> {
        let work = |_: &AtomicBool| match tree.of::<f32>() {
            Ok(tree) => Ok(winding::Moments::new(tree)),
            Err(_) => tree.of::<f64>().map(|tree| winding::Moments::new(tree)),
        };
        run(py, None, |watch| run_forking(watch, work))?.map(Moments)
    }

    #[getter]
    fn bytes(&self) -> usize {
        self.0.bytes()
    }
}

/// Exact without moments.
#[pyfunction]
pub fn winding_number(
    py: Python<'_>,
    tree: &Tree,
    moments: Option<&Moments>,
    max_error: f64,
    points: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    real!(points, T => {
        let (points, mut out) = (In::<T>::of("points", points)?, Out::<T>::of("out", out)?);
        let (tree, points, out) = (tree.of::<T>()?, points.items()?, out.slice()?);
        let moments = moments.map(|m| &m.0);
        run(py, progress, |watch| winding::winding_numbers(watch, tree, moments, max_error, points, out))
    })
}

/// Normals of vertices and edges.
#[pyclass(frozen)]
pub struct Pseudonormals(pseudonormals::Pseudonormals);

#[pymethods]
impl Pseudonormals {
    #[new]
    fn new(py: Python<'_>, positions: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<Self> {
        real!(positions, T => {
            let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
            let (p, f) = (p.items()?, f.items()?);
            let work = |_: &AtomicBool| pseudonormals::Pseudonormals::new(p, f);
            run(py, None, |watch| run_forking(watch, work)).map(Pseudonormals)
        })
    }

    /// Turns distances of points inside negative. `nearest` is point, face, feature.
    fn sign(
        &self,
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        nearest: [Bound<'_, PyAny>; 3],
        distance: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(points, T => {
            let (points, point) = (In::<T>::of("points", points)?, In::<T>::of("point", &nearest[0])?);
            let (face, feature) = (In::<i32>::of("face", &nearest[1])?, In::<i32>::of("feature", &nearest[2])?);
            let mut distance = Out::<T>::of("distance", distance)?;
            let (points, distance) = (points.items()?, distance.slice()?);
            let (point, face, feature) = (point.items()?, face.slice()?, feature.slice()?);
            same_length(&[points.len(), point.len(), face.len(), feature.len(), distance.len()])?;
            let nearest = NearestPoints { point, face, feature };
            run(py, None, |watch| pseudonormals::sign(watch, &self.0, points, &nearest, distance))
        })
    }
}
