//! The unit square onto the unit sphere: equal heights bound equal areas (Archimedes), and the radius of a parallel comes
//! from the distances to both poles, not from the height.
//!
//! Archimedes, *On the Sphere and Cylinder*; P. Shirley, *Nonuniform random point sets via warping*, 1992.

use super::{below_one, in_square};
use crate::math;
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// Height 1 − 2u, azimuth 2πv.
#[inline(always)]
pub fn square_to_sphere<V: Lanes>(u: [V; 2]) -> Vec3<V> {
    let (one, two, [u, v]) = (u[0].num(1.0), u[0].num(2.0), in_square(u));
    // From the nearer end of the turn: small angles round less.
    let turn = V::select(v.num(0.5).less(v), v - one, v);
    let (sin, cos) = math::sin_cos_turns(turn);
    let r = two * (u * (one - u)).sqrt();
    Vec3::new(r * cos, r * sin, one - two * u)
}

/// The inverse of [`square_to_sphere`] for unit directions, in [0, 1).
#[inline(always)]
pub fn sphere_to_square<T: Real>(d: Vec3<T>) -> [T; 2] {
    let (one, half) = (T::one(), T::of(0.5));
    let squared = d.x * d.x + d.y * d.y;
    // (1 - z) / 2 without its cancellation at the upper pole.
    let u = if d.z > T::zero() { half * squared / (one + d.z) } else { half * (one - d.z) };
    let turn = math::atan2(d.y, d.x) / (T::of(2.0) * T::PI);
    let v = if turn < T::zero() { turn + one } else { turn };
    below_one([u, v])
}

/// The density per solid angle, 1 / 4π everywhere.
#[inline(always)]
pub fn square_to_sphere_pdf<T: Real>(d: Vec3<T>) -> T {
    T::one() / (T::of(4.0) * T::PI) + (d.x + d.y + d.z) * T::zero()
}
