//! All light paths.

use super::camera::{CameraTuple, FilterTuple, camera, filter};
use crate::pathtrace::path_trace::{Film, Options, Strategy};
use crate::pathtrace::{Emitters, Selection, Surfaces, path_trace as paths};
use crate::python::accel::Tree;
use crate::python::array::{In, Out, run, unknown};
use crate::python::environment::Surroundings;
use crate::python::light::lights;
use crate::real;
use crate::real::Real;
use crate::sampling::sampler::Sampler;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// How a picture is sampled: width, samples, start, max_depth, roulette, seed; strategy, sampler, selection; clamp.
type OptionsTuple = ((usize, u32, u32, u32, u32, u64), [String; 3], f64);

fn options(
    ((width, samples, start, max_depth, roulette, seed), names, clamp): OptionsTuple,
) -> PyResult<Options> {
    let [strategy, sampler, selection] = names;
    let strategy = match strategy.as_str() {
        "uniform" => Strategy::Uniform,
        "bsdf" => Strategy::Bsdf,
        "light" => Strategy::Light,
        "mis" => Strategy::Mis,
        _ => return Err(unknown("strategy", &strategy)),
    };
    let sampler = Sampler::new(&sampler, seed, start.saturating_add(samples))
        .ok_or_else(|| unknown("sampler", &sampler))?;
    let selection = match selection.as_str() {
        "all" => Selection::All,
        "power" => Selection::Power,
        "tree" => Selection::Tree,
        "auto" => Selection::Auto,
        _ => return Err(unknown("light_selection", &selection)),
    };
    Ok(Options { width, samples, start, max_depth, roulette, seed, strategy, sampler, selection, clamp })
}

/// `mesh`: positions, faces, normals, material_ids; `tables`: kinds and rows of reflection
/// models, emission; `surroundings`: background, offset, panorama;
/// `out`: mean and variance, then counts of outliers and what clamping removed, if wanted. With `pixels`, their rows
/// alone.
#[pyfunction]
pub fn path_trace(
    py: Python<'_>,
    tree: &Tree,
    mesh: [Bound<'_, PyAny>; 4],
    colors: Option<&Bound<'_, PyAny>>,
    tables: [Bound<'_, PyAny>; 3],
    light_table: &Bound<'_, PyAny>,
    surroundings: ([f64; 3], f64, Option<PyRef<'_, Surroundings>>),
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
        let bvh = tree.of::<T>()?;
        let [positions, faces, normals, material_ids] = &mesh;
        let (positions, faces) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
        let (normals, ids) = (In::<T>::of("normals", normals)?, In::<i32>::of("material_ids", material_ids)?);
        let colors = colors.map(|c| In::<T>::of("colors", c)).transpose()?;
        let [kinds, rows, emission] = &tables;
        let (kinds, rows) = (In::<i32>::of("kinds", kinds)?, In::<T>::of("rows", rows)?);
        let emission = In::<T>::of("emission", emission)?;
        let lights = lights::<T>(light_table)?;
        let emitters = Emitters::find(positions.items()?, faces.items()?, ids.slice()?, emission.items()?);
        let (background, offset, sky) = surroundings;
        let environment = sky.as_ref().map(|s| s.of::<T>()).transpose()?.map(|p| &**p);
        let scene = Surfaces {
            bvh,
            positions: positions.items()?,
            faces: faces.items()?,
            normals: Some(normals.items()?),
            colors: colors.as_ref().map(|c| c.items()).transpose()?,
            material_ids: ids.slice()?,
            kinds: kinds.slice()?,
            rows: rows.items()?,
            emission: emission.items()?,
            emitters: &emitters,
            lights: &lights,
            background: background.map(T::of).into(),
            environment,
            offset: T::of(offset),
        };
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
