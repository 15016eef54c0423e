//! Placed copies of hierarchies.

use super::Tree;
use super::rays::{HitArrays, RayArrays};
use super::tree::Held;
use crate::accel::bvh::instances::{Affine, Found, Instance, Instances as Placed};
use crate::python::array::{Arrays, In, Out, run, same_length};
use crate::real;
use numpy::IntoPyArray;
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
trait Precision: Held {
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

fn placed<T: Precision>(instances: &Instances) -> PyResult<&Arc<Placed<T>>> {
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
        out: [Bound<'_, PyAny>; 4],
        instance: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let mut instance = Out::<i32>::of("instance", instance)?;
        let instance = instance.slice()?;
        real!(&rays[0], T => {
            let (rays, mut out) = (RayArrays::<T>::of(&rays)?, HitArrays::of(&out)?);
            let (rays, hits) = (rays.get()?, out.get()?);
            let placed = placed::<T>(self)?;
            run(py, progress, |watch| placed.closest_hits(watch, &rays, Found { hits, instance }))
        })
    }

    fn any_hit(
        &self,
        py: Python<'_>,
        rays: [Bound<'_, PyAny>; 5],
        out: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let mut out = Out::<bool>::of("out", out)?;
        let out = out.slice()?;
        real!(&rays[0], T => {
            let rays = RayArrays::<T>::of(&rays)?;
            let (rays, placed) = (rays.get()?, placed::<T>(self)?);
            run(py, progress, |watch| placed.any_hits(watch, &rays, out))
        })
    }

    /// Offsets, t, face, u, v, instance.
    fn all_hits<'py>(
        &self,
        py: Python<'py>,
        rays: [Bound<'py, PyAny>; 5],
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Arrays<'py>> {
        real!(&rays[0], T => {
            let rays = RayArrays::<T>::of(&rays)?;
            let (rays, placed) = (rays.get()?, placed::<T>(self)?);
            let found = run(py, progress, |watch| placed.all_hits(watch, &rays, rays.origins.len()))?;
            let numbers = |of: fn(&crate::accel::Hit<T>) -> T| {
                found.hits.iter().map(|(h, _)| of(h)).collect::<Vec<T>>().into_pyarray(py).into_any()
            };
            let (t, u, v) = (numbers(|h| h.t), numbers(|h| h.u), numbers(|h| h.v));
            let face: Vec<i32> = found.hits.iter().map(|(h, _)| h.face).collect();
            let instance: Vec<i32> = found.hits.iter().map(|&(_, i)| i).collect();
            let (face, instance) = (face.into_pyarray(py).into_any(), instance.into_pyarray(py).into_any());
            Ok(vec![found.offsets.into_pyarray(py).into_any(), t, face, u, v, instance])
        })
    }
}
