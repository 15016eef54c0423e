//! Bindings of the measures of evenness.

use crate::python::array::{In, Out, run, unknown};
use crate::sampling::discrepancy::{self as square, Kind};
use crate::sampling::{power_spectrum as spectrum, star_discrepancy as star};
use pyo3::prelude::*;

#[pyfunction]
pub fn star_discrepancy(py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<f64> {
    let points = In::<f64>::of("points", points)?;
    let (dimensions, points) = (points.shape()[1], points.slice()?);
    run(py, None, |watch| star::star_discrepancy(watch, points, dimensions))
}

#[pyfunction]
pub fn discrepancy(py: Python<'_>, kind: &str, points: &Bound<'_, PyAny>) -> PyResult<f64> {
    let kind = match kind {
        "star" => Kind::Star,
        "centered" => Kind::Centered,
        "wraparound" => Kind::Wraparound,
        "mixture" => Kind::Mixture,
        other => return Err(unknown("kind", other)),
    };
    let points = In::<f64>::of("points", points)?;
    let (dimensions, points) = (points.shape()[1], points.slice()?);
    run(py, None, |watch| square::discrepancy(watch, kind, points, dimensions))
}

#[pyfunction]
pub fn power_spectrum(
    py: Python<'_>,
    points: &Bound<'_, PyAny>,
    reach: usize,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let (points, mut out) = (In::<f64>::of("points", points)?, Out::<f64>::of("out", out)?);
    let (points, out) = (points.items()?, out.slice()?);
    run(py, None, |watch| spectrum::power_spectrum(watch, points, reach, out))
}
