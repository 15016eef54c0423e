//! Bindings of `transform`, a file for each of its faces: affine (compose), rotation (euler), quaternion, view,
//! projection (depth_precision), points (normal_matrix), vectors (orthonormal_basis).

mod affine;
mod points;
mod projection;
mod quaternion;
mod rotation;
mod vectors;
mod view;

use pyo3::prelude::*;

#[pymodule]
pub mod transform {
    #[pymodule_export]
    use super::affine::{compose, decompose, scale, scale_2d, shear, shear_2d, translate, translate_2d};
    #[pymodule_export]
    use super::points::{normal_matrix, project, transform, transform_2d, unproject};
    #[pymodule_export]
    use super::projection::{depth_precision, linear_depth, orthographic, perspective, perspective_fov};
    #[pymodule_export]
    use super::quaternion::{
        quaternion_conjugate, quaternion_from_axis, quaternion_from_matrix, quaternion_inverse,
        quaternion_multiply, quaternion_rotate, quaternion_slerp, quaternion_to_matrix,
    };
    #[pymodule_export]
    use super::rotation::{cross_matrix, euler, euler_angles, rotate_2d, rotate_axis, rotate_coordinate};
    #[pymodule_export]
    use super::vectors::{angle_between, orthonormal_basis, project_onto};
    #[pymodule_export]
    use super::view::{change_of_basis, look_at, rigid_inverse, viewport};
}
