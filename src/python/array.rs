//! The one place where dtype and shape become types.
//!
//! The Python face has coerced, broadcast and named its arguments (`shadelab._arrays`); what arrives is C-contiguous,
//! aligned, of one precision. Here arrays become slices, and [`run`] lets go of the interpreter while a kernel works,
//! answers Ctrl-C and reports progress. Results go into arrays that the face allocated (or the user's `out=`).

use crate::parallel::{Interrupted, Watch};
use numpy::{
    Element, PyArrayDyn, PyReadonlyArrayDyn, PyReadwriteArrayDyn, PyUntypedArray, PyUntypedArrayMethods,
};
use numpy::{PyArrayDescrMethods, PyArrayMethods};
use pyo3::exceptions::{PyKeyboardInterrupt, PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::ops::ControlFlow;

/// Whether an array holds doubles (else singles).
pub fn is_double(array: &Bound<'_, PyAny>) -> PyResult<bool> {
    let array = array.cast::<PyUntypedArray>().map_err(|_| PyTypeError::new_err("expected an array"))?;
    let dtype = array.dtype();
    if dtype.is_equiv_to(&numpy::dtype::<f64>(array.py())) {
        Ok(true)
    } else if dtype.is_equiv_to(&numpy::dtype::<f32>(array.py())) {
        Ok(false)
    } else {
        Err(PyTypeError::new_err(format!("expected float32 or float64, got {dtype}")))
    }
}

/// `real!(array, T => body)`: `body` with `T` bound to the precision of `array`.
#[macro_export]
macro_rules! real {
    ($array:expr, $t:ident => $body:expr) => {
        if $crate::python::array::is_double($array)? {
            type $t = f64;
            $body
        } else {
            type $t = f32;
            $body
        }
    };
}

/// An input array, held readable for as long as this lives.
pub struct In<'py, T: Element>(PyReadonlyArrayDyn<'py, T>);

impl<'py, T: Element> In<'py, T> {
    pub fn of(name: &str, array: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = array.cast::<PyArrayDyn<T>>().map_err(|_| wrong_type(name, array))?;
        Ok(In(array.try_readonly().map_err(|e| PyValueError::new_err(format!("{name}: {e}")))?))
    }
    pub fn slice(&self) -> PyResult<&[T]> {
        self.0.as_slice().map_err(|_| PyValueError::new_err("expected a contiguous array"))
    }
    #[allow(dead_code)]
    pub fn shape(&self) -> &[usize] {
        self.0.shape()
    }
}

impl<T: Element> In<'_, T> {
    /// As items of `N` components: an array `(n, N)`.
    pub fn items<const N: usize>(&self) -> PyResult<&[[T; N]]> {
        match self.slice()?.as_chunks() {
            (items, []) => Ok(items),
            (items, rest) => Err(uneven::<N>(items.len() * N + rest.len())),
        }
    }
}

/// An output array, held writable for as long as this lives.
pub struct Out<'py, T: Element>(PyReadwriteArrayDyn<'py, T>);

impl<'py, T: Element> Out<'py, T> {
    pub fn of(name: &str, array: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = array.cast::<PyArrayDyn<T>>().map_err(|_| wrong_type(name, array))?;
        Ok(Out(array.try_readwrite().map_err(|e| PyValueError::new_err(format!("{name}: {e}")))?))
    }
    pub fn slice(&mut self) -> PyResult<&mut [T]> {
        self.0.as_slice_mut().map_err(|_| PyValueError::new_err("expected a contiguous array"))
    }
    #[allow(dead_code)]
    pub fn shape(&self) -> &[usize] {
        self.0.shape()
    }
}

impl<T: Element> Out<'_, T> {
    pub fn items<const N: usize>(&mut self) -> PyResult<&mut [[T; N]]> {
        match self.slice()?.as_chunks_mut() {
            (items, []) => Ok(items),
            (items, rest) => Err(uneven::<N>(items.len() * N + rest.len())),
        }
    }
}

fn uneven<const N: usize>(n: usize) -> PyErr {
    PyValueError::new_err(format!("{n} elements do not make items of {N}"))
}

fn wrong_type(name: &str, got: &Bound<'_, PyAny>) -> PyErr {
    let got = got.getattr("dtype").map_or_else(|_| got.get_type().to_string(), |d| d.to_string());
    PyTypeError::new_err(format!("{name}: unexpected array type {got}"))
}

/// Polls for signals and calls the user's `progress(done, total)`; keeps what they raise.
struct PyWatch {
    progress: Option<Py<PyAny>>,
    raised: Option<PyErr>,
}

impl Watch for PyWatch {
    fn tick(&mut self, done: usize, total: usize) -> ControlFlow<()> {
        let result = Python::attach(|py| {
            py.check_signals()?;
            match &self.progress {
                Some(f) => f.call1(py, (done, total)).map(|_| ()),
                None => Ok(()),
            }
        });
        match result {
            Ok(()) => ControlFlow::Continue(()),
            Err(e) => {
                self.raised = Some(e);
                ControlFlow::Break(())
            }
        }
    }
}

/// Runs a kernel without the interpreter, watched.
pub fn run<R: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    kernel: impl FnOnce(&mut dyn Watch) -> Result<R, Interrupted> + Send,
) -> PyResult<R> {
    let mut watch = PyWatch { progress, raised: None };
    let result = py.detach(|| kernel(&mut watch));
    result.map_err(|Interrupted| watch.raised.take().unwrap_or_else(|| PyKeyboardInterrupt::new_err(())))
}
