//! A scene as the tracers' faces hand it over.

use crate::light::Light;
use crate::pathtrace::{Emitters, Surfaces};
use crate::python::accel::{Held as InTree, Tree};
use crate::python::array::In;
use crate::python::environment::{Held as InPanorama, Surroundings};
use crate::python::light::lights;
use numpy::Element;
use pyo3::prelude::*;

/// Positions, faces, normals, material_ids; colours of vertices; kinds and rows of reflection models, and emission;
/// lights; background, offset of rays, panorama.
pub type WorldTuple<'py> = (
    Bound<'py, Tree>,
    [Bound<'py, PyAny>; 4],
    Option<Bound<'py, PyAny>>,
    [Bound<'py, PyAny>; 3],
    Bound<'py, PyAny>,
    ([f64; 3], f64, Option<Bound<'py, Surroundings>>),
);

/// The arrays of a scene, held while a kernel reads them.
pub struct World<'a, 'py, T: Element> {
    given: &'a WorldTuple<'py>,
    positions: In<'py, T>,
    faces: In<'py, i32>,
    normals: In<'py, T>,
    ids: In<'py, i32>,
    colors: Option<In<'py, T>>,
    kinds: In<'py, i32>,
    rows: In<'py, T>,
    emission: In<'py, T>,
    lights: Vec<Light<T>>,
    emitters: Emitters,
}

impl<'a, 'py, T: Element + InTree + InPanorama> World<'a, 'py, T> {
    pub fn of(given: &'a WorldTuple<'py>) -> PyResult<Self> {
        let (_, [positions, faces, normals, ids], colors, [kinds, rows, emission], table, _) = given;
        let (positions, faces) = (In::of("positions", positions)?, In::of("faces", faces)?);
        let (ids, emission) = (In::<i32>::of("material_ids", ids)?, In::<T>::of("emission", emission)?);
        let emitters =
            Emitters::find::<T>(positions.items()?, faces.items()?, ids.slice()?, emission.items()?);
        Ok(World {
            given,
            positions,
            faces,
            normals: In::of("normals", normals)?,
            ids,
            colors: colors.as_ref().map(|c| In::of("colors", c)).transpose()?,
            kinds: In::of("kinds", kinds)?,
            rows: In::of("rows", rows)?,
            emission,
            lights: lights(table)?,
            emitters,
        })
    }

    pub fn surfaces(&self) -> PyResult<Surfaces<'_, T>> {
        let (tree, .., (background, offset, sky)) = self.given;
        let sky = sky.as_ref().map(|s| s.get().of::<T>()).transpose()?;
        Ok(Surfaces {
            bvh: tree.get().of::<T>()?,
            positions: self.positions.items()?,
            faces: self.faces.items()?,
            normals: Some(self.normals.items()?),
            colors: self.colors.as_ref().map(|c| c.items()).transpose()?,
            material_ids: self.ids.slice()?,
            kinds: self.kinds.slice()?,
            rows: self.rows.items()?,
            emission: self.emission.items()?,
            emitters: &self.emitters,
            lights: &self.lights,
            background: background.map(T::of).into(),
            environment: sky.map(|s| &**s),
            offset: T::of(*offset),
        })
    }
}
