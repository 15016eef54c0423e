//! All light paths.

use super::pinhole;
use crate::brdf::metallic_roughness::Materials;
use crate::pathtrace::{Emitters, Surfaces, path_trace as paths};
use crate::python::accel::Tree;
use crate::python::array::{In, Out, run};
use crate::python::light::lights;
use crate::real;
use crate::real::Real;
use pyo3::prelude::*;

/// `mesh`: positions, faces, normals, material_ids; `tables`: base_color, metallic, roughness, specular, emission;
/// `options`: width, samples, start, max_depth, seed.
#[pyfunction]
pub fn path_trace(
    py: Python<'_>,
    tree: &Tree,
    mesh: [Bound<'_, PyAny>; 4],
    colors: Option<&Bound<'_, PyAny>>,
    tables: [Bound<'_, PyAny>; 5],
    light_table: &Bound<'_, PyAny>,
    surroundings: ([f64; 3], f64),
    camera: [[f64; 3]; 4],
    options: (usize, u32, u32, u32, u64),
    out: [Bound<'_, PyAny>; 2],
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let [mean, variance] = &out;
    real!(mean, T => {
        let bvh = tree.of::<T>()?;
        let [positions, faces, normals, material_ids] = &mesh;
        let (positions, faces) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
        let (normals, ids) = (In::<T>::of("normals", normals)?, In::<i32>::of("material_ids", material_ids)?);
        let colors = colors.map(|c| In::<T>::of("colors", c)).transpose()?;
        let [base_color, metallic, roughness, specular, emission] = &tables;
        let (base, metallic) = (In::<T>::of("base_color", base_color)?, In::<T>::of("metallic", metallic)?);
        let (roughness, specular) = (In::<T>::of("roughness", roughness)?, In::<T>::of("specular", specular)?);
        let emission = In::<T>::of("emission", emission)?;
        let lights = lights::<T>(light_table)?;
        let emitters = Emitters::find(positions.items()?, faces.items()?, ids.slice()?, emission.items()?);
        let (background, offset) = surroundings;
        let scene = Surfaces {
            bvh,
            positions: positions.items()?,
            faces: faces.items()?,
            normals: Some(normals.items()?),
            colors: colors.as_ref().map(|c| c.items()).transpose()?,
            material_ids: ids.slice()?,
            materials: Materials {
                base_color: base.items()?,
                metallic: metallic.slice()?,
                roughness: roughness.slice()?,
                specular: specular.slice()?,
            },
            emission: emission.items()?,
            emitters: &emitters,
            lights: &lights,
            background: background.map(T::of).into(),
            offset: T::of(offset),
        };
        let (width, samples, start, max_depth, seed) = options;
        let options = paths::Options { width, samples, start, max_depth, seed };
        let camera = pinhole::<T>(camera);
        let (mut mean, mut variance) = (Out::<T>::of("mean", mean)?, Out::<T>::of("variance", variance)?);
        let (mean, variance) = (mean.items()?, variance.items()?);
        run(py, progress, |watch| paths::path_trace(watch, &scene, &camera, options, mean, variance))
    })
}
