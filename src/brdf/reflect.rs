//! The directions that a smooth surface sends light in: mirrored, and bent by Snell's law.
//!
//! A. S. Glassner (ed.), *An introduction to ray tracing*, 1989, chapter 2 (by P. S. Heckbert's derivation).

use crate::real::Real;
use crate::vec::Vec3;

/// The mirror image about a unit normal of a direction that leaves the surface.
#[inline(always)]
pub fn reflect<T: Real>(w: Vec3<T>, normal: Vec3<T>) -> Vec3<T> {
    normal * (T::of(2.0) * w.dot(normal)) - w
}

/// Where the light goes that comes along −w, across the surface: `eta` is the index beyond over that on the side of `w`.
/// None where all is reflected. The normal may stand on either side.
#[inline(always)]
pub fn refract<T: Real>(w: Vec3<T>, normal: Vec3<T>, eta: T) -> Option<Vec3<T>> {
    let (zero, one) = (T::zero(), T::one());
    let c = w.dot(normal);
    let squared = (eta - one) * (eta + one) + c * c;
    if squared < zero {
        return None;
    }
    let bent = normal * (c - squared.sqrt().copysign(c)) - w;
    Some(bent * (one / eta))
}
