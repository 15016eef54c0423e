//! Bindings of `geometry`.
use pyo3::prelude::*;

#[pymodule]
pub mod geometry {
    use crate::geometry as kernels;
    use crate::python::array::{In, Out, run};
    use crate::real;
    use pyo3::prelude::*;

    #[pyfunction]
    fn barycentric(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
        c: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(points, T => {
            let (p, a, b, c) =
                (In::<T>::of("points", points)?, In::of("a", a)?, In::of("b", b)?, In::of("c", c)?);
            let mut out = Out::<T>::of("out", out)?;
            let (p, abc, out) = (p.items()?, [a.items()?, b.items()?, c.items()?], out.items()?);
            run(py, None, |watch| kernels::barycentric::barycentric_many(watch, p, abc, out))
        })
    }
}
