//! A scene as the tracers' faces hand it over.

use crate::accel::bvh::instances::Instances as Placed;
use crate::light::Light;
use crate::pathtrace::copies::{Copies, Placement, mirrors};
use crate::pathtrace::{Emitters, Surfaces};
use crate::python::accel::Tree;
use crate::python::accel::instances::{Instances, Precision, placed};
use crate::python::array::In;
use crate::python::environment::{Held as InPanorama, Surroundings};
use crate::python::light::lights;
use numpy::Element;
use pyo3::prelude::*;
use std::sync::Arc;

/// Positions, faces, normals, material_ids; colours of vertices; kinds and rows of reflection models, and emission;
/// lights; background, offset of rays, panorama; copies of meshes.
pub type WorldTuple<'py> = (
    Bound<'py, Tree>,
    [Bound<'py, PyAny>; 4],
    Option<Bound<'py, PyAny>>,
    [Bound<'py, PyAny>; 3],
    Bound<'py, PyAny>,
    ([f64; 3], f64, Option<Bound<'py, Surroundings>>),
    Option<CopiesTuple<'py>>,
);

/// The tree of two levels; the first face and the first slot of each copy; slots. Faces of the world come before those
/// of all copies.
type CopiesTuple<'py> = (Bound<'py, Instances>, [Bound<'py, PyAny>; 3]);

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
    copies: Option<Meshes<'py, T>>,
}

/// Copies of meshes, held.
struct Meshes<'py, T> {
    tree: Arc<Placed<T>>,
    placements: Vec<Placement>,
    slots: In<'py, i32>,
}

impl<'py, T: Precision> Meshes<'py, T> {
    fn of((tree, arrays): &CopiesTuple<'py>) -> PyResult<Self> {
        let [faces, slots, rows] = arrays;
        let (faces, slots) = (In::<i32>::of("first_face", faces)?, In::<i32>::of("first_slot", slots)?);
        let tree = placed::<T>(tree.get())?.clone();
        let firsts = faces.slice()?.iter().zip(slots.slice()?);
        let placements = firsts.enumerate().map(|(i, (&first_face, &first_slot))| Placement {
            first_face,
            first_slot,
            mirrored: mirrors(&tree.get(i).to_world),
        });
        Ok(Meshes { placements: placements.collect(), tree, slots: In::of("slots", rows)? })
    }

    fn copies(&self) -> PyResult<Copies<'_, T>> {
        Ok(Copies { tree: &self.tree, placements: &self.placements, slots: self.slots.slice()? })
    }
}

impl<'a, 'py, T: Element + Precision + InPanorama> World<'a, 'py, T> {
    pub fn of(given: &'a WorldTuple<'py>) -> PyResult<Self> {
        let (tree, [positions, faces, normals, ids], colors, [kinds, rows, emission], table, _, copies) =
            given;
        let (positions, faces) = (In::of("positions", positions)?, In::of("faces", faces)?);
        let (ids, emission) = (In::<i32>::of("material_ids", ids)?, In::<T>::of("emission", emission)?);
        // Faces of copies emit nothing, and number materials for themselves.
        let own = &faces.items()?[..tree.get().of::<T>()?.faces()];
        let emitters = Emitters::find::<T>(positions.items()?, own, ids.slice()?, emission.items()?);
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
            copies: copies.as_ref().map(Meshes::of).transpose()?,
        })
    }

    pub fn copies(&self) -> PyResult<Option<Copies<'_, T>>> {
        self.copies.as_ref().map(Meshes::copies).transpose()
    }

    pub fn surfaces<'b>(&'b self, copies: Option<&'b Copies<'b, T>>) -> PyResult<Surfaces<'b, T>> {
        let (tree, .., (background, offset, sky), _) = self.given;
        let sky = sky.as_ref().map(|s| s.get().of::<T>()).transpose()?;
        Ok(Surfaces {
            bvh: tree.get().of::<T>()?,
            copies,
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
