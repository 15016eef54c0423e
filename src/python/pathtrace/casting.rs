//! What the centres of pixels see.

use super::pinhole;
use crate::pathtrace::ray_cast as seen;
use crate::python::accel::Tree;
use crate::python::array::{Out, run};
use crate::real;
use pyo3::prelude::*;

#[pyfunction]
pub fn ray_cast(
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
