//! Bindings of `accel`: bvh, brute_force, offset_ray.

mod rays;
mod tree;

pub use tree::Tree;

use pyo3::prelude::*;

#[pymodule]
pub mod accel {
    #[pymodule_export]
    use super::Tree;
    use super::rays::{HitArrays, RayArrays};
    use super::tree::Held;
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
