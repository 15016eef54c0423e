//! Reflection models: evaluation, sampling, density. Directions are unit, leave the surface, and stand in the local
//! frame whose z is the normal.
//!
//! - [`fresnel`]: reflectance of clear bodies and metals, and Schlick's
//! - [`reflect`]: the mirrored and the refracted direction
//! - [`fresnel_average`]: what an interface reflects of diffuse light
//! - [`lambert`], [`oren_nayar`]: diffusers, smooth and rough
//! - [`phong`]: highlights by powers of cosines
//! - [`plastic`]: a diffuser under a smooth coat
//! - [`ndf`]: distributions of normals beyond GGX's
//! - [`ggx`]: rough mirrors
//! - [`conductor`], [`dielectric`]: smooth metal, smooth glass
//! - [`rough_conductor`], [`rough_dielectric`]: both of microscopic facets
//! - [`metallic_roughness`]: the material of real-time shading and path tracing alike
//! - [`specular_glossiness`]: its sibling, and the way between both
//! - [`kulla_conty`]: rough metal with the light of further bounces
//! - [`principled`]: the artist's model of film
//! - [`Bsdf`]: any of them, as kernels hold it

mod arrays;
mod bsdf;
pub mod conductor;
pub mod dielectric;
pub mod fresnel;
pub mod fresnel_average;
pub mod ggx;
pub mod kulla_conty;
pub mod lambert;
pub mod metallic_roughness;
mod microfacets;
mod model;
pub mod ndf;
pub mod oren_nayar;
pub mod phong;
pub mod plastic;
pub mod principled;
pub mod reflect;
pub mod rough_conductor;
pub mod rough_dielectric;
pub mod specular_glossiness;

pub use arrays::{Draws, Rows, TermColumns, eval_many, pdf_many, sample_many, terms_many};
pub use bsdf::{Bsdf, Terms};
pub use microfacets::{Masking, Microfacets, Shape};
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
