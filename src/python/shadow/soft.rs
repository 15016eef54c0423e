//! Bindings of `shadow`: filters as wide as the blockers call for.

use super::{Chart, Granted, Taps, bias, by_projection, pattern};
use crate::python::array::{In, Out, run};
use crate::real;
use crate::real::Real;
use pyo3::prelude::*;

#[pyfunction]
pub fn pcss(
    py: Python<'_>,
    chart: Chart<'_>,
    receivers: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
    light: [f64; 2],
    search: Taps<'_>,
    frustum: bool,
    filter: Taps<'_>,
    granted: Granted,
    out: &Bound<'_, PyAny>,
    more: Option<[Bound<'_, PyAny>; 3]>,
) -> PyResult<()> {
    use crate::shadow::pcss::{Knobs, pcss as kernel};
    real!(receivers, T => {
        let (held, points) = (chart.held::<T>()?, In::<T>::of("receivers", receivers)?);
        let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
        let mut out = Out::<T>::of("out", out)?;
        let mut more = match &more {
            Some([a, b, c]) => Some((Out::<T>::of("blocker_depth", a)?, Out::of("penumbra", b)?, Out::of("search_radius", c)?)),
            None => None,
        };
        let more = match &mut more {
            Some((a, b, c)) => Some((a.slice()?, b.slice()?, c.slice()?)),
            None => None,
        };
        let (search, filter) = (pattern(search)?, pattern(filter)?);
        let knobs = Knobs { light: light.map(T::of), search: &search, frustum, filter: &filter, bias: bias(granted) };
        let map = held.map()?;
        let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
        let out = out.slice()?;
        run(py, None, |watch| by_projection!(chart.2, T, kernel, (watch, &map, p, n, &knobs, out, more)))
    })
}
