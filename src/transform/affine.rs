//! Translation, scaling, and rotation about an axis through the origin.
//!
//! O. Rodrigues, *Des lois géométriques qui régissent les déplacements d'un système solide*, 1840.

use super::Rows4;
use crate::math::sin_cos;
use crate::real::Real;
use crate::vec::Vec3;

/// The rotation by `angle` radians about `axis` (of any length), counter-clockwise seen against the axis.
#[inline(always)]
pub fn rotate_axis<T: Real>(axis: Vec3<T>, angle: T) -> Rows4<T> {
    let Vec3 { x, y, z } = axis.normalize();
    let (one, zero) = (T::one(), T::zero());
    let (s, _) = sin_cos(angle);
    // 1 - cos through the half angle, which loses nothing where the angle is small.
    let (h, _) = sin_cos(angle * T::of(0.5));
    let v = T::of(2.0) * h * h;
    [
        [one - v * (y * y + z * z), v * (x * y) - s * z, v * (x * z) + s * y, zero],
        [v * (x * y) + s * z, one - v * (x * x + z * z), v * (y * z) - s * x, zero],
        [v * (x * z) - s * y, v * (y * z) + s * x, one - v * (x * x + y * y), zero],
        [zero, zero, zero, one],
    ]
}

/// The translation by an offset.
#[inline(always)]
pub fn translate<T: Real>([x, y, z]: [T; 3]) -> Rows4<T> {
    let (one, zero) = (T::one(), T::zero());
    [[one, zero, zero, x], [zero, one, zero, y], [zero, zero, one, z], [zero, zero, zero, one]]
}

/// The scaling along the axes.
#[inline(always)]
pub fn scale<T: Real>([x, y, z]: [T; 3]) -> Rows4<T> {
    let (one, zero) = (T::one(), T::zero());
    [[x, zero, zero, zero], [zero, y, zero, zero], [zero, zero, z, zero], [zero, zero, zero, one]]
}
