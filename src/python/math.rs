//! Bindings of the elementary functions, for measuring them (no public face).
use pyo3::prelude::*;

#[pymodule]
pub mod math {
    use crate::math::{Binary, Unary, binary, unary};
    use crate::python::array::{In, Out, run};
    use crate::real;
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    fn map(py: Python<'_>, f: Unary, x: &Bound<'_, PyAny>, out: &Bound<'_, PyAny>) -> PyResult<()> {
        real!(x, T => {
            let x = In::<T>::of("x", x)?;
            let mut out = Out::<T>::of("out", out)?;
            let (x, out) = (x.slice()?, out.slice()?);
            run(py, None, |watch| unary(watch, f, x, out))
        })
    }

    fn zip(
        py: Python<'_>,
        f: Binary,
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(a, T => {
            let (a, b) = (In::<T>::of("a", a)?, In::<T>::of("b", b)?);
            let mut out = Out::<T>::of("out", out)?;
            let (a, b, out) = (a.slice()?, b.slice()?, out.slice()?);
            run(py, None, |watch| binary(watch, f, a, b, out))
        })
    }

    /// `out[i] = name(x[i])`.
    #[pyfunction]
    fn apply(py: Python<'_>, name: &str, x: &Bound<'_, PyAny>, out: &Bound<'_, PyAny>) -> PyResult<()> {
        let f = match name {
            "sin" => Unary::Sin,
            "cos" => Unary::Cos,
            "tan" => Unary::Tan,
            "asin" => Unary::Asin,
            "acos" => Unary::Acos,
            "exp" => Unary::Exp,
            "ln" => Unary::Ln,
            _ => return Err(PyValueError::new_err(format!("name: no function {name:?} of one argument"))),
        };
        map(py, f, x, out)
    }

    /// `out[i] = name(a[i], b[i])`.
    #[pyfunction]
    fn apply2(
        py: Python<'_>,
        name: &str,
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let f = match name {
            "atan2" => Binary::Atan2,
            "pow" => Binary::Pow,
            _ => return Err(PyValueError::new_err(format!("name: no function {name:?} of two arguments"))),
        };
        zip(py, f, a, b, out)
    }
}
