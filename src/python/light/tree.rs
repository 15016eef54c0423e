//! Bindings of the choice among many lights: `tree`.

use super::lights;
use crate::light::tree::{self, Method, Selection, Source};
use crate::python::array::{In, Out, run, unknown};
use crate::real;
use pyo3::prelude::*;

/// A choice among lights, in both precisions.
#[pyclass(frozen)]
pub struct Chooser {
    single: Selection<f32>,
    double: Selection<f64>,
}

/// A precision of the choice.
trait Held: Sized {
    fn pick(chooser: &Chooser) -> &Selection<Self>;
}

impl Held for f32 {
    fn pick(chooser: &Chooser) -> &Selection<f32> {
        &chooser.single
    }
}

impl Held for f64 {
    fn pick(chooser: &Chooser) -> &Selection<f64> {
        &chooser.double
    }
}

pub fn method(name: &str) -> PyResult<Method> {
    match name {
        "uniform" => Ok(Method::Uniform),
        "power" => Ok(Method::Power),
        "tree" => Ok(Method::Tree),
        _ => Err(unknown("method", name)),
    }
}

#[pyfunction]
pub fn chooser(table: &Bound<'_, PyAny>, name: &str, scene_radius: f64) -> PyResult<Chooser> {
    let method = method(name)?;
    let single: Vec<_> = lights::<f32>(table)?.iter().map(|l| Source::of(l, scene_radius as f32)).collect();
    let double: Vec<_> = lights::<f64>(table)?.iter().map(|l| Source::of(l, scene_radius)).collect();
    Ok(Chooser { single: Selection::new(method, &single), double: Selection::new(method, &double) })
}

/// `out`: lights and chances.
#[pyfunction]
pub fn choose(
    py: Python<'_>,
    chooser: &Chooser,
    given: [Bound<'_, PyAny>; 3],
    out: [Bound<'_, PyAny>; 2],
) -> PyResult<()> {
    let [points, normals, u] = &given;
    real!(points, T => {
        let (points, normals) = (In::<T>::of("points", points)?, In::<T>::of("normals", normals)?);
        let u = In::<T>::of("u", u)?;
        let (mut light, mut chance) = (Out::<i32>::of("light", &out[0])?, Out::<T>::of("chance", &out[1])?);
        let (p, n, u) = (points.items()?, normals.items()?, u.slice()?);
        let (light, chance) = (light.slice()?, chance.slice()?);
        run(py, None, |watch| tree::select_many(watch, T::pick(chooser), p, n, u, light, chance))
    })
}

#[pyfunction]
pub fn chance(
    py: Python<'_>,
    chooser: &Chooser,
    given: [Bound<'_, PyAny>; 3],
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let [points, normals, light] = &given;
    real!(points, T => {
        let (points, normals) = (In::<T>::of("points", points)?, In::<T>::of("normals", normals)?);
        let light = In::<i32>::of("light", light)?;
        let mut chance = Out::<T>::of("chance", out)?;
        let (p, n, light, chance) = (points.items()?, normals.items()?, light.slice()?, chance.slice()?);
        run(py, None, |watch| tree::chance_many(watch, T::pick(chooser), p, n, light, chance))
    })
}
