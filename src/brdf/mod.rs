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
//! - `microfacets`, `beckmann`: facets, and the normals of them that are seen
//! - [`conductor`], [`dielectric`]: smooth metal, smooth glass
//! - [`rough_conductor`], [`rough_dielectric`]: both of microscopic facets
//! - [`metallic_roughness`]: the material of real-time shading and path tracing alike
//! - [`specular_glossiness`]: its sibling, and the way between both
//! - [`kulla_conty`]: rough metal, and [`metallic_roughness`], with the light of further bounces
//! - [`compensated_glass`]: rough glass with that light
//! - [`principled`]: the artist's model of film
//! - [`Bsdf`]: any of them, as kernels hold it

mod arrays;
mod beckmann;
mod bsdf;
pub mod compensated_glass;
mod compensated_lobes;
mod compensated_principled;
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
mod one_metal;
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

use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// Whether no light is reflected between the two: either is at or below the horizon. False for NaN, which then
/// travels on.
#[inline(always)]
fn apart<V: Lanes>(wi: Vec3<V>, wo: Vec3<V>) -> V::Mask {
    let zero = wi.z.num(0.0);
    wi.z.less_eq(zero) | wo.z.less_eq(zero)
}

/// NaN unless `x` is in [0, 1].
#[inline(always)]
fn in_unit<V: Lanes>(x: V) -> V {
    let inside = x.num(0.0).less_eq(x) & x.less_eq(x.num(1.0));
    V::select(inside, x, x.like(V::Elem::NAN))
}

/// Components of a colour, NaN unless in [0, 1].
#[inline(always)]
pub fn color<V: Lanes>(c: [V; 3]) -> Vec3<V> {
    Vec3::new(in_unit(c[0]), in_unit(c[1]), in_unit(c[2]))
}

/// `f` but for directions below the horizon, where there is nothing.
#[inline(always)]
fn above<V: Lanes>(wi: Vec3<V>, wo: Vec3<V>, f: Vec3<V>) -> Vec3<V> {
    let (apart, zero) = (apart(wi, wo), wi.z.num(0.0));
    Vec3::new(V::select(apart, zero, f.x), V::select(apart, zero, f.y), V::select(apart, zero, f.z))
}
