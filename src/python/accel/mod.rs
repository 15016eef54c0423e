//! Bindings of `accel`: bvh, uniform_grid, octree, kd_tree, bsp_tree, brute_force, morton, offset_ray.

pub(super) mod instances;
mod morton;
mod moving;
mod points;
mod cells;
mod rays;
mod tree;

pub use tree::Tree;

use pyo3::prelude::*;

#[pymodule]
pub mod accel {
    #[pymodule_export]
    use super::Tree;
    #[pymodule_export]
    use super::cells::{bsp_tree, kd_tree, octree, uniform_grid};
    #[pymodule_export]
    use super::instances::Instances;
    #[pymodule_export]
    use super::morton::{morton_decode, morton_encode, morton_encode_points, radix_tree};
    #[pymodule_export]
    use super::moving::{from_bytes, overlap, refit, to_bytes};
    #[pymodule_export]
    use super::points::{Moments, Pseudonormals, closest_point, winding_number};
    use super::rays::{HitArrays, RayArrays, hit_lists, query};
    use super::tree::{self, Held, Other, no_memory, queries};
    use crate::accel as kernels;
    use crate::accel::Bvh;
    use crate::accel::bvh::Method;
    use crate::python::array::{In, Out, run};
    use crate::real;
    use numpy::IntoPyArray;
    use pyo3::exceptions::{PyTypeError, PyValueError};
    use pyo3::prelude::*;

    #[pyfunction]
    fn build(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        method: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Tree> {
        let method = match method {
            "sah" => Method::Sah,
            "median" => Method::Median,
            "lbvh" => Method::Lbvh,
            _ => return Err(PyValueError::new_err(format!("method: unknown, got {method:?}"))),
        };
        real!(positions, T => {
            let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
            let (p, f) = (p.items()?, f.items()?);
            Ok(Held::wrap(run(py, progress, |watch| Bvh::build(watch, p, f, method))?))
        })
    }

    #[pyfunction]
    fn closest_hit(
        py: Python<'_>,
        structure: &Bound<'_, PyAny>,
        rays: [Bound<'_, PyAny>; 5],
        width: usize,
        out: [Bound<'_, PyAny>; 4],
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        real!(&rays[0], T => {
            let (structure, rays) = (queries::<T>(structure)?, RayArrays::<T>::of(&rays)?);
            let mut out = HitArrays::of(&out)?;
            let (rays, found) = (rays.picture(width)?, out.get()?);
            run(py, progress, |watch| structure.closest_hits(watch, &rays, found))
        })
    }

    #[pyfunction]
    fn any_hit(
        py: Python<'_>,
        structure: &Bound<'_, PyAny>,
        rays: [Bound<'_, PyAny>; 5],
        width: usize,
        out: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let mut out = Out::<bool>::of("out", out)?;
        let out = out.slice()?;
        real!(&rays[0], T => {
            let (structure, rays) = (queries::<T>(structure)?, RayArrays::<T>::of(&rays)?);
            let rays = rays.picture(width)?;
            run(py, progress, |watch| structure.any_hits(watch, &rays, out))
        })
    }

    /// Offsets, t, face, u, v.
    #[pyfunction]
    fn all_hits<'py>(
        py: Python<'py>,
        structure: &Bound<'py, PyAny>,
        rays: [Bound<'py, PyAny>; 5],
        width: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<[Bound<'py, PyAny>; 5]> {
        real!(&rays[0], T => {
            let (structure, rays) = (queries::<T>(structure)?, RayArrays::<T>::of(&rays)?);
            let rays = rays.picture(width)?;
            let found = run(py, progress, |watch| structure.all_hits(watch, &rays, rays.origins.len()))?;
            Ok(hit_lists(py, found.map_err(|_| no_memory("hits"))?))
        })
    }

    /// Boxes and triangles that each ray tests in answering a query.
    #[pyfunction]
    fn counts(
        py: Python<'_>,
        name: &str,
        structure: &Bound<'_, PyAny>,
        rays: [Bound<'_, PyAny>; 5],
        out: [Bound<'_, PyAny>; 2],
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let (mut boxes, mut triangles) =
            (Out::<i32>::of("boxes", &out[0])?, Out::<i32>::of("triangles", &out[1])?);
        let (boxes, triangles) = (boxes.slice()?, triangles.slice()?);
        real!(&rays[0], T => {
            let (structure, rays) = (queries::<T>(structure)?, RayArrays::<T>::of(&rays)?);
            let rays = rays.get()?;
            run(py, progress, |watch| structure.counts(watch, &rays, query(name), (boxes, triangles)))
        })
    }

    /// Faces from front to back, and their corners.
    #[pyfunction]
    fn order<'py>(
        py: Python<'py>,
        structure: &Bound<'py, PyAny>,
        eye: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        real!(eye, T => {
            let (structure, eye) = (queries::<T>(structure)?, In::<T>::of("eye", eye)?);
            let eye = eye.items()?[0];
            let ordered = run(py, None, |_| Ok(structure.ordered(eye)))?;
            let ordered = ordered.ok_or_else(|| PyTypeError::new_err("the structure does not order faces"))?;
            let corners = ordered.corners.into_flattened().into_flattened();
            Ok((ordered.face.into_pyarray(py).into_any(), corners.into_pyarray(py).into_any()))
        })
    }

    /// Every triangle, as a structure.
    #[pyfunction]
    fn brute_force(positions: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<Other> {
        real!(positions, T => {
            let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
            Ok(tree::brute_force(p.items()?, f.items()?))
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
