//! Reflection models: evaluation, sampling, density. Directions are unit, leave the surface, and stand in the local
//! frame whose z is the normal.
//!
//! - [`fresnel`]: reflectance of clear bodies and metals, and Schlick's
//! - [`lambert`]: the perfect diffuser
//! - [`ggx`]: rough mirrors
//! - [`conductor`], [`dielectric`]: smooth metal, smooth glass
//! - [`rough_conductor`], [`rough_dielectric`]: both of microscopic facets
//! - [`metallic_roughness`]: the material of real-time shading and path tracing alike
//! - [`Bsdf`]: any of them, as kernels hold it

mod arrays;
mod bsdf;
pub mod conductor;
pub mod dielectric;
pub mod fresnel;
pub mod ggx;
pub mod lambert;
pub mod metallic_roughness;
pub(crate) mod microfacets;
mod model;
pub mod rough_conductor;
pub mod rough_dielectric;

pub use arrays::{Draws, Rows, eval_many, pdf_many, sample_many};
pub use bsdf::Bsdf;
pub use model::{Draw, Model, Row, WIDTH};

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
