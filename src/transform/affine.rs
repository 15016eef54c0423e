//! Translation, scaling, and rotation about an axis through the origin.
//!
//! O. Rodrigues, *Des lois géométriques qui régissent les déplacements d'un système solide*, 1840.

use super::{Rows4, fill};
use crate::math::sin_cos;
use crate::parallel::{Interrupted, Watch};
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

/// [`rotate_axis`] over arrays of equal length.
pub fn rotate_axis_many<T: Real>(
    watch: &mut dyn Watch,
    axes: &[[T; 3]],
    angles: &[T],
    out: &mut [Rows4<T>],
) -> Result<(), Interrupted> {
    fill(watch, out, |i| rotate_axis(axes[i].into(), angles[i]))
}

/// Translations by `offsets`.
pub fn translate_many<T: Real>(
    watch: &mut dyn Watch,
    offsets: &[[T; 3]],
    out: &mut [Rows4<T>],
) -> Result<(), Interrupted> {
    let (one, zero) = (T::one(), T::zero());
    fill(watch, out, |i| {
        let [x, y, z] = offsets[i];
        [[one, zero, zero, x], [zero, one, zero, y], [zero, zero, one, z], [zero, zero, zero, one]]
    })
}

/// Scalings by `factors` along the axes.
pub fn scale_many<T: Real>(
    watch: &mut dyn Watch,
    factors: &[[T; 3]],
    out: &mut [Rows4<T>],
) -> Result<(), Interrupted> {
    let (one, zero) = (T::one(), T::zero());
    fill(watch, out, |i| {
        let [x, y, z] = factors[i];
        [[x, zero, zero, zero], [zero, y, zero, zero], [zero, zero, z, zero], [zero, zero, zero, one]]
    })
}
