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

/// Arrays as the face hands them over, in the order of a kernel's arguments.
pub type Arrays<'py> = Vec<Bound<'py, PyAny>>;

/// Items of an array: `[T; N]` for the numbers of a kernel's precision, `[i32; N]`, `[bool; N]` for others.
pub trait Item: Copy + Send + Sync {
    type Element: Element;
    fn items<'a>(array: &'a In<Self::Element>) -> PyResult<&'a [Self]>;
    fn items_mut<'a>(array: &'a mut Out<Self::Element>) -> PyResult<&'a mut [Self]>;
}

impl<E: Element + Copy + Send + Sync, const N: usize> Item for [E; N] {
    type Element = E;
    fn items<'a>(array: &'a In<E>) -> PyResult<&'a [Self]> {
        array.items()
    }
    fn items_mut<'a>(array: &'a mut Out<E>) -> PyResult<&'a mut [Self]> {
        array.items()
    }
}

/// The body of a binding whose kernel works element by element on arrays of equal length:
/// `elementwise!(py, given, out, |a: [T; 3], b: [T; 1]| -> (x: [T; 3], hit: [bool; 1]) { … (x, [hit]) })`. The first array
/// given is of the precision `T`. The block is compiled inside the dispatch, within the parallel task; what it calls
/// should be `#[inline(always)]`.
#[macro_export]
macro_rules! elementwise {
    ($py:expr, $given:expr, $out:expr,
     |$($x:ident: $xt:ty),+ $(,)?| -> ($($y:ident: $yt:ty),+ $(,)?) $body:block) => {
        $crate::real!($crate::python::array::first(&$given)?, T => {
            use $crate::python::array::{In, Item, Out, next, run};
            let (mut given, mut out) = ($given.iter(), $out.iter());
            $(let $x = In::<<$xt as Item>::Element>::of(stringify!($x), next(&mut given)?)?;)+
            $(let mut $y = Out::<<$yt as Item>::Element>::of(stringify!($y), next(&mut out)?)?;)+
            $(let $x = <$xt as Item>::items(&$x)?;)+
            $(let $y = <$yt as Item>::items_mut(&mut $y)?;)+
            $crate::python::array::same_length(&[$($x.len(),)+ $($y.len(),)+])?;
            run($py, None, |watch| {
                $crate::parallel::for_each(watch, ($($x,)+ $($y,)+), 1 << 12, |_, ($($x,)+ $($y,)+)| {
                    $crate::dispatch!(_s => {
                        let n = 0;
                        $(let n = $x.len().max(n);)+
                        $(let $x = &$x[..n];)+
                        $(let $y = &mut $y[..n];)+
                        for i in 0..n {
                            $(let $x = $x[i];)+
                            ($($y[i]),+) = $body;
                        }
                    })
                })
            })
        })
    };
}

/// As [`elementwise!`] with the block in lanes: `lanewise!(py, given, out, |a: 3, b: 1| -> (x: 3) { … })`. Names stand for
/// arrays of that many vectors of eight lanes, one for each component; arrays given may hold one item for all.
#[macro_export]
macro_rules! lanewise {
    ($py:expr, $given:expr, $out:expr,
     |$($x:ident: $xn:literal),+ $(,)?| -> ($($y:ident: $yn:literal),+ $(,)?) $body:block) => {
        $crate::real!($crate::python::array::first(&$given)?, T => {
            use $crate::python::array::{In, Out, next, run};
            use $crate::simd::columns::{Sink, Source};
            let (mut given, mut out) = ($given.iter(), $out.iter());
            $(let $x = In::<T>::of(stringify!($x), next(&mut given)?)?;)+
            $(let mut $y = Out::<T>::of(stringify!($y), next(&mut out)?)?;)+
            $(let $x = $x.items::<$xn>()?;)+
            $(let $y = $y.items::<$yn>()?;)+
            let n = [$($y.len()),+];
            $crate::python::array::same_length(&n)?;
            let n = n[0];
            $crate::python::array::same_length(&[n, $(if $x.len() == 1 { n } else { $x.len() }),+])?;
            run($py, None, |watch| {
                $crate::parallel::for_each(watch, ($($y,)+), 1 << 12, |first, ($($y,)+)| {
                    $crate::dispatch!(s => {
                        let n = 0;
                        $(let n = $y.len().max(n);)+
                        $(let mut $x = Source::over($x, first);)+
                        $(let mut $y = Sink::over(s, $y);)+
                        $crate::in_lanes!(s, n, |$($x),+| -> ($($y),+) $body)
                    })
                })
            })
        })
    };
}

/// The array that says which precision a kernel works in.
pub fn first<'a, 'py>(arrays: &'a Arrays<'py>) -> PyResult<&'a Bound<'py, PyAny>> {
    next(&mut arrays.iter())
}

pub fn next<'a, 'py>(
    arrays: &mut impl Iterator<Item = &'a Bound<'py, PyAny>>,
) -> PyResult<&'a Bound<'py, PyAny>>
where
    'py: 'a,
{
    arrays.next().ok_or_else(|| PyTypeError::new_err("expected more arrays"))
}

/// An option that the face should have refused.
pub fn unknown(name: &str, got: &str) -> PyErr {
    PyValueError::new_err(format!("{name}: unknown, got {got:?}"))
}

pub fn same_length(lengths: &[usize]) -> PyResult<()> {
    let same = lengths.windows(2).all(|w| w[0] == w[1]);
    if same { Ok(()) } else { Err(PyValueError::new_err("expected arrays of one length")) }
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

/// Runs a kernel without the interpreter, watched. Inlined, for the reason that [`crate::parallel`] gives.
#[inline]
pub fn run<R: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    kernel: impl FnOnce(&mut dyn Watch) -> Result<R, Interrupted> + Send,
) -> PyResult<R> {
    let (mut kernel, mut result) = (Some(kernel), Err(Interrupted));
    run_watched(py, progress, &mut |watch| {
        result = kernel.take().map_or(Err(Interrupted), |kernel| kernel(watch));
        if result.is_ok() { Ok(()) } else { Err(Interrupted) }
    })?;
    result.map_err(|Interrupted| PyKeyboardInterrupt::new_err(()))
}

/// A kernel behind a pointer.
type Kernel<'a> = &'a mut (dyn FnMut(&mut dyn Watch) -> Result<(), Interrupted> + Send);

fn run_watched(py: Python<'_>, progress: Option<Py<PyAny>>, kernel: Kernel) -> PyResult<()> {
    let mut watch = PyWatch { progress, raised: None };
    let result = py.detach(|| kernel(&mut watch));
    result.map_err(|Interrupted| watch.raised.take().unwrap_or_else(|| PyKeyboardInterrupt::new_err(())))
}
