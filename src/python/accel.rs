//! Bindings of `accel`.

use crate::accel::Bvh;
use crate::accel::query::{Found, Rays};
use crate::python::array::{In, Out};
use crate::real::Real;
use numpy::Element;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::sync::Arc;

/// A tree in the precision of its mesh, shared with the kernels that trace rays.
#[pyclass(frozen)]
pub struct Tree(Precision);

enum Precision {
    Single(Arc<Bvh<f32>>),
    Double(Arc<Bvh<f64>>),
}

impl Tree {
    /// The tree, if it is of this precision.
    pub fn of<T: Held>(&self) -> PyResult<&Arc<Bvh<T>>> {
        T::pick(self).ok_or_else(|| PyTypeError::new_err("the tree is of another precision"))
    }
}

/// A precision that trees are held in.
pub trait Held: Real {
    fn wrap(tree: Bvh<Self>) -> Tree;
    fn pick(tree: &Tree) -> Option<&Arc<Bvh<Self>>>;
}

impl Held for f32 {
    fn wrap(tree: Bvh<f32>) -> Tree {
        Tree(Precision::Single(Arc::new(tree)))
    }
    fn pick(tree: &Tree) -> Option<&Arc<Bvh<f32>>> {
        if let Precision::Single(t) = &tree.0 { Some(t) } else { None }
    }
}

impl Held for f64 {
    fn wrap(tree: Bvh<f64>) -> Tree {
        Tree(Precision::Double(Arc::new(tree)))
    }
    fn pick(tree: &Tree) -> Option<&Arc<Bvh<f64>>> {
        if let Precision::Double(t) = &tree.0 { Some(t) } else { None }
    }
}

#[pymethods]
impl Tree {
    /// Faces, nodes, blocks, bytes, children a node, triangles a block.
    fn stats(&self) -> (usize, usize, usize, usize, f64, f64) {
        let s = match &self.0 {
            Precision::Single(t) => t.stats(),
            Precision::Double(t) => t.stats(),
        };
        (s.faces, s.nodes, s.blocks, s.bytes, s.children_per_node, s.triangles_per_block)
    }
}

/// The arrays of rays, held while a kernel reads them.
struct RayArrays<'py, T: Element> {
    origins: In<'py, T>,
    directions: In<'py, T>,
    t_min: In<'py, T>,
    t_max: In<'py, T>,
    ignore_face: In<'py, i32>,
}

impl<'py, T: Real + Element> RayArrays<'py, T> {
    /// From origins, directions, t_min, t_max, ignore_face.
    fn of([o, d, low, high, ignore]: &[Bound<'py, PyAny>; 5]) -> PyResult<Self> {
        Ok(RayArrays {
            origins: In::of("origins", o)?,
            directions: In::of("directions", d)?,
            t_min: In::of("t_min", low)?,
            t_max: In::of("t_max", high)?,
            ignore_face: In::of("ignore_face", ignore)?,
        })
    }
    fn get(&self) -> PyResult<Rays<'_, T>> {
        Ok(Rays {
            origins: self.origins.items()?,
            directions: self.directions.items()?,
            t_min: self.t_min.slice()?,
            t_max: self.t_max.slice()?,
            ignore_face: self.ignore_face.slice()?,
        })
    }
}

/// The arrays of hits, held while a kernel writes them.
struct HitArrays<'py, T: Element>(Out<'py, T>, Out<'py, i32>, Out<'py, T>, Out<'py, T>);

impl<'py, T: Real + Element> HitArrays<'py, T> {
    /// From t, face, u, v.
    fn of([t, face, u, v]: &[Bound<'py, PyAny>; 4]) -> PyResult<Self> {
        Ok(HitArrays(Out::of("t", t)?, Out::of("face", face)?, Out::of("u", u)?, Out::of("v", v)?))
    }
    fn get(&mut self) -> PyResult<Found<'_, T>> {
        Ok(Found { t: self.0.slice()?, face: self.1.slice()?, u: self.2.slice()?, v: self.3.slice()? })
    }
}

#[pymodule]
pub mod accel {
    #[pymodule_export]
    use super::Tree;
    use super::{Held, HitArrays, RayArrays};
    use crate::accel as kernels;
    use crate::accel::Bvh;
    use crate::python::array::{In, Out, run};
    use crate::real;
    use pyo3::prelude::*;

    #[pyfunction]
    fn build(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Tree> {
        real!(positions, T => {
            let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
            let (p, f) = (p.items()?, f.items()?);
            Ok(Held::wrap(run(py, progress, |watch| Bvh::build(watch, p, f))?))
        })
    }

    #[pyfunction]
    fn closest_hit(
        py: Python<'_>,
        tree: &Tree,
        rays: [Bound<'_, PyAny>; 5],
        out: [Bound<'_, PyAny>; 4],
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        real!(&rays[0], T => {
            let (tree, rays, mut out) = (tree.of::<T>()?, RayArrays::<T>::of(&rays)?, HitArrays::of(&out)?);
            let (rays, found) = (rays.get()?, out.get()?);
            run(py, progress, |watch| kernels::query::closest_hits(watch, tree, &rays, found))
        })
    }

    #[pyfunction]
    fn any_hit(
        py: Python<'_>,
        tree: &Tree,
        rays: [Bound<'_, PyAny>; 5],
        out: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let mut out = Out::<bool>::of("out", out)?;
        let out = out.slice()?;
        real!(&rays[0], T => {
            let (tree, rays) = (tree.of::<T>()?, RayArrays::<T>::of(&rays)?);
            let rays = rays.get()?;
            run(py, progress, |watch| kernels::query::any_hits(watch, tree, &rays, out))
        })
    }

    #[pyfunction]
    fn brute_force(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        rays: [Bound<'_, PyAny>; 5],
        out: [Bound<'_, PyAny>; 4],
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        real!(&rays[0], T => {
            let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
            let (p, f, rays, mut out) = (p.items()?, f.items()?, RayArrays::<T>::of(&rays)?, HitArrays::of(&out)?);
            let (rays, found) = (rays.get()?, out.get()?);
            run(py, progress, |watch| kernels::brute_force::closest_hits(watch, p, f, &rays, found))
        })
    }

    #[pyfunction]
    fn normals(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        hit: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(positions, T => {
            let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
            let (p, f) = (p.items()?, f.items()?);
            let (hit, mut out) = (In::<i32>::of("face", hit)?, Out::<T>::of("normal", out)?);
            let (hit, out) = (hit.slice()?, out.items()?);
            run(py, None, |watch| kernels::query::normals(watch, p, f, hit, out))
        })
    }

    #[pyfunction]
    fn offset_ray(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        normals: &Bound<'_, PyAny>,
        directions: Option<&Bound<'_, PyAny>>,
        extents: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(points, T => {
            let (p, n) = (In::<T>::of("points", points)?, In::<T>::of("normals", normals)?);
            let d = directions.map(|d| In::<T>::of("directions", d)).transpose()?;
            let (e, mut out) = (In::<T>::of("extent", extents)?, Out::<T>::of("out", out)?);
            let (p, n, e, out) = (p.items()?, n.items()?, e.slice()?, out.items()?);
            let d = d.as_ref().map(|d| d.items()).transpose()?;
            run(py, None, |watch| kernels::offset_ray::offset_ray_many(watch, p, n, d, e, out))
        })
    }
}
