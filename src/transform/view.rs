//! The view matrix of an eye that looks at a target: world to eye space, where the eye looks down -z.
//!
//! `up` may slant; only its part across the line of sight counts. Where it is parallel to the line of sight, or eye
//! and target coincide, there is no view: NaN. Beside it the inverses that views are made of: of rigid motions, and
//! of any frame.

use super::Rows4;
use crate::real::Real;
use crate::vec::{Mat3, Mat4, Vec3};

/// The view matrix.
#[inline(always)]
pub fn look_at<T: Real>(eye: Vec3<T>, target: Vec3<T>, up: Vec3<T>) -> Rows4<T> {
    let back = (eye - target).normalize();
    let across = up.normalize().cross(back);
    // The sine of the angle between up and sight; below a few roundings its direction is noise.
    let sine = across.length();
    let clear = sine > T::of(8.0) * T::EPSILON;
    let right = if clear { across.normalize() } else { Vec3::splat(T::NAN) };
    // Normalised again: right and back are perpendicular up to the rounding of `across` over its length.
    let above = back.cross(right).normalize();
    let row = |axis: Vec3<T>| [axis.x, axis.y, axis.z, -axis.dot(eye)];
    [
        row(right),
        row(above),
        row(back),
        [T::zero(), T::zero(), T::zero(), if clear { T::one() } else { T::NAN }],
    ]
}

/// Whether the rows are orthonormal to a thousandth, which no chain of rotations drifts from in practice.
#[inline(always)]
pub fn orthonormal<T: Real>([a, b, c]: [Vec3<T>; 3]) -> bool {
    let (one, slack) = (T::one(), T::of(1e-3));
    let near = |x: T, y: T| (x - y).abs() <= slack;
    near(a.dot(a), one)
        && near(b.dot(b), one)
        && near(c.dot(c), one)
        && near(a.dot(b), T::zero())
        && near(b.dot(c), T::zero())
        && near(c.dot(a), T::zero())
}

/// The inverse of a rigid motion, by transposition; NaN where lengths or angles are not kept.
#[inline(always)]
pub fn rigid_inverse<T: Real>(m: Rows4<T>) -> Rows4<T> {
    let (zero, one) = (T::zero(), T::one());
    let columns @ Mat3([x, y, z]) = Mat4::from_rows(m).mat3();
    if !(orthonormal(columns.0) && m[3] == [zero, zero, zero, one]) {
        return [[T::NAN; 4]; 4];
    }
    let origin = Vec3::new(m[0][3], m[1][3], m[2][3]);
    let row = |axis: Vec3<T>| [axis.x, axis.y, axis.z, -axis.dot(origin)];
    [row(x), row(y), row(z), [zero, zero, zero, one]]
}

/// From world coordinates to those along the axes `x`, `y`, `z` from `origin`, which need be neither orthogonal nor of
/// unit length; NaN where they lie in a plane (up to 8 rounding units).
#[inline(always)]
pub fn change_of_basis<T: Real>([x, y, z]: [Vec3<T>; 3], origin: Vec3<T>) -> Rows4<T> {
    let (zero, one) = (T::zero(), T::one());
    // Through unit axes, so that neither their volume nor its parts overflow.
    let units = [x.normalize(), y.normalize(), z.normalize()];
    let Mat3([a, b, c]) = Mat3(units).cofactor();
    let volume = a.dot(units[0]);
    let proper = volume.abs() > T::of(8.0) * T::EPSILON;
    let volume = if proper { volume } else { T::NAN };
    let row = |axis: Vec3<T>, unit: Vec3<T>, cofactor: Vec3<T>| {
        let length = axis.dot(unit);
        let r = cofactor.map(|e| e / volume / length);
        [r.x, r.y, r.z, -r.dot(origin)]
    };
    [row(x, units[0], a), row(y, units[1], b), row(z, units[2], c), [zero, zero, zero, one]]
}
