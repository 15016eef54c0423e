//! What the camera sees beside light.

use super::camera::{CameraTuple, FilterTuple, camera, filter};
use super::world::{World, WorldTuple};
use crate::pathtrace::aov::{self, Aovs, Samples, Things};
use crate::python::array::{In, Out, run};
use crate::real;
use pyo3::prelude::*;

/// `tables`: instances of faces, instances of copies, albedo of the materials; `moved`: positions at time 1; `samples`:
/// width, count, start, seed; `out` in the order of [`Aovs`].
#[pyfunction]
pub fn aovs(
    py: Python<'_>,
    world: WorldTuple<'_>,
    tables: [Bound<'_, PyAny>; 3],
    moved: Option<Bound<'_, PyAny>>,
    view: (CameraTuple, FilterTuple),
    samples: (usize, u32, u32, u64),
    out: [Bound<'_, PyAny>; 9],
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let [of_faces, of_copies, albedo] = &tables;
    real!(albedo, T => {
        let world = World::<T>::of(&world)?;
        let copies = world.copies()?;
        let scene = world.surfaces(copies.as_ref())?;
        let (of_faces, of_copies) = (In::<i32>::of("of_faces", of_faces)?, In::<i32>::of("of_copies", of_copies)?);
        let albedo_table = In::<T>::of("albedo", albedo)?;
        let moved = moved.as_ref().map(|c| In::<T>::of("moved", c)).transpose()?;
        let things = Things {
            scene: &scene,
            moved: moved.as_ref().map(|m| m.items()).transpose()?,
            instances: [of_faces.slice()?, of_copies.slice()?],
            albedo: albedo_table.items()?,
        };
        let (eye, pixel_filter) = (camera::<T>(view.0), filter(view.1)?);
        let (width, count, start, seed) = samples;
        let samples = Samples { width, count, start, seed };
        let [coverage, albedo, normal, depth, position, face, instance, material, motion] = &out;
        let (mut coverage, mut depth) = (Out::<T>::of("coverage", coverage)?, Out::<T>::of("depth", depth)?);
        let (mut albedo, mut normal) = (Out::<T>::of("albedo", albedo)?, Out::<T>::of("normal", normal)?);
        let (mut position, mut motion) = (Out::<T>::of("position", position)?, Out::<T>::of("motion", motion)?);
        let (mut face, mut instance) = (Out::<i32>::of("face", face)?, Out::<i32>::of("instance", instance)?);
        let mut material = Out::<i32>::of("material", material)?;
        let out = Aovs {
            coverage: coverage.slice()?,
            albedo: albedo.items()?,
            normal: normal.items()?,
            depth: depth.slice()?,
            position: position.items()?,
            face: face.slice()?,
            instance: instance.slice()?,
            material: material.slice()?,
            motion: motion.items()?,
        };
        run(py, progress, |watch| aov::aovs(watch, &things, &eye, &pixel_filter, samples, out))
    })
}
