//! Bindings of points: normal_matrix, and points through matrices.

use crate::elementwise;
use crate::python::array::{Arrays, In, Out, run};
use crate::real;
use crate::transform::{Rows4, normal_matrix as normals, points};
use crate::vec::Mat4;
use bytemuck::cast;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

type Array<'a, 'py> = &'a Bound<'py, PyAny>;

#[pyfunction]
pub fn normal_matrix(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |matrix: [T; 16]| -> (m: [T; 9]) {
        cast(normals::normal_matrix(Mat4::from_rows(cast::<_, Rows4<T>>(matrix)).mat3()).rows())
    })
}

/// `kind`: point, vector, normal, homogeneous.
#[pyfunction]
pub fn transform(
    py: Python<'_>,
    kind: &str,
    given: Array<'_, '_>,
    matrix: Array<'_, '_>,
    out: Array<'_, '_>,
) -> PyResult<()> {
    real!(given, T => {
        let (given, matrix) = (In::<T>::of("points", given)?, In::<T>::of("matrix", matrix)?);
        let mut out = Out::<T>::of("out", out)?;
        let (given, matrix) = (given.items()?, bytemuck::cast_slice(matrix.items::<16>()?));
        let kind = match kind {
            "point" => points::Kind::Point,
            "vector" => points::Kind::Vector,
            "normal" => points::Kind::Normal,
            _ => {
                let out = out.items()?;
                return run(py, None, |watch| points::homogeneous(watch, given, matrix, out));
            }
        };
        let out = out.items()?;
        run(py, None, |watch| points::transform(watch, kind, given, matrix, out))
    })
}

/// `kind`: point, vector, homogeneous.
#[pyfunction]
pub fn transform_2d(
    py: Python<'_>,
    kind: &str,
    given: Array<'_, '_>,
    matrix: Array<'_, '_>,
    out: Array<'_, '_>,
) -> PyResult<()> {
    real!(given, T => {
        let (given, matrix) = (In::<T>::of("points", given)?, In::<T>::of("matrix", matrix)?);
        let mut out = Out::<T>::of("out", out)?;
        let (given, matrix) = (given.items()?, bytemuck::cast_slice(matrix.items::<9>()?));
        if kind == "homogeneous" {
            let out = out.items()?;
            return run(py, None, |watch| points::homogeneous_2d(watch, given, matrix, out));
        }
        let kind = if kind == "point" { points::Kind::Point } else { points::Kind::Vector };
        let out = out.items()?;
        run(py, None, |watch| points::transform_2d(watch, kind, given, matrix, out))
    })
}

#[pyfunction]
pub fn project(
    py: Python<'_>,
    given: Array<'_, '_>,
    matrix: Array<'_, '_>,
    size: [f64; 2],
    out: Array<'_, '_>,
) -> PyResult<()> {
    real!(given, T => {
        let (given, matrix) = (In::<T>::of("points", given)?, In::<T>::of("matrix", matrix)?);
        let mut out = Out::<T>::of("out", out)?;
        let (given, matrix) = (given.items()?, bytemuck::cast_slice(matrix.items::<16>()?));
        let out = out.items()?;
        run(py, None, |watch| points::project(watch, given, matrix, size.map(|s| s as T), out))
    })
}

#[pyfunction]
pub fn unproject(
    py: Python<'_>,
    given: Array<'_, '_>,
    matrix: Array<'_, '_>,
    size: [f64; 2],
    out: Array<'_, '_>,
) -> PyResult<()> {
    real!(given, T => {
        let (given, matrix) = (In::<T>::of("pixels", given)?, In::<f64>::of("matrix", matrix)?);
        let mut out = Out::<T>::of("out", out)?;
        let matrices: &[[[f64; 4]; 4]] = bytemuck::cast_slice(matrix.items::<16>()?);
        let inverses = matrices
            .iter()
            .map(points::inverse::<T>)
            .collect::<Option<Vec<_>>>()
            .ok_or_else(|| PyValueError::new_err("matrix: expected an invertible matrix, got a singular one"))?;
        let (given, out) = (given.items()?, out.items()?);
        run(py, None, |watch| points::unproject(watch, given, &inverses, size.map(|s| s as T), out))
    })
}
