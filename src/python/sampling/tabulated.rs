//! Bindings of tabulated densities and of alias tables: tabulated, alias_table.

use crate::python::array::{Arrays, In, Out, first, run};
use crate::real::Real;
use crate::sampling::alias_table as alias;
use crate::sampling::tabulated::{Invalid, Tabulated1D, Tabulated2D, most_cells};
use crate::{dispatch, elementwise, parallel, real};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// What is wrong with weights, by the names of the face.
fn invalid<T: Real>(error: Invalid, width: Option<usize>) -> PyErr {
    PyValueError::new_err(match error {
        Invalid::Weight(at) => {
            let at = width.map_or(format!("{at}"), |w| format!("({}, {})", at / w, at % w));
            format!("weights: expected finite numbers of at least 0, got another at {at}")
        }
        Invalid::Empty => "weights: expected a positive one, got none".to_string(),
        Invalid::Length(n) => {
            format!(
                "weights: expected 1 to {} of them along an axis in this precision, got {n}",
                most_cells::<T>()
            )
        }
    })
}

/// A table in either precision.
enum Either<S, D> {
    Single(S),
    Double(D),
}

#[pyclass(frozen)]
pub struct Table1D(Either<Tabulated1D<f32>, Tabulated1D<f64>>);

#[pyclass(frozen)]
pub struct Table2D(Either<Tabulated2D<f32>, Tabulated2D<f64>>);

/// A precision that tables are held in.
pub trait Held: Real {
    fn wrap(table: Tabulated1D<Self>) -> Table1D;
    fn pick(table: &Table1D) -> Option<&Tabulated1D<Self>>;
    fn wrap2(table: Tabulated2D<Self>) -> Table2D;
    fn pick2(table: &Table2D) -> Option<&Tabulated2D<Self>>;
}

macro_rules! held {
    ($t:ty, $variant:ident) => {
        impl Held for $t {
            fn wrap(table: Tabulated1D<$t>) -> Table1D {
                Table1D(Either::$variant(table))
            }
            fn pick(table: &Table1D) -> Option<&Tabulated1D<$t>> {
                if let Either::$variant(t) = &table.0 { Some(t) } else { None }
            }
            fn wrap2(table: Tabulated2D<$t>) -> Table2D {
                Table2D(Either::$variant(table))
            }
            fn pick2(table: &Table2D) -> Option<&Tabulated2D<$t>> {
                if let Either::$variant(t) = &table.0 { Some(t) } else { None }
            }
        }
    };
}
held!(f32, Single);
held!(f64, Double);

fn other_precision() -> PyErr {
    PyTypeError::new_err("the table is of another precision")
}

impl Table1D {
    fn of<T: Held>(&self) -> PyResult<&Tabulated1D<T>> {
        T::pick(self).ok_or_else(other_precision)
    }
}

impl Table2D {
    /// The table, if it is of this precision.
    pub fn of<T: Held>(&self) -> PyResult<&Tabulated2D<T>> {
        T::pick2(self).ok_or_else(other_precision)
    }
}

/// `each!(py, given, out, get, |table, u: [T; 1]| -> (…) { … })`: `elementwise!` with a table in the block, taken from
/// `$get` in the arrays' precision.
macro_rules! with_table {
    ($py:expr, $table:expr, $given:expr, $out:expr, |$t:ident, $x:ident: $xt:ty| -> ($($y:ident: $yt:ty),+) $body:block) => {
        real!(first(&$given)?, T => {
            use crate::python::array::{Item, next};
            let $t = $table.of::<T>()?;
            let (mut given, mut out) = ($given.iter(), $out.iter());
            let $x = In::<<$xt as Item>::Element>::of(stringify!($x), next(&mut given)?)?;
            $(let mut $y = Out::<<$yt as Item>::Element>::of(stringify!($y), next(&mut out)?)?;)+
            let $x = <$xt as Item>::items(&$x)?;
            $(let $y = <$yt as Item>::items_mut(&mut $y)?;)+
            crate::python::array::same_length(&[$x.len(), $($y.len()),+])?;
            run($py, None, |watch| {
                parallel::for_each(watch, ($x, $($y),+), 1 << 12, |_, ($x, $($y),+)| {
                    dispatch!(_s => for i in 0..$x.len() {
                        let $x = $x[i];
                        ($($y[i]),+) = $body;
                    })
                })
            })
        })
    };
}

