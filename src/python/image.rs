//! Bindings of `image`.
use pyo3::prelude::*;

#[pymodule]
pub mod image {
    use crate::image::error_metrics::{Metric, mean};
    use crate::python::array::{In, run};
    use crate::real;
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    /// The mean term of a metric; arrays of one shape, a mask of one bool a pixel.
    #[pyfunction]
    fn mean_error(
        py: Python<'_>,
        metric: &str,
        epsilon: f64,
        image: &Bound<'_, PyAny>,
        reference: &Bound<'_, PyAny>,
        channels: usize,
        mask: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<f64> {
        let metric = match metric {
            "square" => Metric::Square,
            "relative_square" => Metric::RelativeSquare { epsilon },
            "symmetric_relative" => Metric::SymmetricRelative,
            other => return Err(PyValueError::new_err(format!("metric: unknown {other}"))),
        };
        let mask = mask.map(|m| In::<bool>::of("mask", m)).transpose()?;
        let mask = mask.as_ref().map(|m| m.slice()).transpose()?;
        real!(image, T => {
            let (x, r) = (In::<T>::of("image", image)?, In::<T>::of("reference", reference)?);
            let (x, r) = (x.slice()?, r.slice()?);
            run(py, None, |watch| mean(watch, metric, x, r, channels, mask))
        })
    }
}
