//! Reflection at a rough surface of mirrors whose slopes follow the GGX distribution of width `alpha`.
//!
//! f = D(h) V(wi, wo) F(wo·h), with V = G / (4 cos θi cos θo). Masking and shadowing are Smith's, height-correlated by
//! default; the separable product of both, common in older code, is darker where both directions graze. Every
//! difference of nearly equal numbers is written as a sum: sines come from components, 1 − cos from sines. Multiple
//! bounces between the mirrors are lost (at alpha = 1 up to 69 % at normal incidence).
//!
//! Directions are drawn in proportion to the normals visible from `wo`; what is reflected below the horizon is part of
//! the density, which integrates to one over the sphere.
//!
//! B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007;
//! E. Heitz, *Understanding the masking-shadowing function in microfacet-based BRDFs*, 2014; J. Dupuy, A. Benyoub,
//! *Sampling visible GGX normals with spherical caps*, 2023.

use super::fresnel::schlick_weight;
pub use super::microfacets::Masking;
use super::microfacets::Microfacets;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// D · V and wo·h; both directions above the horizon.
#[inline(always)]
pub fn distribution_and_visibility<T: Real>(wi: Vec3<T>, wo: Vec3<T>, alpha: T, masking: Masking) -> (T, T) {
    let (facets, half) = (Microfacets::ggx(alpha, masking), wi + wo);
    // Unit directions: (wi + wo)·wo = |wi + wo|² / 2.
    (facets.distribution(half) * facets.visibility(wi, wo, half), T::of(0.5) * half.length_squared().sqrt())
}

/// The BRDF in sr⁻¹, per channel of `f0`; zero unless both directions are above the horizon.
#[inline(always)]
pub fn ggx<T: Real>(wi: Vec3<T>, wo: Vec3<T>, alpha: T, f0: Vec3<T>, masking: Masking) -> Vec3<T> {
    if super::apart(wi, wo) {
        return Vec3::splat(T::zero());
    }
    let (dv, cos_half) = distribution_and_visibility(wi, wo, alpha, masking);
    let weight = schlick_weight(Lanes::min(cos_half, T::one()));
    f0.map(
        #[inline(always)]
        |f0| dv * (f0 + (T::one() - f0) * weight),
    )
}

/// A direction `wi` for `wo` above the horizon, from two numbers of [0, 1); may lie below the horizon.
#[inline(always)]
pub fn ggx_sample<T: Real>(wo: Vec3<T>, u: [T; 2], alpha: T) -> Vec3<T> {
    let half = Microfacets::ggx(alpha, Masking::Separable).sample(wo, u);
    half * (T::of(2.0) * wo.dot(half)) - wo
}

/// The density of [`ggx_sample`] per solid angle of `wi`.
#[inline(always)]
pub fn ggx_pdf<T: Real>(wi: Vec3<T>, wo: Vec3<T>, alpha: T) -> T {
    let half = wi + wo;
    if wo.z <= T::zero() || half.z <= T::zero() {
        return T::zero();
    }
    Microfacets::ggx(alpha, Masking::Separable).density_over_cosine(wo, half) * T::of(0.25)
}

/// [`ggx`] over arrays of equal length; NaN where alpha is not in (0, 1] or f0 not in [0, 1].
pub fn ggx_many<T: Real>(
    watch: &mut dyn Watch,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    alpha: &[T],
    f0: &[[T; 3]],
    masking: Masking,
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (wi, wo, alpha, f0, out), 1 << 13, |_, (wi, wo, alpha, f0, out)| {
        dispatch!(_s => {
            for i in 0..out.len() {
                let f0 = Vec3::from(f0[i]).map(super::in_unit);
                out[i] = ggx(wi[i].into(), wo[i].into(), width(alpha[i]), f0, masking).to_array();
            }
        })
    })
}

/// [`ggx_sample`] over arrays of equal length; NaN where `wo` is below the horizon.
pub fn ggx_sample_many<T: Real>(
    watch: &mut dyn Watch,
    wo: &[[T; 3]],
    u: &[[T; 2]],
    alpha: &[T],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (wo, u, alpha, out), 1 << 13, |_, (wo, u, alpha, out)| {
        dispatch!(_s => {
            for i in 0..out.len() {
                let alpha = if wo[i][2] > T::zero() { width(alpha[i]) } else { T::NAN };
                out[i] = ggx_sample(wo[i].into(), u[i], alpha).to_array();
            }
        })
    })
}

/// [`ggx_pdf`] over arrays of equal length.
pub fn ggx_pdf_many<T: Real>(
    watch: &mut dyn Watch,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    alpha: &[T],
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (wi, wo, alpha, out), 1 << 13, |_, (wi, wo, alpha, out)| {
        dispatch!(_s => {
            for i in 0..out.len() {
                out[i] = ggx_pdf(wi[i].into(), wo[i].into(), width(alpha[i]));
            }
        })
    })
}

/// NaN unless alpha is in (0, 1].
#[inline(always)]
fn width<T: Real>(alpha: T) -> T {
    if alpha > T::zero() && alpha <= T::one() { alpha } else { T::NAN }
}
