//! The hierarchy moved, saved, and met by boxes: refit, to_bytes, from_bytes, overlap.

use super::Tree;
use super::tree::{Held, no_memory};
use crate::accel::Bvh;
use crate::accel::bvh::overlap::overlaps;
use crate::python::array::{In, run};
use crate::real;
use numpy::IntoPyArray;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

#[pyfunction]
pub fn refit(
    py: Python<'_>,
    tree: &Tree,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
) -> PyResult<Tree> {
    real!(positions, T => {
        let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
        let (tree, p, f) = (tree.of::<T>()?, p.items()?, f.items()?);
        Ok(Held::wrap(run(py, None, |watch| tree.refit(watch, p, f))?))
    })
}

#[pyfunction]
pub fn to_bytes<'py>(py: Python<'py>, tree: &Tree) -> PyResult<Bound<'py, PyBytes>> {
    let bytes = match tree.of::<f32>() {
        Ok(tree) => tree.to_bytes(),
        Err(_) => tree.of::<f64>()?.to_bytes(),
    };
    Ok(PyBytes::new(py, &bytes))
}

#[pyfunction]
pub fn from_bytes(
    py: Python<'_>,
    bytes: &[u8],
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
) -> PyResult<Tree> {
    real!(positions, T => {
        let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
        let (p, f) = (p.items()?, f.items()?);
        let tree = run(py, None, |watch| Bvh::from_bytes(watch, bytes, p, f))?;
        tree.map(Held::wrap).map_err(|wrong| PyValueError::new_err(format!("the saved tree is {wrong}")))
    })
}

/// Offsets and faces.
#[pyfunction]
pub fn overlap<'py>(
    py: Python<'py>,
    tree: &Tree,
    low: &Bound<'py, PyAny>,
    high: &Bound<'py, PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<[Bound<'py, PyAny>; 2]> {
    real!(low, T => {
        let (low, high) = (In::<T>::of("low", low)?, In::<T>::of("high", high)?);
        let (tree, low, high) = (tree.of::<T>()?, low.items()?, high.items()?);
        let found = run(py, progress, |watch| overlaps(watch, tree, low, high))?;
        let (offsets, faces) = found.map_err(|_| no_memory("faces"))?;
        Ok([offsets.into_pyarray(py).into_any(), faces.into_pyarray(py).into_any()])
    })
}
