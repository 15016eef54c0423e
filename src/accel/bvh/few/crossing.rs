//! Eight rays of one dominant axis and one triangle: the arithmetic of [`crate::geometry::ray_triangle::watertight`], a
//! step at a time, so that what vertices share is done once.

use super::splat8;
use crate::accel::ray::{Heading, Ready, load8, slabs};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};

/// A vertex in the frames of eight rays: where it lies across, and along the dominant axis.
pub type Seen<T> = [[T; 8]; 3];

/// A vertex in the rays' frame, by the arithmetic of [`watertight`].
#[inline(always)]
pub fn look<T: Real, S: Simd>(s: S, p: &[T; 3], ray: &Ready<T::V8<S>>, heading: Heading) -> Seen<T> {
    let [x, y, z] = heading.order;
    let depth = splat8::<T, S>(s, p[z]) - ray.origin.z;
    let across = splat8::<T, S>(s, p[x]) - ray.origin.x - ray.shear.x * depth;
    let up = splat8::<T, S>(s, p[y]) - ray.origin.y - ray.shear.y * depth;
    [across.to_array(), up.to_array(), depth.to_array()]
}

/// Edge functions, as in `watertight`, which is asked where one is zero; and a number that is negative if two have
/// opposite signs, and zero if one is: also by underflow, which does no harm there.
#[inline(always)]
pub fn edges<T: Real, S: Simd>(s: S, [a, b, c]: [&Seen<T>; 3]) -> ([T::V8<S>; 3], T::V8<S>) {
    let (ax, ay, bx, by) = (load8(s, &a[0]), load8(s, &a[1]), load8(s, &b[0]), load8(s, &b[1]));
    let (cx, cy) = (load8(s, &c[0]), load8(s, &c[1]));
    let (ea, eb, ec) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
    let sides = SimdBase::min(SimdBase::min(ea, eb), ec) * SimdBase::max(SimdBase::max(ea, eb), ec);
    ([ea, eb, ec], sides)
}

/// Where rays cross a triangle's plane, from its edge functions and its corners' depths.
#[inline(always)]
pub fn crossing<T: Real, S: Simd>(
    s: S,
    [ea, eb, ec]: [T::V8<S>; 3],
    [a, b, c]: [&[T; 8]; 3],
    ray: &Ready<T::V8<S>>,
) -> (T::V8<S>, T::V8<S>, T::V8<S>) {
    let det = ea + eb + ec;
    let (w, u, v) = (ea / det, eb / det, ec / det);
    ((w * load8(s, a) + u * load8(s, b) + v * load8(s, c)) * ray.shear.z, u, v)
}

/// Where rays of different signs enter and leave boxes.
#[inline(always)]
pub fn slabs_of<T: Real, S: Simd>(
    s: S,
    lower: [T::V8<S>; 3],
    upper: [T::V8<S>; 3],
    ray: &Ready<T::V8<S>>,
) -> (T::V8<S>, T::V8<S>) {
    let zero = splat8::<T, S>(s, T::zero());
    let (mut near, mut far) = (ray.near, ray.far);
    for k in 0..3 {
        let negative = Lanes::less(ray.inverse[k], zero);
        near[k] = T::V8::<S>::select(negative, upper[k], lower[k]);
        far[k] = T::V8::<S>::select(negative, lower[k], upper[k]);
    }
    slabs(near, far, ray.near, ray.far, ray.inverse)
}
