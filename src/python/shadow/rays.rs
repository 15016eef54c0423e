//! Bindings of `shadow`: rays.

use crate::python::accel::Tree;
use crate::python::array::{In, Out, run, unknown};
use crate::python::light::one_light;
use crate::real;
use crate::real::Real;
use crate::sampling::sampler::Sampler;
use crate::vec::Vec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

#[pyfunction]
pub fn ray_traced(
    py: Python<'_>,
    tree: &Bound<'_, Tree>,
    receivers: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
    ignore: Option<&Bound<'_, PyAny>>,
    light: (&str, [[f64; 3]; 3], Option<Bound<'_, PyAny>>),
    samples: usize,
    sampler: (&str, u64),
    shifts: Option<&Bound<'_, PyAny>>,
    offset: f64,
    progress: Option<Py<PyAny>>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    use crate::shadow::ray_traced::{Emitter, Knobs, ray_traced as kernel};
    real!(receivers, T => {
        let points = In::<T>::of("receivers", receivers)?;
        let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
        let ignore = ignore.map(|f| In::<i32>::of("ignore_face", f)).transpose()?;
        let mut out = Out::<T>::of("out", out)?;
        let (kind, vectors, table) = &light;
        let [a, u, v] = vectors.map(|v| Vec3::from(v.map(T::of)));
        let emitter = match *kind {
            "area" => Emitter::Area(one_light::<T>(table.as_ref().ok_or_else(|| unknown("light", "nothing"))?)?),
            "rect" => Emitter::Rect { center: a, u, v },
            "directional" => Emitter::Directional { towards: a },
            _ => Emitter::Point { position: a },
        };
        let sampler = Sampler::new(sampler.0, sampler.1, samples as u32)
            .ok_or_else(|| unknown("sampler", sampler.0))?;
        let shifts = shifts.map(|s| In::<T>::of("offsets", s)).transpose()?;
        let shifts = shifts.as_ref().map(In::items).transpose()?;
        if shifts.is_some_and(|s| s.len() != points.items().map_or(0, <[[T; 3]]>::len)) {
            return Err(PyValueError::new_err("offsets: expected one for each receiver"));
        }
        let knobs = Knobs { emitter, samples, sampler, shifts, offset: T::of(offset) };
        let tree = tree.get().of::<T>()?.clone();
        let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
        let (ignore, out) = (ignore.as_ref().map(In::slice).transpose()?, out.slice()?);
        run(py, progress, |watch| kernel(watch, &tree, p, n, ignore, &knobs, out))
    })
}
