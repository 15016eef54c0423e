//! The unit square onto the hemisphere about z, areas in constant proportion: the disk bent up.
//!
//! P. Shirley, K. Chiu, *A low distortion map between disk and square*, 1997.

use super::disk::{self, Method};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// Height 1 − r² over a point of the disk at distance r: the height comes from the radius before rounding, so that none
/// sinks below the horizon.
#[inline(always)]
pub fn square_to_hemisphere<V: Lanes>(u: [V; 2], method: Method) -> Vec3<V> {
    let ([x, y], depth) = disk::point_and_depth(u, method);
    let wide = (depth.num(1.0) + depth).sqrt();
    Vec3::new(x * wide, y * wide, depth)
}

/// The inverse of [`square_to_hemisphere`] for unit directions above the horizon, in [0, 1).
#[inline(always)]
pub fn hemisphere_to_square<T: Real>(d: Vec3<T>, method: Method) -> [T; 2] {
    let wide = (T::one() + d.z).sqrt();
    disk::disk_to_square([d.x / wide, d.y / wide], method)
}

/// The density per solid angle of a unit direction: 1 / 2π, zero below the horizon.
#[inline(always)]
pub fn square_to_hemisphere_pdf<T: Real>(d: Vec3<T>) -> T {
    let even = T::one() / (T::of(2.0) * T::PI) + (d.x + d.y + d.z) * T::zero();
    if d.z < T::zero() { T::zero() } else { even }
}
