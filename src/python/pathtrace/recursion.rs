//! Whitted's and Cook's ray tracing.

use super::camera::{CameraTuple, FilterTuple, camera, filter};
use crate::pathtrace::distribution::Distribution;
use crate::pathtrace::recursion::{Film, Options, Stage, picture};
use crate::pathtrace::whitted::Whitted;
use crate::pathtrace::{Emitters, Lighting, Selection, Surfaces};
use crate::python::accel::Tree;
use crate::python::array::{In, Out, run, unknown};
use crate::python::environment::Surroundings;
use crate::python::light::lights;
use crate::real;
use crate::real::Real;
use pyo3::prelude::*;

/// `method`: "whitted" or "distribution"; `mesh`: positions, faces, normals, material_ids; `tables`: kinds, rows,
/// emission; `options`: width, samples, start, max_depth, seed, cutoff; `out`: mean,
/// variance, outliers.
#[pyfunction]
pub fn recursion(
    py: Python<'_>,
    method: &str,
    tree: &Tree,
    mesh: [Bound<'_, PyAny>; 4],
    colors: Option<&Bound<'_, PyAny>>,
    tables: [Bound<'_, PyAny>; 3],
    light_table: &Bound<'_, PyAny>,
    surroundings: ([f64; 3], f64, Option<Bound<'_, Surroundings>>),
    view: (CameraTuple, FilterTuple),
    options: (usize, u32, u32, u32, u64, f64),
    out: [Bound<'_, PyAny>; 3],
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let [mean, variance, outliers] = &out;
    real!(mean, T => {
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
        let sky = sky.as_ref().map(|s| s.get().of::<T>()).transpose()?;
        let scene = Surfaces {
            bvh: tree.of::<T>()?,
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
            environment: sky.map(|s| s.as_ref()),
            offset: T::of(offset),
        };
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
