//! Points against the hierarchy: closest_point.

use super::Tree;
use crate::accel::bvh::closest::{Found, closest_points};
use crate::python::array::{In, Out, run};
use crate::real;
use pyo3::prelude::*;

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
