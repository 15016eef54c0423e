//! Reflection models: evaluation, sampling, density. Directions are unit, leave the surface, and stand in the local
//! frame whose z is the normal.
//!
//! - [`fresnel`]: Schlick's reflectance
//! - [`lambert`]: the perfect diffuser
//! - [`ggx`]: rough mirrors
//! - [`metallic_roughness`]: the material of real-time shading and path tracing alike

pub mod fresnel;
pub mod ggx;
pub mod lambert;
pub mod metallic_roughness;

use crate::real::Real;
use crate::vec::Vec3;

/// Whether no light is reflected between the two: either is at or below the horizon. False for NaN, which then
/// travels on.
#[inline(always)]
fn apart<T: Real>(wi: Vec3<T>, wo: Vec3<T>) -> bool {
    wi.z <= T::zero() || wo.z <= T::zero()
}

/// NaN unless `x` is in [0, 1].
#[inline(always)]
fn in_unit<T: Real>(x: T) -> T {
    if x >= T::zero() && x <= T::one() { x } else { T::NAN }
}
