//! What the camera sees beside light.

use super::camera::{CameraTuple, FilterTuple, camera, filter};
use crate::pathtrace::aov::{self, Aovs, Samples, Things};
use crate::python::accel::Tree;
use crate::python::array::{In, Out, run};
use crate::real;
use pyo3::prelude::*;

/// `mesh`: positions, faces, normals, material ids, instance ids, albedo of the materials; `optional`: colours, and
/// positions at time 1; `samples`: width, count, start, seed; `out` in the order of [`Aovs`].
#[pyfunction]
pub fn aovs(
    py: Python<'_>,
    tree: &Tree,
    mesh: [Bound<'_, PyAny>; 6],
    optional: [Option<Bound<'_, PyAny>>; 2],
    eye: CameraTuple,
    pixel_filter: FilterTuple,
    samples: (usize, u32, u32, u64),
    out: [Bound<'_, PyAny>; 9],
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let [positions, faces, normals, material_ids, instance_ids, albedo] = &mesh;
    real!(positions, T => {
        let (positions, faces) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
        let (normals, albedo_table) = (In::<T>::of("normals", normals)?, In::<T>::of("albedo", albedo)?);
        let material_ids = In::<i32>::of("material_ids", material_ids)?;
        let instance_ids = In::<i32>::of("instance_ids", instance_ids)?;
        let [colors, moved] = &optional;
        let colors = colors.as_ref().map(|c| In::<T>::of("colors", c)).transpose()?;
        let moved = moved.as_ref().map(|c| In::<T>::of("moved", c)).transpose()?;
        let things = Things {
            bvh: tree.of::<T>()?,
            positions: positions.items()?,
            moved: moved.as_ref().map(|m| m.items()).transpose()?,
            faces: faces.items()?,
            normals: normals.items()?,
            colors: colors.as_ref().map(|c| c.items()).transpose()?,
            material_ids: material_ids.slice()?,
            instance_ids: instance_ids.slice()?,
            albedo: albedo_table.items()?,
        };
        let (eye, pixel_filter) = (camera::<T>(eye), filter(pixel_filter)?);
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
