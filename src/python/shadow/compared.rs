//! Bindings of `shadow`: comparisons, one or many.

use super::{Chart, Granted, Taps, bias, by_projection, pattern};
use crate::python::array::{In, Out, run};
use crate::real;
use crate::real::Real;
use pyo3::prelude::*;

#[pyfunction]
pub fn hard(
    py: Python<'_>,
    chart: Chart<'_>,
    receivers: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
    granted: Granted,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    use crate::shadow::hard::hard as kernel;
    real!(receivers, T => {
        let (held, points) = (chart.held::<T>()?, In::<T>::of("receivers", receivers)?);
        let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
        let mut out = Out::<T>::of("out", out)?;
        let (map, bias) = (held.map()?, bias(granted));
        let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
        let out = out.slice()?;
        run(py, None, |watch| by_projection!(chart.2, T, kernel, (watch, &map, p, n, &bias, out)))
    })
}

#[pyfunction]
pub fn pcf(
    py: Python<'_>,
    chart: Chart<'_>,
    receivers: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
    taps: Taps<'_>,
    width: (f64, bool, bool),
    granted: Granted,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    use crate::shadow::pcf::{Radius, pcf as kernel};
    let (radius, texels, bilinear) = width;
    real!(receivers, T => {
        let (held, points) = (chart.held::<T>()?, In::<T>::of("receivers", receivers)?);
        let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
        let mut out = Out::<T>::of("out", out)?;
        let (map, bias, taps) = (held.map()?, bias(granted), pattern(taps)?);
        let radius = if texels { Radius::Texels(T::of(radius)) } else { Radius::World(T::of(radius)) };
        let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
        let out = out.slice()?;
        run(py, None, |watch| {
            by_projection!(chart.2, T, kernel, (watch, &map, p, n, &taps, radius, bilinear, &bias, out))
        })
    })
}
