//! Bindings of `geometry`, a file for each of its faces.

mod points;
mod rays;

use pyo3::prelude::*;

#[pymodule]
pub mod geometry {
    #[pymodule_export]
    use super::points::barycentric;
    #[pymodule_export]
    use super::rays::ray_sphere;
    #[pymodule_export]
    use super::rays::ray_triangle;
}
