//! Bindings of `color`.
use pyo3::prelude::*;

#[pymodule]
pub mod color {
    use crate::color::luminance::luminance_many;
    use crate::color::tone_map::{ToneMap, tone_map_many};
    use crate::color::transfer::{Transfer, transfer_many};
    use crate::python::array::{In, Out, run};
    use crate::real;
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    #[pyfunction]
    fn transfer(
        py: Python<'_>,
        curve: &str,
        exponent: f64,
        values: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let curve = match curve {
            "encode_srgb" => Transfer::EncodeSrgb,
            "decode_srgb" => Transfer::DecodeSrgb,
            "power" => Transfer::Power(exponent),
            other => return Err(PyValueError::new_err(format!("curve: unknown {other}"))),
        };
        real!(values, T => {
            let (x, mut out) = (In::<T>::of("values", values)?, Out::<T>::of("out", out)?);
            let (x, out) = (x.slice()?, out.slice()?);
            run(py, None, |watch| transfer_many(watch, curve, x, out))
        })
    }

    #[pyfunction]
    fn tone_map(
        py: Python<'_>,
        method: &str,
        white: f64,
        scale: f64,
        values: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let curve = match method {
            "clip" => ToneMap::Clip,
            "reinhard" => ToneMap::Reinhard,
            "reinhard_extended" => ToneMap::ReinhardExtended { white },
            "aces" => ToneMap::Aces,
            other => return Err(PyValueError::new_err(format!("method: unknown {other}"))),
        };
        real!(values, T => {
            let (x, mut out) = (In::<T>::of("values", values)?, Out::<T>::of("out", out)?);
            let (x, out) = (x.slice()?, out.slice()?);
            run(py, None, |watch| tone_map_many(watch, curve, scale, x, out))
        })
    }

    #[pyfunction]
    fn luminance(py: Python<'_>, rgb: &Bound<'_, PyAny>, out: &Bound<'_, PyAny>) -> PyResult<()> {
        real!(rgb, T => {
            let (x, mut out) = (In::<T>::of("rgb", rgb)?, Out::<T>::of("out", out)?);
            let (x, out) = (x.items()?, out.slice()?);
            run(py, None, |watch| luminance_many(watch, x, out))
        })
    }
}
