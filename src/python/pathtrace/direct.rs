//! Light from the lights, reflected once.

use crate::pathtrace::direct_light as direct;
use crate::python::accel::Tree;
use crate::python::array::{In, Out, run};
use crate::python::light::{ReceiverArrays, ReceiverTuple, lights};
use crate::real;
use crate::real::Real;
use pyo3::prelude::*;

#[pyfunction]
pub fn direct_light(
    py: Python<'_>,
    tree: &Tree,
    receivers: ReceiverTuple<'_>,
    is_eye: bool,
    material_ids: Option<&Bound<'_, PyAny>>,
    footing: (Option<Bound<'_, PyAny>>, f64),
    light_table: &Bound<'_, PyAny>,
    samples: (u32, u32, u64),
    out: [Bound<'_, PyAny>; 2],
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let [mean, variance] = &out;
    real!(mean, T => {
        let tree = tree.of::<T>()?;
        let lights = lights::<T>(light_table)?;
        let arrays = ReceiverArrays::<T>::of(&receivers, is_eye, material_ids)?;
        let receivers = arrays.get()?;
        let normals = footing.0.as_ref().map(|n| In::<T>::of("geometric_normals", n)).transpose()?;
        let normals = normals.as_ref().map(|n| n.items()).transpose()?;
        let footing = direct::Footing { normals, offset: T::of(footing.1) };
        let (count, start, seed) = samples;
        let samples = direct::Samples { count, start, seed };
        let (mut mean, mut variance) = (Out::<T>::of("mean", mean)?, Out::<T>::of("variance", variance)?);
        let (mean, variance) = (mean.items()?, variance.items()?);
        run(py, progress, |watch| {
            direct::direct_light_many(watch, tree, &receivers, footing, &lights, samples, mean, variance)
        })
    })
}
