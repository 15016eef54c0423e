//! Distributed ray tracing: Whitted's, with rays spread over all that a picture integrates over: the pixel, the lens, the time,
//! the lights' areas, the mirrors' lobes. So come depth of field, motion blur, penumbrae and gloss from one tree.
//!
//! A sample follows one path through the tree: at each surface every light is asked at one point of it, and one ray goes on by
//! the mirror, the gloss or the refraction, drawn in proportion. Light that diffusers send each other is not there; with
//! it this is path tracing.
//!
//! R. L. Cook, T. Porter, L. Carpenter, *Distributed ray tracing*, 1984.

use super::lighting::weight;
use super::recursion::{Options, Sample, Stage, Tracer, polished, purpose};
use super::surface::Spot;
use crate::accel::Ray;
use crate::brdf::Bsdf;
use crate::brdf::fresnel::schlick_weight;
use crate::brdf::ggx;
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use crate::vec::Vec3;

pub struct Distribution<'a, T> {
    pub stage: Stage<'a, T>,
    pub options: Options,
}

/// A direction in which a path goes on.
struct Onward<T> {
    wi: Vec3<T>,
    weight: Vec3<T>,
    /// Infinite if specular.
    pdf: T,
}

/// The share of a light's draw of density `light`, which the path's own draws find with density `own`.
#[inline(always)]
fn share<T: Real>(light: T, own: T) -> T {
    if light.is_finite() { weight(light, own) } else { T::one() }
}

impl<T: Real> Distribution<'_, T> {
    /// The mirror's, the gloss' or the interface's draw; None from diffusers.
    #[inline(always)]
    fn gloss(&self, site: &Spot<T>, u: [T; 3]) -> Option<Onward<T>> {
        let wo = site.wo;
        match &site.bsdf {
            Bsdf::MetallicRoughness(lobes) if polished(lobes) => {
                let grazing = schlick_weight(wo.z);
                let weight = lobes.f0.map(
                    #[inline(always)]
                    |f0| f0 + (lobes.f90 - f0) * grazing,
                );
                Some(Onward { wi: Vec3::new(-wo.x, -wo.y, wo.z), weight, pdf: T::INFINITY })
            }
            Bsdf::MetallicRoughness(lobes) if lobes.is_specular() => {
                let wi = ggx::ggx_sample(wo, [u[0], u[1]], lobes.alpha);
                let pdf = ggx::ggx_pdf(wi, wo, lobes.alpha);
                let there = wi.z > T::zero() && pdf > T::zero();
                there.then(|| Onward { wi, weight: lobes.specular(wi, wo) * (wi.z / pdf), pdf })
            }
            Bsdf::MetallicRoughness(_) | Bsdf::Diffuse(_) => None,
            bsdf => bsdf.sample(wo, u).map(
                #[inline(always)]
                |d| Onward { wi: d.wi, weight: d.weight, pdf: if d.specular { T::INFINITY } else { d.pdf } },
            ),
        }
    }

    /// What the surface makes of light from `wi` that a draw of density `light` found; infinite if the path's own draws
    /// do not find it.
    #[inline(always)]
    fn lit(&self, site: &Spot<T>, wi: Vec3<T>, light: T) -> Vec3<T> {
        let wo = site.wo;
        let f = match &site.bsdf {
            Bsdf::MetallicRoughness(lobes) => {
                let through = lobes.transmitted(wi.z) * lobes.transmitted(wo.z) / T::PI;
                let diffuse = lobes.diffuse * through;
                if polished(lobes) || !lobes.is_specular() {
                    diffuse
                } else {
                    diffuse + lobes.specular(wi, wo) * share(light, ggx::ggx_pdf(wi, wo, lobes.alpha))
                }
            }
            Bsdf::Diffuse(_) => site.bsdf.eval(wi, wo),
            bsdf => bsdf.eval(wi, wo) * share(light, bsdf.pdf(wi, wo)),
        };
        f * wi.z.abs()
    }
}

impl<T: Real> Tracer<T> for Distribution<'_, T> {
    #[inline(always)]
    fn radiance<S: Simd>(&self, s: S, mut ray: Ray<T>, sample: Sample) -> Vec3<T> {
        let stage = &self.stage;
        let sources = stage.lighting.sources();
        let (mut sum, mut carried) = (Vec3::splat(T::zero()), Vec3::splat(T::one()));
        let mut pdf = T::INFINITY;
        for depth in 0..=self.options.max_depth {
            let (hit, copy) = stage.closest_hit(s, &ray);
            if let Some(radiance) = stage.beyond(&ray, &hit, pdf) {
                return sum + carried.times(radiance);
            }
            let Some(site) = stage.scene.at(&hit, copy, ray.direction.into()) else { return sum };
            // Copies emit nothing.
            if copy < 0
                && let Some((emission, other)) = stage.scene.glow(
                    stage.lighting,
                    hit.face as usize,
                    &ray,
                    Vec3::splat(T::zero()),
                    hit.t,
                    depth,
                )
            {
                sum = sum + carried.times(emission) * weight(pdf, other);
            }
            let (base, last) =
                (purpose::FIRST + depth * (sources as u32 + 1), depth == self.options.max_depth);
            for source in 0..sources {
                let light = stage.lit(
                    s,
                    &site,
                    source,
                    sample.quad(base + 1 + source as u32),
                    #[inline(always)]
                    |wi, light| self.lit(&site, wi, if last { T::INFINITY } else { light }),
                );
                sum = sum + carried.times(light);
            }
            if last {
                return sum;
            }
            let [u @ .., _] = sample.quad::<T>(base);
            let Some(onward) = self.gloss(&site, u) else { return sum };
            carried = carried.times(onward.weight);
            let most = Lanes::max(Lanes::max(carried.x, carried.y), carried.z);
            if !(most.to_f64() > self.options.cutoff) {
                return sum;
            }
            let Some(next) = stage.onward(&site, onward.wi) else { return sum };
            (ray, pdf) = (next, onward.pdf);
        }
        sum
    }
}
