//! Translation, scaling, shear, and rotation about an axis through the origin; the same in the plane.
//!
//! O. Rodrigues, *Des lois géométriques qui régissent les déplacements d'un système solide*, 1840.

use super::{Rows3, Rows4};
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

/// The rotation about the coordinate axis `axis` (0, 1, 2), counter-clockwise seen against it.
#[inline(always)]
pub fn rotate_coordinate<T: Real>(axis: usize, angle: T) -> Rows4<T> {
    let (one, zero) = (T::one(), T::zero());
    let (s, c) = sin_cos(angle);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = [[zero; 4]; 4];
    (m[axis][axis], m[3][3]) = (one, one);
    (m[i][i], m[i][j], m[j][i], m[j][j]) = (c, -s, s, c);
    m
}

/// The matrix `K` with `K p = v × p`.
#[inline(always)]
pub fn cross_matrix<T: Real>(v: Vec3<T>) -> Rows3<T> {
    let zero = T::zero();
    [[zero, -v.z, v.y], [v.z, zero, -v.x], [-v.y, v.x, zero]]
}

/// A linear map as an affine one.
#[inline(always)]
pub fn linear<T: Real>([a, b, c]: Rows3<T>) -> Rows4<T> {
    let (one, zero) = (T::one(), T::zero());
    let row = |[x, y, z]: [T; 3]| [x, y, z, zero];
    [row(a), row(b), row(c), [zero, zero, zero, one]]
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

/// The shear that adds `xy` times y and `xz` times z to x, and so on.
#[inline(always)]
pub fn shear<T: Real>([xy, xz, yx, yz, zx, zy]: [T; 6]) -> Rows4<T> {
    let (one, zero) = (T::one(), T::zero());
    [[one, xy, xz, zero], [yx, one, yz, zero], [zx, zy, one, zero], [zero, zero, zero, one]]
}

/// The translation in the plane.
#[inline(always)]
pub fn translate_2d<T: Real>([x, y]: [T; 2]) -> Rows3<T> {
    let (one, zero) = (T::one(), T::zero());
    [[one, zero, x], [zero, one, y], [zero, zero, one]]
}

/// The scaling in the plane.
#[inline(always)]
pub fn scale_2d<T: Real>([x, y]: [T; 2]) -> Rows3<T> {
    let (one, zero) = (T::one(), T::zero());
    [[x, zero, zero], [zero, y, zero], [zero, zero, one]]
}

/// The counter-clockwise rotation in the plane.
#[inline(always)]
pub fn rotate_2d<T: Real>(angle: T) -> Rows3<T> {
    let (one, zero) = (T::one(), T::zero());
    let (s, c) = sin_cos(angle);
    [[c, -s, zero], [s, c, zero], [zero, zero, one]]
}

/// The shear in the plane that adds `xy` times y to x, and `yx` times x to y.
#[inline(always)]
pub fn shear_2d<T: Real>([xy, yx]: [T; 2]) -> Rows3<T> {
    let (one, zero) = (T::one(), T::zero());
    [[one, xy, zero], [yx, one, zero], [zero, zero, one]]
}
