//! Bindings of `sampling`.
use pyo3::prelude::*;

#[pymodule]
pub mod sampling {
    use crate::parallel::{Interrupted, Watch};
    use crate::python::array::{In, Out, run};
    use crate::real;
    use crate::real::Real;
    use crate::sampling::{cosine_hemisphere, disk, generator, sobol as sequence, triangle};
    use numpy::Element;
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    /// How many dimensions `sobol` has.
    #[pymodule_export]
    const SOBOL_DIMENSIONS: usize = sequence::DIMENSIONS;

    #[pyfunction]
    fn philox(
        py: Python<'_>,
        counter: &Bound<'_, PyAny>,
        key: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let (c, k) = (In::<u32>::of("counter", counter)?, In::<u32>::of("key", key)?);
        let mut out = Out::<u32>::of("out", out)?;
        let (c, k, out) = (c.items()?, k.items()?, out.items()?);
        run(py, None, |watch| generator::philox_many(watch, c, k, out))
    }

    #[pyfunction]
    fn uniform(
        py: Python<'_>,
        seed: u64,
        pixel: &Bound<'_, PyAny>,
        sample: &Bound<'_, PyAny>,
        dimension: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(out, T => {
            let p = In::<u64>::of("pixel", pixel)?;
            let (s, d) = (In::<u32>::of("sample", sample)?, In::<u32>::of("dimension", dimension)?);
            let mut out = Out::<T>::of("out", out)?;
            let (p, s, d, out) = (p.slice()?, s.slice()?, d.slice()?, out.slice()?);
            run(py, None, |watch| generator::uniform_many(watch, seed, p, s, d, out))
        })
    }

    /// `seed` None leaves the points unscrambled.
    #[pyfunction]
    fn sobol(py: Python<'_>, seed: Option<u64>, start: u64, out: &Bound<'_, PyAny>) -> PyResult<()> {
        real!(out, T => {
            let mut out = Out::<T>::of("out", out)?;
            let dimensions = out.shape()[1];
            let out = out.slice()?;
            run(py, None, |watch| sequence::sobol_many(watch, seed, start, dimensions, out))
        })
    }

    /// One array in, one out, item by item.
    fn warp<T: Real + Element, const A: usize, const B: usize>(
        py: Python<'_>,
        input: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
        kernel: impl FnOnce(&mut dyn Watch, &[[T; A]], &mut [[T; B]]) -> Result<(), Interrupted> + Send,
    ) -> PyResult<()> {
        let (input, mut out) = (In::<T>::of("input", input)?, Out::<T>::of("out", out)?);
        let (input, out) = (input.items()?, out.items()?);
        run(py, None, |watch| kernel(watch, input, out))
    }

    fn unknown(method: &str) -> PyErr {
        PyValueError::new_err(format!("method: unknown {method:?}"))
    }

    fn disk_method(method: &str) -> PyResult<disk::Method> {
        match method {
            "concentric" => Ok(disk::Method::Concentric),
            "polar" => Ok(disk::Method::Polar),
            _ => Err(unknown(method)),
        }
    }

    fn triangle_method(method: &str) -> PyResult<triangle::Method> {
        match method {
            "fold" => Ok(triangle::Method::Fold),
            "root" => Ok(triangle::Method::Root),
            _ => Err(unknown(method)),
        }
    }

    #[pyfunction]
    fn square_to_disk(
        py: Python<'_>,
        input: &Bound<'_, PyAny>,
        method: &str,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let method = disk_method(method)?;
        real!(out, T => warp(py, input, out, |w, i, o| disk::square_to_disk_many::<T>(w, i, method, o)))
    }

    #[pyfunction]
    fn disk_to_square(
        py: Python<'_>,
        input: &Bound<'_, PyAny>,
        method: &str,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let method = disk_method(method)?;
        real!(out, T => warp(py, input, out, |w, i, o| disk::disk_to_square_many::<T>(w, i, method, o)))
    }

    #[pyfunction]
    fn square_to_disk_pdf(py: Python<'_>, input: &Bound<'_, PyAny>, out: &Bound<'_, PyAny>) -> PyResult<()> {
        real!(out, T => warp(py, input, out, disk::square_to_disk_pdf_many::<T>))
    }

    #[pyfunction]
    fn square_to_triangle(
        py: Python<'_>,
        input: &Bound<'_, PyAny>,
        method: &str,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let method = triangle_method(method)?;
        real!(out, T => warp(py, input, out, |w, i, o| triangle::square_to_triangle_many::<T>(w, i, method, o)))
    }

    #[pyfunction]
    fn triangle_to_square(
        py: Python<'_>,
        input: &Bound<'_, PyAny>,
        method: &str,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let method = triangle_method(method)?;
        real!(out, T => warp(py, input, out, |w, i, o| triangle::triangle_to_square_many::<T>(w, i, method, o)))
    }

    #[pyfunction]
    fn square_to_triangle_pdf(
        py: Python<'_>,
        input: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(out, T => warp(py, input, out, triangle::square_to_triangle_pdf_many::<T>))
    }

    #[pyfunction]
    fn square_to_cosine_hemisphere(
        py: Python<'_>,
        input: &Bound<'_, PyAny>,
        method: &str,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let method = disk_method(method)?;
        real!(out, T => warp(py, input, out, |w, i, o| cosine_hemisphere::square_to_cosine_hemisphere_many::<T>(w, i, method, o)))
    }

    #[pyfunction]
    fn cosine_hemisphere_to_square(
        py: Python<'_>,
        input: &Bound<'_, PyAny>,
        method: &str,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let method = disk_method(method)?;
        real!(out, T => warp(py, input, out, |w, i, o| cosine_hemisphere::cosine_hemisphere_to_square_many::<T>(w, i, method, o)))
    }

    #[pyfunction]
    fn square_to_cosine_hemisphere_pdf(
        py: Python<'_>,
        input: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(out, T => warp(py, input, out, cosine_hemisphere::square_to_cosine_hemisphere_pdf_many::<T>))
    }
}
