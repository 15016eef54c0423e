//! Bindings of `transform`, a file for each of its faces: affine, view, projection, normal_matrix, points.

mod affine;
mod points;
mod projection;
mod view;

use pyo3::prelude::*;

#[pymodule]
pub mod transform {
    #[pymodule_export]
    use super::affine::{rotate_axis, scale, translate};
    #[pymodule_export]
    use super::points::{normal_matrix, project, transform, unproject};
    #[pymodule_export]
    use super::projection::{linear_depth, orthographic, perspective, perspective_fov};
    #[pymodule_export]
    use super::view::{look_at, viewport};
}
