//! Model, view, projection, viewport: matrices that act on column vectors, and their work on points.
//!
//! Right-handed, y up; cameras look down -z. Every function works on batches; matrices are stored by rows as NumPy
//! has them.
//!
//! - [`affine`]: translation, scaling, shear, rotation about an axis; the same in the plane
//! - [`compose`]: affine matrices from translation, rotation, scale, shear, and back
//! - [`depth_precision`]: what a depth buffer tells apart at a distance
//! - [`euler`]: rotations by three angles, in every order, and back
//! - [`normal_matrix`]: the matrix that carries normals
//! - [`orthonormal_basis`]: a frame about a normal
//! - [`points`]: points, vectors and normals through matrices; pixels and back
//! - [`projection`]: perspective and orthographic projections, viewport, linear depth
//! - [`quaternion`]: products, rotation, interpolation, matrices and back
//! - [`vectors`]: the angle between two, and parts of one along the other
//! - [`view`]: the view matrix of an eye that looks at a target; rigid inverses, change of basis

pub mod affine;
pub mod compose;
pub mod depth_precision;
pub mod euler;
pub mod normal_matrix;
pub mod orthonormal_basis;
pub mod points;
pub mod projection;
pub mod quaternion;
pub mod vectors;
pub mod view;

/// A matrix by rows.
pub type Rows3<T> = [[T; 3]; 3];
/// A matrix by rows.
pub type Rows4<T> = [[T; 4]; 4];

#[cfg(test)]
mod tests {
    //! Against glam, in double precision, and in single against our own double.

    use super::*;
    use crate::real::Real;
    use crate::vec::{Vec3, Vec4};
    use compose::Parts;
    use euler::Order;
    use glam::dcamera::rh::{proj::directx, proj::opengl, view::look_at_mat4};
    use glam::{DMat4, DQuat, DVec3, EulerRot};
    use projection::{Depth, Frustum};

    /// Numbers in [-1, 1) from a linear congruence.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1u64;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    fn distance<T: Real>(ours: Rows4<T>, theirs: DMat4) -> f64 {
        let theirs = theirs.transpose().to_cols_array_2d();
        let pairs = ours.as_flattened().iter().zip(theirs.as_flattened());
        pairs.map(|(a, b)| (a.to_f64() - b).abs() / b.abs().max(1.0)).fold(0.0, f64::max)
    }

    fn agree<T: Real>() {
        let mut next = numbers();
        let tolerance = 64.0 * T::EPSILON.to_f64();
        for _ in 0..1000 {
            let mut v = || DVec3::new(next(), next(), next()) + DVec3::splat(0.01);
            let (eye, target, up) = (v(), v(), v());
            let t = |v: DVec3| Vec3::from(v.to_array().map(T::of));
            // Single precision has the arguments' own rounding, which a slanted up magnifies.
            let sine = up.normalize().cross((eye - target).normalize()).length() * (eye - target).length();
            let theirs = look_at_mat4(eye, target, up);
            assert!(distance(view::look_at(t(eye), t(target), t(up)), theirs) < tolerance / sine);

            let angle = 3.0 * next();
            let theirs = DMat4::from_axis_angle(up.normalize(), angle);
            assert!(distance(affine::rotate_axis(t(up), T::of(angle)), theirs) < tolerance / up.length());

            let (fov, aspect) = (1.5 + next(), 1.5 + next());
            let (near, far) = (0.6 + 0.5 * next(), 30.0 + 10.0 * next());
            let frustum = Frustum::from_fov(T::of(fov), T::of(aspect), T::of(near), T::of(far));
            for (depth, theirs) in [
                (Depth::Standard, opengl::perspective(fov, aspect, near, far)),
                (Depth::ZeroToOne, directx::perspective(fov, aspect, near, far)),
                (Depth::Reversed, directx::perspective(fov, aspect, far, near)),
            ] {
                assert!(distance(projection::perspective(frustum, depth), theirs) < tolerance);
            }
            let open = Frustum::from_fov(T::of(fov), T::of(aspect), T::of(near), T::INFINITY);
            let theirs = directx::perspective_infinite_reverse(fov, aspect, near);
            assert!(distance(projection::perspective(open, Depth::Reversed), theirs) < tolerance);
            let planes = [-1.0 + 0.5 * next(), 1.0, -1.0, 1.5 + next(), near, far];
            let ours = projection::orthographic(Frustum(planes.map(T::of)), Depth::Standard);
            let [l, r, b, t, n, f] = planes;
            assert!(distance(ours, opengl::orthographic(l, r, b, t, n, f)) < tolerance);
        }
    }

    fn rotations_agree<T: Real>() {
        let mut next = numbers();
        let tolerance = 32.0 * T::EPSILON.to_f64();
        let orders = [
            ("XYZ", EulerRot::XYZ),
            ("ZXZ", EulerRot::ZXZ),
            ("zyx", EulerRot::ZYXEx),
            ("yzy", EulerRot::YZYEx),
        ];
        for _ in 0..1000 {
            let mut unit = || DQuat::from_xyzw(next(), next(), next(), next() + 0.1).normalize();
            let (a, b) = (unit(), unit());
            let t = |q: DQuat| Vec4::from(q.to_array().map(T::of));
            let near = |ours: Vec4<T>, theirs: DQuat| {
                ours.to_array().iter().zip(theirs.to_array()).all(|(x, y)| (x.to_f64() - y).abs() < tolerance)
            };
            let m = DMat4::from_quat(a);
            assert!(near(quaternion::multiply(t(a), t(b)), a * b));
            assert!(near(quaternion::inverse(t(a)), a.inverse()));
            let toward = if a.dot(b) < 0.0 { -b } else { b };
            assert!(near(quaternion::slerp(t(a), t(b), T::of(0.3), true), a.slerp(toward, 0.3)));
            assert!(distance(affine::linear(quaternion::to_matrix(t(a))), m) < tolerance);
            for (name, theirs) in orders {
                let order = Order::from_name(name).unwrap();
                let (x, y, z) = a.to_euler(theirs);
                let ours = euler::euler([x, y, z].map(T::of), order);
                // Beside gimbal lock their angles have fewer digits.
                assert!(distance(affine::linear(ours), m) < 1e-7_f64.max(tolerance));
            }
            let parts = Parts {
                translation: [next(), next(), next()].map(T::of),
                rotation: t(a),
                scale: [1.0 + next(), 2.0 + next(), 3.0 + next()].map(T::of),
                shear: [T::zero(); 3],
            };
            let vector = |v: [T; 3]| DVec3::from_array(v.map(Real::to_f64));
            let theirs =
                DMat4::from_scale_rotation_translation(vector(parts.scale), a, vector(parts.translation));
            assert!(distance(compose::compose(parts), theirs) < tolerance);
        }
    }

    #[test]
    fn rotations_are_glams() {
        rotations_agree::<f32>();
        rotations_agree::<f64>();
    }

    #[test]
    fn matrices_are_glams() {
        agree::<f32>();
        agree::<f64>();
    }
}
