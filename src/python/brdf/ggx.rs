//! Bindings of rough mirrors: value, sample, density.

use crate::brdf::ggx as rough;
use crate::brdf::{self, Masking};
use crate::lanewise;
use crate::python::array::{Arrays, unknown};
use crate::real::{Lanes, Real};
use pyo3::prelude::*;

/// `given`: wi, wo, f0, alpha.
#[pyfunction]
pub fn ggx(py: Python<'_>, masking: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let masking = match masking {
        "height_correlated" => Masking::HeightCorrelated,
        "separable" => Masking::Separable,
        other => return Err(unknown("masking", other)),
    };
    lanewise!(py, given, out, |wi: 3, wo: 3, f0: 3, alpha: 1| -> (f: 3) {
        rough::ggx(wi.into(), wo.into(), rough::width(alpha[0]), brdf::color(f0), masking).to_array()
    })
}

/// `given`: wo, two random numbers, alpha. NaN where `wo` is below the horizon.
#[pyfunction]
pub fn ggx_sample(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |wo: 3, u: 2, alpha: 1| -> (wi: 3) {
        let (zero, nan) = (wo[2].num(0.0), wo[2].like(<T as Real>::NAN));
        let alpha = Lanes::select(zero.less(wo[2]), rough::width(alpha[0]), nan);
        rough::ggx_sample(wo.into(), u, alpha).to_array()
    })
}

/// `given`: wi, wo, alpha.
#[pyfunction]
pub fn ggx_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |wi: 3, wo: 3, alpha: 1| -> (pdf: 1) {
        [rough::ggx_pdf(wi.into(), wo.into(), rough::width(alpha[0]))]
    })
}
