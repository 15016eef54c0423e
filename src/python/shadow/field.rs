//! Bindings of `shadow`: distance fields.

use crate::python::array::{In, Out, run, unknown};
use crate::real;
use crate::real::Real;
use crate::shadow::distance_field::{
    Estimate, Field, Knobs, Profile, Spread, Towards, distance_field as kernel,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Whether a position, and it or a direction; half the width, or the tangent of half the angle where the flag is set.
type LightTuple = (bool, [f64; 3], bool, f64);
/// Whether to look between steps; profile, steps, their length, offset.
type How<'a> = (bool, &'a str, usize, f64, f64);

#[pyfunction]
pub fn distance_field(
    py: Python<'_>,
    distances: &Bound<'_, PyAny>,
    grid: ([f64; 3], f64),
    receivers: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
    light: LightTuple,
    how: How<'_>,
    progress: Option<Py<PyAny>>,
    out: &Bound<'_, PyAny>,
    more: Option<[Bound<'_, PyAny>; 3]>,
) -> PyResult<()> {
    let (low, cell) = grid;
    let (positioned, place, angular, width) = light;
    let (between, profile, max_steps, step, offset) = how;
    let profile = match profile {
        "outer" => Profile::Outer,
        "box" => Profile::Box,
        "disk" => Profile::Disk,
        other => return Err(unknown("profile", other)),
    };
    real!(distances, T => {
        let (values, points) = (In::<T>::of("distances", distances)?, In::<T>::of("receivers", receivers)?);
        let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
        let mut out = Out::<T>::of("out", out)?;
        let &[x, y, z] = values.shape() else {
            return Err(PyValueError::new_err("distances: expected shape (X, Y, Z)"));
        };
        let field = Field::new(values.slice()?, [x, y, z], low.map(T::of), T::of(cell))
            .ok_or_else(|| PyValueError::new_err("distances: expected two nodes or more each way"))?;
        let place = place.map(T::of).into();
        let knobs = Knobs {
            towards: if positioned { Towards::Position(place) } else { Towards::Direction(place) },
            spread: if angular { Spread::Tangent(T::of(width)) } else { Spread::Half(T::of(width)) },
            estimate: if between { Estimate::Between } else { Estimate::Step },
            profile,
            max_steps: max_steps.max(1),
            step: T::of(step),
            offset: T::of(offset),
        };
        let mut more = match &more {
            Some([a, b, c]) => Some((Out::<T>::of("closest", a)?, Out::of("along", b)?, Out::of("steps", c)?)),
            None => None,
        };
        let more = match &mut more {
            Some((a, b, c)) => Some((a.slice()?, b.slice()?, c.slice()?)),
            None => None,
        };
        let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
        let out = out.slice()?;
        run(py, progress, |watch| kernel(watch, &field, p, n, &knobs, out, more))
    })
}
