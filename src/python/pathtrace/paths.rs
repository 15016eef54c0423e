//! All light paths.

use super::camera::{CameraTuple, FilterTuple, camera, filter};
use super::world::{World, WorldTuple};
use crate::pathtrace::path_trace::{Film, Options, Strategy};
use crate::pathtrace::{Selection, path_trace as paths};
use crate::python::array::{In, Out, run, unknown};
use crate::real;
use crate::sampling::sampler::Sampler;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// How a picture is sampled: width, samples, start, max_depth, roulette, seed; strategy, sampler, selection; clamp;
/// first and number of the samples of the round that these are of.
type OptionsTuple = ((usize, u32, u32, u32, u32, u64), [String; 3], f64, (u32, u32));

fn options(
    ((width, samples, start, max_depth, roulette, seed), names, clamp, round): OptionsTuple,
) -> PyResult<Options> {
    let [strategy, sampler, selection] = names;
    let strategy = match strategy.as_str() {
        "uniform" => Strategy::Uniform,
        "bsdf" => Strategy::Bsdf,
        "light" => Strategy::Light,
        "mis" => Strategy::Mis,
        _ => return Err(unknown("strategy", &strategy)),
    };
    let (sampler, base) =
        Sampler::round(&sampler, seed, round.0, round.1).ok_or_else(|| unknown("sampler", &sampler))?;
    let selection = match selection.as_str() {
        "all" => Selection::All,
        "power" => Selection::Power,
        "tree" => Selection::Tree,
        "auto" => Selection::Auto,
        _ => return Err(unknown("light_selection", &selection)),
    };
    Ok(Options {
        width,
        samples,
        start,
        max_depth,
        roulette,
        seed,
        strategy,
        sampler,
        base,
        selection,
        clamp,
    })
}

/// `out`: mean and variance, then counts of outliers and what clamping removed, if wanted. With `pixels`, their rows
/// alone.
#[pyfunction]
pub fn path_trace(
    py: Python<'_>,
    world: WorldTuple<'_>,
    view: (CameraTuple, FilterTuple),
    options: OptionsTuple,
    pixels: Option<&Bound<'_, PyAny>>,
    out: [Option<Bound<'_, PyAny>>; 4],
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let [Some(mean), Some(variance), outliers, removed] = &out else {
        return Err(PyValueError::new_err("out: expected mean and variance"));
    };
    real!(mean, T => {
        let world = World::<T>::of(&world)?;
        let copies = world.copies()?;
        let scene = world.surfaces(copies.as_ref())?;
        let options = self::options(options)?;
        let (camera, filter) = (camera::<T>(view.0), filter(view.1)?);
        let pixels = pixels.map(|p| In::<i32>::of("pixels", p)).transpose()?;
        let pixels = pixels.as_ref().map(|p| p.slice()).transpose()?;
        let (mut mean, mut variance) = (Out::<T>::of("mean", mean)?, Out::<T>::of("variance", variance)?);
        let mut outliers = outliers.as_ref().map(|o| Out::<i32>::of("outliers", o)).transpose()?;
        let mut removed = removed.as_ref().map(|r| Out::<T>::of("removed", r)).transpose()?;
        let film = Film {
            mean: mean.items()?,
            variance: variance.items()?,
            outliers: outliers.as_mut().map(|o| o.slice()).transpose()?,
            removed: removed.as_mut().map(|r| r.items()).transpose()?,
        };
        run(py, progress, |watch| paths::path_trace(watch, &scene, &camera, &filter, options, pixels, film))
    })
}
