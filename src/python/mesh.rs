//! Bindings of `mesh`: normals, primitives.
use pyo3::prelude::*;

#[pymodule]
pub mod mesh {
    use crate::mesh::normals::{self, Weights};
    use crate::mesh::primitives;
    use crate::python::array::{In, Out, run};
    use crate::real;
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    type Array<'a, 'py> = &'a Bound<'py, PyAny>;

    #[pyfunction]
    fn face_normals(
        py: Python<'_>,
        positions: Array<'_, '_>,
        faces: Array<'_, '_>,
        out: Array<'_, '_>,
    ) -> PyResult<()> {
        real!(positions, T => {
            let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
            let mut out = Out::<T>::of("out", out)?;
            let (p, f, out) = (p.items()?, f.items()?, out.items()?);
            run(py, None, |watch| normals::face_normals(watch, p, f, out))
        })
    }

    #[pyfunction]
    fn vertex_normals(
        py: Python<'_>,
        positions: Array<'_, '_>,
        faces: Array<'_, '_>,
        weights: &str,
        out: Array<'_, '_>,
    ) -> PyResult<()> {
        let weights = match weights {
            "angle" => Weights::Angle,
            "area" => Weights::Area,
            "uniform" => Weights::Uniform,
            _ => return Err(PyValueError::new_err(format!("weights: unknown {weights:?}"))),
        };
        real!(positions, T => {
            let (p, f) = (In::<T>::of("positions", positions)?, In::<i32>::of("faces", faces)?);
            let mut out = Out::<T>::of("out", out)?;
            let (p, f, out) = (p.items()?, f.items()?, out.items()?);
            run(py, None, |watch| normals::vertex_normals(watch, p, f, weights, out))
        })
    }

    /// The numbers of vertices and faces of a primitive.
    #[pyfunction]
    fn counts(name: &str, numbers: Vec<usize>) -> (usize, usize) {
        match (name, &numbers[..]) {
            ("plane", &[segments]) => primitives::plane_counts(segments),
            ("icosphere", &[subdivisions]) => primitives::icosphere_counts(subdivisions),
            ("torus", &[segments, sides]) => primitives::torus_counts(segments, sides),
            _ => primitives::BOX,
        }
    }

    /// Fills the arrays of a primitive; `lengths` and `numbers` are its parameters.
    #[pyfunction]
    fn primitive(
        name: &str,
        lengths: Vec<f64>,
        numbers: Vec<usize>,
        positions: Array<'_, '_>,
        normals: Array<'_, '_>,
        uvs: Option<Array<'_, '_>>,
        faces: Array<'_, '_>,
    ) -> PyResult<()> {
        let mut faces = Out::<i32>::of("faces", faces)?;
        real!(positions, T => {
            let (mut p, mut n) = (Out::<T>::of("positions", positions)?, Out::<T>::of("normals", normals)?);
            let mut uv = uvs.map(|uvs| Out::<T>::of("uvs", uvs)).transpose()?;
            let uv: &mut [[T; 2]] = match &mut uv {
                Some(uv) => uv.items()?,
                None => &mut [],
            };
            let (p, n, faces) = (p.items()?, n.items()?, faces.items()?);
            let l: Vec<T> = lengths.iter().map(|&x| x as T).collect();
            match (name, &l[..], &numbers[..]) {
                ("box", &[x, y, z], []) => primitives::fill_box([x, y, z], p, n, uv, faces),
                ("plane", &[x, z], &[segments]) => primitives::fill_plane([x, z], segments, p, n, uv, faces),
                ("icosphere", &[r], &[subdivisions]) => primitives::fill_icosphere(subdivisions, r, p, n, faces),
                ("torus", &[r, t], &[segments, sides]) => primitives::fill_torus([r, t], [segments, sides], p, n, faces),
                _ => return Err(PyValueError::new_err(format!("no primitive {name:?} of these parameters"))),
            }
        });
        Ok(())
    }
}
