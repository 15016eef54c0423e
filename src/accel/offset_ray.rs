//! Origins moved off their surface, so far that the ray cannot meet the face that it starts on.
//!
//! Let `M` be the largest coordinate of the face's vertices in magnitude, `u` the unit round-off, `n` the unit normal, and
//! the ray leave on the side to which the origin was moved by `h`. The origin lies above the face's plane by at least `h`
//! less 12.2 uM, the error of a point interpolated by weights (7 uM on each axis, the three weights' own rounding
//! included), and 1.8 uM, the rounding of the move. The watertight test sees the ray pass, at a depth `z` along its dominant
//! axis, within 14 uM of a point of the face on each of the other two axes (see [`super::ray`], distances being at most
//! 2M): 19.8 uM in all. So `z (n · d) < 0` if `h` exceeds the sum; and the computed `z`, which is off by at most 10 uM, has the
//! sign of `z` if it exceeds it by 17.4 uM more, since `|n · d| <= √3` where the dominant component is one. Altogether
//! 51.2 uM; `h = 64 uM` leaves a fifth for normals that are not quite perpendicular.
//!
//! After M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 4th edition, 2023, section 6.8; the bound for
//! Woop's test is derived here.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::vec::Vec3;

/// In units of the largest coordinate: 64 unit round-offs, which is 32 times the distance from one to the next number.
#[inline(always)]
pub fn offset<T: Real>(extent: T) -> T {
    T::of(32.0) * T::EPSILON * extent.abs()
}

/// The origin for a ray that leaves `point` along `direction`, on the side of the face that it leaves to.
#[inline(always)]
pub fn offset_ray<T: Real>(point: Vec3<T>, normal: Vec3<T>, direction: Vec3<T>, extent: T) -> Vec3<T> {
    let h = offset(extent);
    // A direction within the plane leaves on the normal's side.
    let h = if normal.dot(direction) < T::zero() { -h } else { h };
    point + normal * h
}

/// [`offset_ray`] over arrays; without directions, to the normal's side. One extent for all, or each its own.
pub fn offset_ray_many<T: Real>(
    watch: &mut dyn Watch,
    points: &[[T; 3]],
    normals: &[[T; 3]],
    directions: Option<&[[T; 3]]>,
    extents: &[T],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (points, normals, out),
        1 << 14,
        |first, (points, normals, out)| dispatch!(_s => body(first, points, normals, directions, extents, out)),
    )
}

#[inline(always)]
fn body<T: Real>(
    first: usize,
    points: &[[T; 3]],
    normals: &[[T; 3]],
    directions: Option<&[[T; 3]]>,
    extents: &[T],
    out: &mut [[T; 3]],
) {
    for i in 0..out.len() {
        let direction = directions.map_or(normals[i], |d| d[first + i]);
        let extent = if extents.len() == 1 { extents[0] } else { extents[first + i] };
        out[i] = offset_ray(points[i].into(), normals[i].into(), direction.into(), extent).to_array();
    }
}
