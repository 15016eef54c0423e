//! The view matrix of an eye that looks at a target: world to eye space, where the eye looks down -z.
//!
//! `up` may slant; only its part across the line of sight counts. Where it is parallel to the line of sight, or eye
//! and target coincide, there is no view: NaN.

use super::Rows4;
use crate::real::Real;
use crate::vec::Vec3;

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
