//! Bindings of `image`.
use pyo3::prelude::*;

#[pymodule]
pub mod image {
    use crate::image::error_metrics::{Metric, mean};
    use crate::python::array::{In, Out, run, unknown};
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

    /// (H, W, C) as width, height, channels.
    fn sides(shape: &[usize]) -> PyResult<([usize; 2], usize)> {
        match shape {
            &[height, width, channels] => Ok(([width, height], channels)),
            other => Err(PyValueError::new_err(format!("image: expected shape (H, W, C), got {other:?}"))),
        }
    }

    /// `table` is (H + 1, W + 1, C); sums run in double if `wide`.
    #[pyfunction]
    fn summed_area_table(
        py: Python<'_>,
        image: &Bound<'_, PyAny>,
        wide: bool,
        table: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        use crate::image::summed_area_table::summed_area_table as kernel;
        real!(image, T => real!(table, O => {
            let (image, mut table) = (In::<T>::of("image", image)?, Out::<O>::of("table", table)?);
            let (size, channels) = sides(image.shape())?;
            if table.shape() != [size[1] + 1, size[0] + 1, channels] {
                return Err(PyValueError::new_err("table: unexpected shape"));
            }
            let (x, out) = (image.slice()?, table.slice()?);
            run(py, None, |watch| {
                if wide {
                    kernel::<T, f64, O>(watch, x, size, channels, out)
                } else {
                    kernel::<T, f32, O>(watch, x, size, channels, out)
                }
            })
        }))
    }

    #[pyfunction]
    fn gaussian_filter(
        py: Python<'_>,
        image: &Bound<'_, PyAny>,
        sigma: [f64; 2],
        truncate: f64,
        border: &str,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        use crate::image::gaussian_filter::{Border, gaussian_filter as kernel, weights};
        let border = match border {
            "nearest" => Border::Nearest,
            "reflect" => Border::Reflect,
            "wrap" => Border::Wrap,
            other => return Err(unknown("border", other)),
        };
        real!(image, T => {
            let (image, mut out) = (In::<T>::of("image", image)?, Out::<T>::of("out", out)?);
            let (size, channels) = sides(image.shape())?;
            let (across, downward) = (weights::<T>(sigma[0], truncate), weights::<T>(sigma[1], truncate));
            let (x, out) = (image.slice()?, out.slice()?);
            crate::python::array::same_length(&[x.len(), out.len()])?;
            run(py, None, |watch| kernel(watch, x, size, channels, [&across, &downward], border, out))
        })
    }

    /// The level below: `coarse` has half the sides, at least 1.
    #[pyfunction]
    fn mip_chain(
        py: Python<'_>,
        fine: &Bound<'_, PyAny>,
        fold: &str,
        coarse: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        use crate::image::mip_chain::{Fold, half, halve};
        let fold = match fold {
            "mean" => Fold::Mean,
            "min" => Fold::Least,
            "max" => Fold::Greatest,
            other => return Err(unknown("fold", other)),
        };
        real!(fine, T => {
            let (fine, mut coarse) = (In::<T>::of("fine", fine)?, Out::<T>::of("coarse", coarse)?);
            let (size, channels) = sides(fine.shape())?;
            if coarse.shape() != [half(size[1]), half(size[0]), channels] {
                return Err(PyValueError::new_err("coarse: unexpected shape"));
            }
            let (x, out) = (fine.slice()?, coarse.slice()?);
            run(py, None, |watch| halve(watch, x, size, channels, fold, out))
        })
    }
}
