//! Bindings of linearly transformed cosines: `ltc`.

use super::one_light;
use crate::light::ltc::{self, Table, fit};
use crate::python::array::{Arrays, In, Out, run};
use crate::real;
use numpy::PyArray1;
use pyo3::prelude::*;

/// A table over `angles` angles; None: the one that is shipped.
fn table(given: Option<(&Bound<'_, PyAny>, usize)>) -> PyResult<Option<Table>> {
    given
        .map(|(lobes, angles)| Ok(Table { lobes: In::<f32>::of("table", lobes)?.items()?.to_vec(), angles }))
        .transpose()
}

/// `given`: points, normals, wo, alpha; `out`: the parts of F0 and of F90 − F0, and the radiance seen.
#[pyfunction]
pub fn ltc_light(
    py: Python<'_>,
    light: &Bound<'_, PyAny>,
    lobes: Option<(Bound<'_, PyAny>, usize)>,
    given: Arrays<'_>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let own = table(lobes.as_ref().map(|(lobes, angles)| (lobes, *angles)))?;
    let table = own.as_ref().unwrap_or_else(|| ltc::shipped());
    real!(out, T => {
        let light = one_light::<T>(light)?;
        let arrays = [0, 1, 2].map(|i| In::<T>::of("points", &given[i]));
        let [points, normals, wo] = &arrays.map(|a| a.ok());
        let (Some(p), Some(n), Some(w)) = (points, normals, wo) else {
            return Err(crate::python::array::unknown("points", "array"));
        };
        let alpha = In::<T>::of("alpha", &given[3])?;
        let mut out = Out::<T>::of("out", out)?;
        let (p, n, w, alpha, out) = (p.items()?, n.items()?, w.items()?, alpha.slice()?, out.items()?);
        run(py, None, |watch| ltc::ltc_many(watch, table, &light, p, n, w, alpha, out))
    })
}

/// The entries of a fitted table, row by row, and the distance left at each.
#[pyfunction]
pub fn ltc_fit<'py>(
    py: Python<'py>,
    rows: usize,
    angles: usize,
    steps: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<f64>>)> {
    let (table, left) = run(py, progress, |watch| fit::fit_ltc(watch, rows, angles, steps))?;
    Ok((PyArray1::from_vec(py, table.lobes.into_flattened()), PyArray1::from_vec(py, left)))
}

/// The entries of the table that is shipped.
#[pyfunction]
pub fn ltc_shipped(py: Python<'_>) -> Bound<'_, PyArray1<f32>> {
    PyArray1::from_vec(py, ltc::shipped().lobes.clone().into_flattened())
}
