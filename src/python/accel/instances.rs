//! Placed copies of hierarchies.

use super::Tree;
use super::rays::{HitArrays, RayArrays, hit_lists, query};
use super::tree::{Held, StatsTuple, no_memory, tuple};
use crate::accel::bvh::instances::{Affine, Found, Instance, Instances as Placed, WorldRays};
use crate::accel::structure::Stats;
use crate::python::array::{Arrays, In, Out, run, same_length};
use crate::real;
use crate::real::Real;
use numpy::{Element, IntoPyArray};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::sync::Arc;

/// Instances in the precision of their objects.
#[pyclass(frozen)]
pub struct Instances {
    single: Option<Arc<Placed<f32>>>,
    double: Option<Arc<Placed<f64>>>,
}

/// A precision in which instances are held.
pub trait Precision: Held {
    fn held(instances: &Instances) -> Option<&Arc<Placed<Self>>>;
}

impl Precision for f32 {
    fn held(instances: &Instances) -> Option<&Arc<Placed<f32>>> {
        instances.single.as_ref()
    }
}

impl Precision for f64 {
    fn held(instances: &Instances) -> Option<&Arc<Placed<f64>>> {
        instances.double.as_ref()
    }
}

pub fn placed<T: Precision>(instances: &Instances) -> PyResult<&Arc<Placed<T>>> {
    T::held(instances).ok_or_else(|| PyTypeError::new_err("the instances are of another precision"))
}

fn place<T: Held>(
    py: Python<'_>,
    trees: &[PyRef<'_, Tree>],
    to_world: &In<'_, f64>,
    to_object: &In<'_, f64>,
) -> PyResult<Arc<Placed<T>>> {
    let (world, object) = (to_world.items::<16>()?, to_object.items::<16>()?);
    same_length(&[trees.len(), world.len(), object.len()])?;
    let rows = |m: &[f64; 16]| -> Affine { [0, 1, 2].map(|r| [0, 1, 2, 3].map(|c| m[4 * r + c])) };
    let mut instances = Vec::with_capacity(trees.len());
    for ((tree, world), object) in trees.iter().zip(world).zip(object) {
        let (to_world, to_object) = (rows(world), rows(object));
        instances.push(Instance { object: tree.of::<T>()?.clone(), to_world, to_object });
    }
    Ok(Arc::new(run(py, None, |watch| Placed::new(watch, instances))?))
}

#[pymethods]
impl Instances {
    #[new]
    fn new(
        py: Python<'_>,
        trees: Vec<PyRef<'_, Tree>>,
        to_world: &Bound<'_, PyAny>,
        to_object: &Bound<'_, PyAny>,
        double: bool,
    ) -> PyResult<Self> {
        let (world, object) = (In::of("transforms", to_world)?, In::of("inverse", to_object)?);
        Ok(if double {
            Instances { single: None, double: Some(place(py, &trees, &world, &object)?) }
        } else {
            Instances { single: Some(place(py, &trees, &world, &object)?), double: None }
        })
    }

    /// `out` is t, face, u, v.
    fn closest_hit(
        &self,
        py: Python<'_>,
        rays: [Bound<'_, PyAny>; 5],
        ignore_instance: &Bound<'_, PyAny>,
        out: [Bound<'_, PyAny>; 4],
        instance: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let mut instance = Out::<i32>::of("instance", instance)?;
        let instance = instance.slice()?;
        real!(&rays[0], T => {
            let ignore = In::of("ignore_instance", ignore_instance)?;
            let (rays, mut out) = (RayArrays::<T>::of(&rays)?, HitArrays::of(&out)?);
            let (rays, hits) = (world(&rays, &ignore)?, out.get()?);
            let placed = placed::<T>(self)?;
            run(py, progress, |watch| placed.closest_hits(watch, &rays, Found { hits, instance }))
        })
    }

    fn any_hit(
        &self,
        py: Python<'_>,
        rays: [Bound<'_, PyAny>; 5],
        ignore_instance: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let mut out = Out::<bool>::of("out", out)?;
        let out = out.slice()?;
        real!(&rays[0], T => {
            let (rays, ignore) = (RayArrays::<T>::of(&rays)?, In::of("ignore_instance", ignore_instance)?);
            let (rays, placed) = (world(&rays, &ignore)?, placed::<T>(self)?);
            run(py, progress, |watch| placed.any_hits(watch, &rays, out))
        })
    }

    /// Offsets, t, face, u, v, instance.
    fn all_hits<'py>(
        &self,
        py: Python<'py>,
        rays: [Bound<'py, PyAny>; 5],
        ignore_instance: &Bound<'py, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Arrays<'py>> {
        real!(&rays[0], T => {
            let (rays, ignore) = (RayArrays::<T>::of(&rays)?, In::of("ignore_instance", ignore_instance)?);
            let (rays, placed) = (world(&rays, &ignore)?, placed::<T>(self)?);
            let found = run(py, progress, |watch| placed.all_hits(watch, &rays, rays.rays.origins.len()))?;
            let found = found.map_err(|_| no_memory("hits"))?;
            let mut all = hit_lists(py, found.hits).to_vec();
            all.push(found.instance.into_pyarray(py).into_any());
            Ok(all)
        })
    }

    /// Boxes and triangles that each ray tests in answering a query.
    fn counts(
        &self,
        py: Python<'_>,
        name: &str,
        rays: [Bound<'_, PyAny>; 5],
        ignore_instance: &Bound<'_, PyAny>,
        out: [Bound<'_, PyAny>; 2],
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let (mut boxes, mut triangles) =
            (Out::<i32>::of("boxes", &out[0])?, Out::<i32>::of("triangles", &out[1])?);
        let out = (boxes.slice()?, triangles.slice()?);
        real!(&rays[0], T => {
            let (rays, ignore) = (RayArrays::<T>::of(&rays)?, In::of("ignore_instance", ignore_instance)?);
            let (rays, placed) = (world(&rays, &ignore)?, placed::<T>(self)?);
            run(py, progress, |watch| placed.counts(watch, &rays, query(name), out))
        })
    }

    fn stats(&self) -> StatsTuple {
        match (&self.single, &self.double) {
            (Some(placed), _) => tuple(placed.stats()),
            (_, Some(placed)) => tuple(placed.stats()),
            _ => tuple(Stats::default()),
        }
    }
}

fn world<'a, T: Real + Element>(
    rays: &'a RayArrays<'_, T>,
    ignore_instance: &'a In<'_, i32>,
) -> PyResult<WorldRays<'a, T>> {
    Ok(WorldRays { rays: rays.get()?, ignore_instance: ignore_instance.slice()? })
}
