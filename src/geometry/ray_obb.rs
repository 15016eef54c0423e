//! A ray against an oriented box `center + x · axes` with `|x| <= half_extents`, the axes orthonormal rows: the slab test
//! in the box's frame. The distances of the slabs from the origin, and the speeds towards them, are right to two units of
//! the last place, whatever cancels in them, so that boxes far from the scene's or the ray's origin keep their size.
//!
//! T. Akenine-Möller, E. Haines, *Real-Time Rendering*, section "Ray/Box Intersection".

use super::ray_aabb::{Crossing, common};
use crate::math::exact::{all_finite, dot, exponent, largest, total, two_difference, two_product};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// One ray against one box. NaN or infinity, a negative half extent or a direction of no length give NaN.
#[inline(always)]
pub fn ray_obb<T: Real>(
    origin: Vec3<T>,
    direction: Vec3<T>,
    center: Vec3<T>,
    axes: [Vec3<T>; 3],
    half: [T; 3],
    t_min: T,
    t_max: T,
) -> Crossing<T> {
    let longest = largest(direction);
    let mut proper = all_finite(origin) & all_finite(direction) & all_finite(center);
    for i in 0..3 {
        proper &= all_finite(axes[i]) & half[i].is_finite() & (half[i] >= T::zero());
    }
    if !proper || longest < T::MIN_POSITIVE || t_min.is_nan() || t_max.is_nan() {
        return Crossing::NAN;
    }
    let e = exponent(longest);
    let d = direction * T::exp2i(-e);
    let offset = center.zip(origin, |c, o| two_difference(c, o));
    let (mut near, mut far, mut empty) = ([-T::INFINITY; 3], [T::INFINITY; 3], false);
    let mut forward = [true; 3];
    for i in 0..3 {
        // The slab's lower and upper face, as seen from the origin along its axis.
        let [x, y, z] = axes[i].zip(offset, |a, w| (two_product(a, w.0), a * w.1)).to_array();
        let border = |h: T| total([x.0.0, y.0.0, z.0.0, h, x.0.1, y.0.1, z.0.1, x.1, y.1, z.1]);
        let (low, high, speed) = (border(-half[i]), border(half[i]), dot(axes[i], d));
        forward[i] = speed > T::zero();
        if speed != T::zero() {
            let (a, b) = (low / speed, high / speed);
            (near[i], far[i]) = (Lanes::min(a, b), Lanes::max(a, b));
        } else if low > T::zero() || high < T::zero() {
            empty = true;
            (near[i], far[i]) = (T::INFINITY, -T::INFINITY);
        }
    }
    common(near, far, forward, (-e, t_min, t_max), |enter, exit| !empty && enter <= exit)
}
