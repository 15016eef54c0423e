//! Bindings of `pathtrace`.

use crate::pathtrace::Pinhole;
use crate::real::Real;
use crate::vec::Vec3;
use pyo3::prelude::*;

/// Eye, corner, right, down: see [`Pinhole`].
fn pinhole<T: Real>([eye, corner, right, down]: [[f64; 3]; 4]) -> Pinhole<T> {
    let vector = |v: [f64; 3]| Vec3::from(v.map(T::of));
    Pinhole { eye: vector(eye), corner: vector(corner), right: vector(right), down: vector(down) }
}

#[pymodule]
pub mod pathtrace {
    use super::pinhole;
    use crate::brdf::metallic_roughness::Materials;
    use crate::pathtrace::{
        Emitters, Surfaces, direct_light as direct, path_trace as paths, ray_cast as seen,
    };
    use crate::python::accel::Tree;
    use crate::python::array::{In, Out, run};
    use crate::python::light::{ReceiverArrays, ReceiverTuple, lights};
    use crate::real;
    use crate::real::Real;
    use pyo3::prelude::*;

    #[pyfunction]
    fn ray_cast(
        py: Python<'_>,
        tree: &Tree,
        camera: [[f64; 3]; 4],
        width: usize,
        out: [Bound<'_, PyAny>; 4],
    ) -> PyResult<()> {
        let [t, face, u, v] = &out;
        real!(t, T => {
            let tree = tree.of::<T>()?;
            let camera = pinhole::<T>(camera);
            let (mut t, mut face) = (Out::<T>::of("t", t)?, Out::<i32>::of("face", face)?);
            let (mut u, mut v) = (Out::<T>::of("u", u)?, Out::<T>::of("v", v)?);
            let seen = seen::Seen { t: t.slice()?, face: face.slice()?, u: u.slice()?, v: v.slice()? };
            run(py, None, |watch| seen::ray_cast(watch, tree, &camera, width, seen))
        })
    }

    #[pyfunction]
    fn direct_light(
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

    /// `mesh`: positions, faces, normals, material_ids; `tables`: base_color, metallic, roughness, specular, emission;
    /// `options`: width, samples, start, max_depth, seed.
    #[pyfunction]
    fn path_trace(
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
}
