//! Two vectors: the angle between them, and the part of one along the other.
//!
//! W. Kahan, *How Futile are Mindless Assessments of Roundoff in Floating-Point Computation?*, 2006 (angles).

use crate::math::atan2;
use crate::math::exact::{difference_of_products, exponent, largest};
use crate::real::Real;
use crate::vec::Vec3;

/// The angle in [0, π], from the sine and the cosine: right to a few rounding units of itself however small, where the
/// arc cosine loses half of the digits. NaN where a vector has no direction.
#[inline(always)]
pub fn angle_between<T: Real>(a: Vec3<T>, b: Vec3<T>) -> T {
    let (a, b) = (near_one(a), near_one(b));
    // Cancellation in the cross product is exact: what is left of nearly parallel vectors is their own difference.
    let cross = Vec3::new(
        difference_of_products(a.y, b.z, a.z, b.y),
        difference_of_products(a.z, b.x, a.x, b.z),
        difference_of_products(a.x, b.y, a.y, b.x),
    );
    atan2(length(cross), a.dot(b))
}

/// The vector times a power of two, its largest component near one; NaN for zero.
#[inline(always)]
fn near_one<T: Real>(v: Vec3<T>) -> Vec3<T> {
    let size = largest(v);
    v * if size >= T::MIN_POSITIVE && size.is_finite() { T::exp2i(-exponent(size)) } else { T::NAN }
}

/// The length of any vector, without overflow or underflow on the way.
#[inline(always)]
fn length<T: Real>(v: Vec3<T>) -> T {
    let size = largest(v);
    let v = v.map(|c| c / size);
    if size == T::zero() { size } else { size * v.length() }
}

/// `v` in parts: its signed length along `onto`, the part along it, and the rest, perpendicular to it.
#[inline(always)]
pub fn project_onto<T: Real>(v: Vec3<T>, onto: Vec3<T>) -> (T, Vec3<T>, Vec3<T>) {
    let unit = onto.normalize();
    let along = v.dot(unit);
    let parallel = unit * along;
    (along, parallel, v - parallel)
}