#[pymethods]
impl Table1D {
    #[new]
    fn new(py: Python<'_>, weights: &Bound<'_, PyAny>) -> PyResult<Self> {
        real!(weights, T => {
            let weights = In::<T>::of("weights", weights)?;
            let weights = weights.slice()?;
            let table = py.detach(|| Tabulated1D::new(weights));
            table.map(Held::wrap).map_err(|e| invalid::<T>(e, None))
        })
    }
    fn mean(&self) -> f64 {
        match &self.0 {
            Either::Single(t) => t.mean(),
            Either::Double(t) => t.mean(),
        }
    }
    fn sample(&self, py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
        with_table!(py, self, given, out, |table, u: [T; 1]| -> (x: [T; 1], pdf: [T; 1], cell: [i32; 1]) {
            let drawn = table.sample(u[0]);
            ([drawn.x], [drawn.pdf], [if drawn.x.is_nan() { -1 } else { drawn.cell as i32 }])
        })
    }
    fn pdf(&self, py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
        with_table!(py, self, given, out, |table, x: [T; 1]| -> (pdf: [T; 1]) { [table.pdf(x[0])] })
    }
    fn invert(&self, py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
        with_table!(py, self, given, out, |table, x: [T; 1]| -> (u: [T; 1]) { [table.invert(x[0])] })
    }
}

#[pymethods]
impl Table2D {
    #[new]
    fn new(py: Python<'_>, weights: &Bound<'_, PyAny>) -> PyResult<Self> {
        real!(weights, T => {
            let weights = In::<T>::of("weights", weights)?;
            let width = weights.shape()[1];
            let weights = weights.slice()?;
            let table = run(py, None, |watch| Tabulated2D::new(watch, weights, width))?;
            table.map(Held::wrap2).map_err(|e| invalid::<T>(e, Some(width)))
        })
    }
    fn mean(&self) -> f64 {
        match &self.0 {
            Either::Single(t) => t.mean(),
            Either::Double(t) => t.mean(),
        }
    }
    /// The density along the columns' axis within a row, or, without one, along the rows' axis.
    #[pyo3(signature = (row=None))]
    fn along(&self, row: Option<usize>) -> Table1D {
        fn part<T: Held>(table: &Tabulated2D<T>, row: Option<usize>) -> Table1D {
            Held::wrap(row.map_or_else(|| table.marginal().clone(), |row| table.conditional(row)))
        }
        match &self.0 {
            Either::Single(t) => part(t, row),
            Either::Double(t) => part(t, row),
        }
    }
    fn sample(&self, py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
        with_table!(py, self, given, out, |table, u: [T; 2]| -> (x: [T; 2], pdf: [T; 1], cell: [i32; 2]) {
            let drawn = table.sample(u);
            let lost = drawn.pdf.is_nan();
            (
                if lost { [T::NAN; 2] } else { drawn.point },
                [drawn.pdf],
                if lost { [-1; 2] } else { drawn.cell.map(|c| c as i32) },
            )
        })
    }
    fn pdf(&self, py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
        with_table!(py, self, given, out, |table, x: [T; 2]| -> (pdf: [T; 1]) { [table.pdf(x)] })
    }
    fn invert(&self, py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
        with_table!(py, self, given, out, |table, x: [T; 2]| -> (u: [T; 2]) { table.invert(x) })
    }
}

#[pyfunction]
pub fn alias_table(
    py: Python<'_>,
    weights: &Bound<'_, PyAny>,
    share: &Bound<'_, PyAny>,
    index: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(weights, T => {
        let weights = In::<T>::of("weights", weights)?;
        let (mut share, mut index) = (Out::<T>::of("share", share)?, Out::<u32>::of("alias", index)?);
        let (weights, share, index) = (weights.slice()?, share.slice()?, index.slice()?);
        let made = run(py, None, |watch| alias::alias_table(watch, weights, share, index))?;
        made.map_err(|e| invalid::<T>(e, None))
    })
}

/// `out`: the index, -1 where `u` is not in [0, 1], and what is left of `u`.
#[pyfunction]
pub fn sample_alias(
    py: Python<'_>,
    share: &Bound<'_, PyAny>,
    index: &Bound<'_, PyAny>,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let index = In::<u32>::of("alias", index)?;
    let index = index.slice()?;
    // The shares' own precision is that of the arrays.
    real!(share, T => {
        let share = In::<T>::of("share", share)?;
        let share: &[T] = share.slice()?;
        draw(py, share, index, given, out)
    })
}

fn draw<S: Real>(
    py: Python<'_>,
    share: &[S],
    index: &[u32],
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    elementwise!(py, given, out, |u: [T; 1]| -> (chosen: [i64; 1], rest: [T; 1]) {
        if u[0] >= 0.0 && u[0] <= 1.0 {
            let (chosen, rest) = alias::sample_alias(share, index, S::of(u[0].to_f64()));
            ([i64::from(chosen)], [T::of(rest.to_f64())])
        } else {
            ([-1], [T::NAN])
        }
    })
}
