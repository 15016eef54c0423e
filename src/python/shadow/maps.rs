//! Bindings of `shadow`: maps.

use crate::python::array::{In, Out, run};
use crate::raster::{Cull, MAX_SIZE};
use crate::real;
use crate::real::Real;
use crate::shadow::cascades::{Cuts, cascades as cut, cube_faces as cubed};
use crate::shadow::fit::{self, Eye};
use crate::shadow::shadow_map::{Surface, View, quantize, shadow_map as kernel};
use crate::shadow::texels::Steps;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Origin, frame, window, near, far of a view; whether it is perspective.
pub type Seen = ([f64; 3], [[f64; 3]; 3], [f64; 4], f64, f64, bool);

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

pub fn view((origin, frame, window, near, far, perspective): Seen) -> View {
    View { origin, frame, window, near, far, perspective }
}

#[pyfunction]
pub fn shadow_map(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    seen: Seen,
    cull: &str,
    surface: &str,
    progress: Option<Py<PyAny>>,
    depth: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let cull = match cull {
        "back" => Cull::Back,
        "front" => Cull::Front,
        _ => Cull::None,
    };
    let surface = match surface {
        "second" => Surface::Second,
        "midpoint" => Surface::Midpoint,
        _ => Surface::First,
    };
    let view = view(seen);
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
            kernel(watch, p, f, &view, [width, height], cull, surface, depth)
        })
    })
}

/// Depths as integers: `out` of 16 bits or of 32.
#[pyfunction]
pub fn quantize_depth(
    py: Python<'_>,
    depth: &Bound<'_, PyAny>,
    steps: (f64, f64, u32),
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let (low, step, nothing) = steps;
    let steps = Steps { low, step, nothing };
    real!(depth, T => {
        let depth = In::<T>::of("depth", depth)?;
        let depth = depth.slice()?;
        if let Ok(mut out) = Out::<u16>::of("out", out) {
            let out = out.slice()?;
            return run(py, None, |watch| quantize(watch, depth, &steps, |q| q as u16, out));
        }
        let mut out = Out::<u32>::of("out", out)?;
        let out = out.slice()?;
        run(py, None, |watch| quantize(watch, depth, &steps, |q| q, out))
    })
}

/// Which cascade each receiver looks into, which one after it, and that one's share.
#[pyfunction]
pub fn cascades(
    py: Python<'_>,
    receivers: &Bound<'_, PyAny>,
    cuts: ([f64; 3], [f64; 3], Vec<f64>, f64),
    first: &Bound<'_, PyAny>,
    next: &Bound<'_, PyAny>,
    share: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let (eye, axis, splits, blend) = cuts;
    if splits.len() > 255 {
        return Err(PyValueError::new_err("splits: too many"));
    }
    let cuts = Cuts { eye, axis, splits: &splits, blend };
    let (mut first, mut next) = (Out::<u8>::of("first", first)?, Out::<u8>::of("next", next)?);
    real!(receivers, T => {
        let points = In::<T>::of("receivers", receivers)?;
        let mut share = Out::<T>::of("share", share)?;
        let (p, f, n, share) = (points.items()?, first.slice()?, next.slice()?, share.slice()?);
        run(py, None, |watch| cut(watch, p, &cuts, f, n, share))
    })
}

/// Which face of a cube each receiver is seen through.
#[pyfunction]
pub fn cube_faces(
    py: Python<'_>,
    receivers: &Bound<'_, PyAny>,
    origin: [f64; 3],
    faces: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let mut faces = Out::<u8>::of("faces", faces)?;
    real!(receivers, T => {
        let points = In::<T>::of("receivers", receivers)?;
        let (p, faces) = (points.items()?, faces.slice()?);
        run(py, None, |watch| cubed(watch, p, origin.map(T::of), faces))
    })
}
