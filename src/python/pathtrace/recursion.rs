//! Whitted's and Cook's ray tracing.

use super::camera::{CameraTuple, FilterTuple, camera, filter};
use super::world::{World, WorldTuple};
use crate::pathtrace::distribution::Distribution;
use crate::pathtrace::recursion::{Film, Options, Stage, picture};
use crate::pathtrace::whitted::Whitted;
use crate::pathtrace::{Lighting, Selection};
use crate::python::array::{Out, run, unknown};
use crate::real;
use pyo3::prelude::*;

/// `method`: "whitted" or "distribution"; `options`: width, samples, start, max_depth, seed, cutoff; `out`: mean,
/// variance, outliers.
#[pyfunction]
pub fn recursion(
    py: Python<'_>,
    method: &str,
    world: WorldTuple<'_>,
    view: (CameraTuple, FilterTuple),
    options: (usize, u32, u32, u32, u64, f64),
    out: [Bound<'_, PyAny>; 3],
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let [mean, variance, outliers] = &out;
    real!(mean, T => {
        let world = World::<T>::of(&world)?;
        let copies = world.copies()?;
        let scene = world.surfaces(copies.as_ref())?;
        let lighting = Lighting::new(&scene, Selection::All);
        let stage = Stage { scene: &scene, lighting: &lighting };
        let (width, samples, start, max_depth, seed, cutoff) = options;
        let options = Options { width, samples, start, max_depth, seed, cutoff };
        let (camera, filter) = (camera::<T>(view.0), filter(view.1)?);
        let (mut mean, mut variance) = (Out::<T>::of("mean", mean)?, Out::<T>::of("variance", variance)?);
        let mut outliers = Out::<i32>::of("outliers", outliers)?;
        let film = Film { mean: mean.items()?, variance: variance.items()?, outliers: outliers.slice()? };
        match method {
            "whitted" => {
                let tracer = Whitted { stage, options };
                run(py, progress, |watch| picture(watch, &tracer, &camera, &filter, options, film))
            }
            "distribution" => {
                let tracer = Distribution { stage, options };
                run(py, progress, |watch| picture(watch, &tracer, &camera, &filter, options, film))
            }
            _ => Err(unknown("method", method)),
        }
    })
}
