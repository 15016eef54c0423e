//! The unit square onto the hemisphere about z, in proportion to the cosine: the disk raised to the sphere.
//!
//! The height comes from the radius before it is bent, so that directions near the horizon keep their digits and none
//! sinks below it; the square's border maps to the horizon itself, where the density is zero.
//!
//! Malley's method, in P. Shirley, R. L. Morley, *Realistic Ray Tracing*, 2003.

use super::disk::{self, Method};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[inline(always)]
pub fn square_to_cosine_hemisphere<V: Lanes>(u: [V; 2], method: Method) -> Vec3<V> {
    let ([x, y], depth) = disk::point_and_depth(u, method);
    Vec3::new(x, y, depth.sqrt())
}

/// The inverse of [`square_to_cosine_hemisphere`] for unit directions above the horizon.
#[inline(always)]
pub fn cosine_hemisphere_to_square<T: Real>(direction: Vec3<T>, method: Method) -> [T; 2] {
    disk::disk_to_square([direction.x, direction.y], method)
}

/// The density per solid angle of a unit direction: cos θ / π, zero below the horizon.
#[inline(always)]
pub fn square_to_cosine_hemisphere_pdf<V: Lanes>(direction: Vec3<V>) -> V {
    let (z, zero) = (direction.z, direction.z.num(0.0));
    V::select(z.less(zero), zero, z / z.num(std::f64::consts::PI))
}
