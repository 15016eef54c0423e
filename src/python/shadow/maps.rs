//! Bindings of `shadow`: maps.

use crate::python::array::{In, Out, run};
use crate::raster::{Cull, MAX_SIZE};
use crate::real;
use crate::shadow::fit::{self, Eye};
use crate::shadow::shadow_map::{View, shadow_map as kernel};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Origin, frame, window, near, far of a view; whether it is perspective.
type Seen = ([f64; 3], [[f64; 3]; 3], [f64; 4], f64, f64, bool);

/// Bounds of what is seen from an origin in a frame: (low, high) of both window coordinates and of the depth.
#[pyfunction]
pub fn span(
    py: Python<'_>,
    points: &Bound<'_, PyAny>,
    origin: [f64; 3],
    frame: [[f64; 3]; 3],
    perspective: Option<f64>,
) -> PyResult<([f64; 3], [f64; 3])> {
    let eye = Eye { origin, frame, perspective };
    real!(points, T => {
        let points = In::<T>::of("points", points)?;
        let points = points.items()?;
        let span = run(py, None, |watch| fit::span(watch, points, &eye))?;
        Ok((span.low, span.high))
    })
}

#[pyfunction]
pub fn shadow_map(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    seen: Seen,
    cull: &str,
    progress: Option<Py<PyAny>>,
    depth: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let cull = match cull {
        "back" => Cull::Back,
        "front" => Cull::Front,
        _ => Cull::None,
    };
    let (origin, frame, window, near, far, perspective) = seen;
    let view = View { origin, frame, window, near, far, perspective };
    let faces = In::<i32>::of("faces", faces)?;
    real!(depth, T => {
        let positions = In::<T>::of("positions", positions)?;
        let mut depth = Out::<T>::of("depth", depth)?;
        let &[height, width] = depth.shape() else {
            return Err(PyValueError::new_err("depth: expected shape (H, W)"));
        };
        let (p, f, depth) = (positions.items()?, faces.items()?, depth.slice()?);
        if width.max(height) > MAX_SIZE || f.iter().flatten().any(|&k| k < 0 || k as usize >= p.len()) {
            return Err(PyValueError::new_err("faces or depth: out of range"));
        }
        run(py, progress, |watch| {
            kernel(watch, p, f, &view, [width, height], cull, depth)
        })
    })
}
