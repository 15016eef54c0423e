//! Bindings of `shadow`: shadows in closed form.

use crate::python::array::{In, Out, run};
use crate::real;
use crate::shadow::half_plane::{HalfPlane, half_plane as kernel};
use crate::vec::Vec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

#[pyfunction]
pub fn half_plane(
    py: Python<'_>,
    corners: Vec<[f64; 3]>,
    occluders: Vec<[[f64; 3]; 3]>,
    receivers: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    if corners.len() < 3 {
        return Err(PyValueError::new_err("corners: expected at least 3"));
    }
    let corners: Vec<_> = corners.into_iter().map(Vec3::from).collect();
    let occluders: Vec<_> = occluders
        .into_iter()
        .map(|[edge, along, into]| HalfPlane { edge: edge.into(), along: along.into(), into: into.into() })
        .collect();
    real!(receivers, T => {
        let points = In::<T>::of("receivers", receivers)?;
        let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
        let mut out = Out::<T>::of("out", out)?;
        let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
        let out = out.slice()?;
        run(py, None, |watch| kernel(watch, &corners, &occluders, p, n, out))
    })
}
