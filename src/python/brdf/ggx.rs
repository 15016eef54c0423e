//! Bindings of rough mirrors: value, sample, density.

use crate::brdf::ggx as rough;
use crate::python::array::{In, Out, run};
use crate::real;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

#[pyfunction]
pub fn ggx(
    py: Python<'_>,
    wi: &Bound<'_, PyAny>,
    wo: &Bound<'_, PyAny>,
    alpha: &Bound<'_, PyAny>,
    f0: &Bound<'_, PyAny>,
    masking: &str,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let masking = match masking {
        "height_correlated" => rough::Masking::HeightCorrelated,
        "separable" => rough::Masking::Separable,
        other => return Err(PyValueError::new_err(format!("masking: unknown {other:?}"))),
    };
    real!(out, T => {
        let (wi, wo) = (In::<T>::of("wi", wi)?, In::<T>::of("wo", wo)?);
        let (alpha, f0) = (In::<T>::of("alpha", alpha)?, In::<T>::of("f0", f0)?);
        let mut out = Out::<T>::of("out", out)?;
        let (wi, wo, alpha, f0, out) = (wi.items()?, wo.items()?, alpha.slice()?, f0.items()?, out.items()?);
        run(py, None, |watch| rough::ggx_many(watch, wi, wo, alpha, f0, masking, out))
    })
}

#[pyfunction]
pub fn ggx_sample(
    py: Python<'_>,
    wo: &Bound<'_, PyAny>,
    u: &Bound<'_, PyAny>,
    alpha: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let (wo, u, alpha) = (In::<T>::of("wo", wo)?, In::<T>::of("u", u)?, In::<T>::of("alpha", alpha)?);
        let mut out = Out::<T>::of("out", out)?;
        let (wo, u, alpha, out) = (wo.items()?, u.items()?, alpha.slice()?, out.items()?);
        run(py, None, |watch| rough::ggx_sample_many(watch, wo, u, alpha, out))
    })
}

#[pyfunction]
pub fn ggx_pdf(
    py: Python<'_>,
    wi: &Bound<'_, PyAny>,
    wo: &Bound<'_, PyAny>,
    alpha: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let (wi, wo, alpha) = (In::<T>::of("wi", wi)?, In::<T>::of("wo", wo)?, In::<T>::of("alpha", alpha)?);
        let mut out = Out::<T>::of("out", out)?;
        let (wi, wo, alpha, out) = (wi.items()?, wo.items()?, alpha.slice()?, out.slice()?);
        run(py, None, |watch| rough::ggx_pdf_many(watch, wi, wo, alpha, out))
    })
}
