//! Builds of the structures that part space.

use super::tree::Other;
use crate::accel::{bsp_tree as bsp, kd_tree as kd, octree as oct, uniform_grid as grid};
use crate::python::array::{In, run};
use crate::real;
use pyo3::prelude::*;

#[pyfunction]
pub fn uniform_grid(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    resolution: [usize; 3],
    mailbox: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Other, [usize; 3])> {
    real!(positions, T => {
        let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
        let (p, f) = (p.items()?, f.items()?);
        let made = run(py, progress, |w| grid::UniformGrid::<T>::build(w, p, f, resolution, mailbox))?;
        let count = made.count();
        Ok((Other::new(made), count))
    })
}

#[pyfunction]
pub fn octree(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    leaf_size: usize,
    max_depth: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Other> {
    real!(positions, T => {
        let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
        let (p, f) = (p.items()?, f.items()?);
        Ok(Other::new(run(py, progress, |w| oct::Octree::<T>::build(w, p, f, leaf_size, max_depth))?))
    })
}

#[pyfunction]
pub fn kd_tree(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    method: &str,
    leaf_size: usize,
    max_depth: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Other> {
    let method = if method == "median" { kd::Method::Median } else { kd::Method::Sah };
    real!(positions, T => {
        let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
        let (p, f) = (p.items()?, f.items()?);
        Ok(Other::new(run(py, progress, |w| kd::build::<T>(w, p, f, method, leaf_size, max_depth))?))
    })
}

#[pyfunction]
pub fn bsp_tree(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    method: &str,
    leaf_size: usize,
    max_depth: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Other> {
    real!(positions, T => {
        let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
        let (p, f) = (p.items()?, f.items()?);
        Ok(if method == "polygon_aligned" {
            Other::new(run(py, progress, |w| bsp::PolygonTree::<T>::build(w, p, f, leaf_size, max_depth))?)
        } else {
            Other::new(run(py, progress, |w| bsp::axis_aligned::<T>(w, p, f, leaf_size, max_depth))?)
        })
    })
}
