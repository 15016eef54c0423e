//! Affine matrices from their parts and back: `T R S H`, a translation, a rotation, a scaling along the axes, and a
//! shear `H` (unit upper triangular) that acts first.
//!
//! The parts exist for every affine matrix, singular ones as well, since the shear stands to the right of the scaling:
//! this is the QR decomposition, with the columns made orthonormal one after the other. A mirrored matrix has a
//! negative scale along x.
//!
//! S. Thomas, *Decomposing a Matrix into Simple Transformations*, Graphics Gems II, 1991.

use super::{Rows4, quaternion};
use crate::real::Real;
use crate::vec::{Mat3, Mat4, Vec3, Vec4};

#[derive(Clone, Copy, Debug)]
pub struct Parts<T> {
    pub translation: [T; 3],
    /// A quaternion.
    pub rotation: Vec4<T>,
    pub scale: [T; 3],
    /// How much of y goes to x, of z to x, of z to y.
    pub shear: [T; 3],
}

/// The matrix of the parts.
#[inline(always)]
pub fn compose<T: Real>(parts: Parts<T>) -> Rows4<T> {
    let Parts { translation, rotation, scale: [sx, sy, sz], shear: [xy, xz, yz] } = parts;
    let r = quaternion::to_matrix(rotation);
    let row = |i: usize| {
        let [x, y, z] = [r[i][0] * sx, r[i][1] * sy, r[i][2] * sz];
        [x, xy * x + y, (xz * x + yz * y) + z, translation[i]]
    };
    [row(0), row(1), row(2), [T::zero(), T::zero(), T::zero(), T::one()]]
}

/// The parts of an affine matrix, and whether it mirrors; NaN where its last row is not 0, 0, 0, 1. A column that
/// depends on those before it (up to 4 rounding units of its length) has scale zero.
#[inline(always)]
pub fn decompose<T: Real>(m: Rows4<T>) -> (Parts<T>, bool) {
    let zero = T::zero();
    let affine = m[3] == [zero, zero, zero, T::one()];
    let columns = Mat4::from_rows(m).mat3().0;
    if !(affine && columns.iter().all(|c| c.to_array().iter().all(|e| e.is_finite()))) {
        let nan = [T::NAN; 3];
        let parts = Parts { translation: nan, rotation: Vec4::splat(T::NAN), scale: nan, shear: nan };
        return (parts, false);
    }
    let mut axes: [Option<Vec3<T>>; 3] = [None; 3];
    for i in 0..3 {
        axes[i] = across(columns[i], &axes);
    }
    let full = axes.iter().all(|a| a.is_some());
    let [mut x, y, mut z] = complete(axes);
    let mirrored = full && x.cross(y).dot(z) < zero;
    if mirrored {
        x = -x;
    }
    z = if full { x.cross(y) } else { z };

    let along = |i: usize, axis: Vec3<T>| columns[i].dot(axis);
    let there = |i: usize, axis: Vec3<T>| if axes[i].is_some() { along(i, axis) } else { zero };
    let scale = [there(0, x), there(1, y), there(2, z)];
    // An axis without scale takes no shear: the columns have no part along it.
    let part = |i: usize, axis: Vec3<T>, scale: T| if scale == zero { zero } else { along(i, axis) / scale };
    let shear = [part(1, x, scale[0]), part(2, x, scale[0]), part(2, y, scale[1])];
    let rotation = quaternion::from_rotation(Mat3([x, y, z]).rows());
    let translation = [m[0][3], m[1][3], m[2][3]];
    (Parts { translation, rotation, scale, shear }, mirrored)
}

/// The direction of `v` across the axes before it; None if nothing but round-off is left.
#[inline(always)]
fn across<T: Real>(v: Vec3<T>, before: &[Option<Vec3<T>>; 3]) -> Option<Vec3<T>> {
    if v.to_array() == [T::zero(); 3] {
        return None;
    }
    let mut unit = v.normalize();
    // Twice: the first pass leaves an error of a rounding unit over what is left.
    for _ in 0..2 {
        let mut rest = unit;
        for axis in before.iter().flatten() {
            rest = rest - *axis * axis.dot(rest);
        }
        if rest.length() <= T::of(4.0) * T::EPSILON {
            return None;
        }
        unit = rest.normalize();
    }
    Some(unit)
}

/// Axes that are open are chosen near the coordinate axes, so that the frame is right-handed.
#[inline(always)]
fn complete<T: Real>(axes: [Option<Vec3<T>>; 3]) -> [Vec3<T>; 3] {
    let unit = |i: usize| Vec3::from(std::array::from_fn(|k| if k == i { T::one() } else { T::zero() }));
    match axes {
        [Some(x), Some(y), Some(z)] => [x, y, z],
        [None, None, None] => [unit(0), unit(1), unit(2)],
        [Some(x), Some(y), None] => [x, y, x.cross(y)],
        [Some(x), None, Some(z)] => [x, z.cross(x), z],
        [None, Some(y), Some(z)] => [y.cross(z), y, z],
        _ => {
            let i = axes.iter().position(|a| a.is_some()).unwrap_or(0);
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let given = axes[i].unwrap_or(unit(i));
            let off = |e: usize| unit(e) - given * given.to_array()[e];
            let mut frame = [given; 3];
            // The coordinate axis that the given one is less parallel to.
            if given.to_array()[j].abs() <= given.to_array()[k].abs() {
                frame[j] = off(j).normalize();
                frame[k] = given.cross(frame[j]);
            } else {
                frame[k] = off(k).normalize();
                frame[j] = frame[k].cross(given);
            }
            frame
        }
    }
}
