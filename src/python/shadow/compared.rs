//! Bindings of `shadow`: comparisons, one or many.

use super::{Geometry, Granted, Taps, bias, by_projection, map, pattern};
use crate::python::array::{In, Out, run};
use crate::real;
use crate::real::Real;
use pyo3::prelude::*;

#[pyfunction]
pub fn hard(
    py: Python<'_>,
    depth: &Bound<'_, PyAny>,
    geometry: Geometry,
    perspective: bool,
    receivers: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
    granted: Granted,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    use crate::shadow::hard::hard as kernel;
    real!(depth, T => {
        let (depth, points) = (In::<T>::of("depth", depth)?, In::<T>::of("receivers", receivers)?);
        let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
        let mut out = Out::<T>::of("out", out)?;
        let (map, bias) = (map(&depth, &geometry)?, bias(granted));
        let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
        let out = out.slice()?;
        run(py, None, |watch| by_projection!(perspective, T, kernel, (watch, &map, p, n, &bias, out)))
    })
}

#[pyfunction]
pub fn pcf(
    py: Python<'_>,
    depth: &Bound<'_, PyAny>,
    geometry: Geometry,
    perspective: bool,
    receivers: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
    taps: Taps<'_>,
    width: (f64, bool, bool),
    granted: Granted,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    use crate::shadow::pcf::{Radius, pcf as kernel};
    let (radius, texels, bilinear) = width;
    real!(depth, T => {
        let (depth, points) = (In::<T>::of("depth", depth)?, In::<T>::of("receivers", receivers)?);
        let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
        let mut out = Out::<T>::of("out", out)?;
        let (map, bias, taps) = (map(&depth, &geometry)?, bias(granted), pattern(taps)?);
        let radius = if texels { Radius::Texels(T::of(radius)) } else { Radius::World(T::of(radius)) };
        let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
        let out = out.slice()?;
        run(py, None, |watch| {
            by_projection!(perspective, T, kernel, (watch, &map, p, n, &taps, radius, bilinear, &bias, out))
        })
    })
}
