//! Bindings of `pathtrace`, a file for each of its faces.

mod aov;
pub(super) mod camera;
mod casting;
mod direct;
mod paths;
mod recursion;
mod world;

use crate::pathtrace::Pinhole;
use crate::real::Real;
use crate::vec::Vec3;
use pyo3::prelude::*;

/// Eye, corner, right, down: see [`Pinhole`].
fn pinhole<T: Real>([eye, corner, right, down]: [[f64; 3]; 4]) -> Pinhole<T> {
    let vector = |v: [f64; 3]| Vec3::from(v.map(T::of));
    Pinhole { eye: vector(eye), corner: vector(corner), right: vector(right), down: vector(down) }
}

#[pymodule]
pub mod pathtrace {
    #[pymodule_export]
    use super::aov::aovs;
    #[pymodule_export]
    use super::camera::camera_rays;
    #[pymodule_export]
    use super::camera::pixel_filter_density;
    #[pymodule_export]
    use super::camera::pixel_filter_sample;
    #[pymodule_export]
    use super::casting::ray_cast;
    #[pymodule_export]
    use super::direct::direct_light;
    #[pymodule_export]
    use super::paths::path_trace;
    #[pymodule_export]
    use super::recursion::recursion;
}
