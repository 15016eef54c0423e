//! Whitted's ray tracing: mirrors and glass by recursion, hard shadows, nothing by chance.
//!
//! At each surface every light is asked once (an area light at its middle) and casts a sharp shadow, also through glass.
//! Smooth metals, smooth interfaces and materials of roughness 0 send a reflected ray, interfaces a refracted one too, in
//! proportion to Fresnel; rough mirrors show the lights alone. Light that diffusers send each other is not there.
//!
//! T. Whitted, *An improved illumination model for shaded display*, 1980; R. A. Hall, D. P. Greenberg, *A testbed for
//! realistic image synthesis*, 1983 (the cutoff).

use super::recursion::{Options, Sample, Stage, Tracer, polished};
use super::surface::Spot;
use crate::accel::Ray;
use crate::brdf::Bsdf;
use crate::brdf::fresnel::schlick_weight;
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use crate::vec::Vec3;

pub struct Whitted<'a, T> {
    pub stage: Stage<'a, T>,
    pub options: Options,
}

/// A ray to be followed.
struct Branch<T> {
    ray: Ray<T>,
    carried: Vec3<T>,
    depth: u32,
}

impl<T: Real> Whitted<'_, T> {
    /// The reflected and the refracted direction, with the part of the light that each brings.
    #[inline(always)]
    fn split(&self, site: &Spot<T>) -> [Option<(Vec3<T>, Vec3<T>)>; 2] {
        let (zero, wo) = (T::zero(), site.wo);
        match &site.bsdf {
            Bsdf::MetallicRoughness(lobes) if polished(lobes) => {
                let weight = schlick_weight(wo.z);
                let share = lobes.f0.map(
                    #[inline(always)]
                    |f0| f0 + (lobes.f90 - f0) * weight,
                );
                [Some((Vec3::new(-wo.x, -wo.y, wo.z), share)), None]
            }
            bsdf if bsdf.is_smooth() => {
                // The draws at both ends of the choice: what one brings on average is its weight times its chance.
                let reflected = bsdf.sample(wo, [zero; 3]);
                let passed = bsdf.sample(wo, [zero, zero, T::one().next_down()]);
                let passed = passed.filter(
                    #[inline(always)]
                    |d| (d.wi.z > zero) != (wo.z > zero),
                );
                [reflected, passed].map(
                    #[inline(always)]
                    |draw| {
                        draw.map(
                            #[inline(always)]
                            |d| (d.wi, d.weight * d.pdf),
                        )
                    },
                )
            }
            _ => [None, None],
        }
    }

    /// The BSDF without perfect mirrors.
    #[inline(always)]
    fn rough(&self, site: &Spot<T>, wi: Vec3<T>) -> Vec3<T> {
        match &site.bsdf {
            Bsdf::MetallicRoughness(lobes) if polished(lobes) => {
                lobes.diffuse * (lobes.transmitted(wi.z) * lobes.transmitted(site.wo.z) / T::PI)
            }
            bsdf => bsdf.eval(wi, site.wo),
        }
    }
}

impl<T: Real> Tracer<T> for Whitted<'_, T> {
    #[inline(always)]
    fn radiance<S: Simd>(&self, s: S, ray: Ray<T>, _: Sample) -> Vec3<T> {
        let (stage, half) = (&self.stage, T::of(0.5));
        let mut sum = Vec3::splat(T::zero());
        let mut stack = vec![Branch { ray, carried: Vec3::splat(T::one()), depth: 0 }];
        while let Some(Branch { ray, carried, depth }) = stack.pop() {
            let (hit, copy) = stage.closest_hit(s, &ray);
            if let Some(radiance) = stage.beyond(&ray, &hit, T::INFINITY) {
                sum = sum + carried.times(radiance);
                continue;
            }
            let Some(site) = stage.scene.at(&hit, copy, ray.direction.into()) else { continue };
            let emission = stage.scene.emission[stage.scene.row_of(hit.face as usize, copy)];
            sum = sum + carried.times(emission.into());
            for source in 0..stage.scene.lights.len() {
                let light = stage.lit(
                    s,
                    &site,
                    source,
                    [half; 4],
                    #[inline(always)]
                    |wi, _| self.rough(&site, wi) * wi.z.abs(),
                );
                sum = sum + carried.times(light);
            }
            if depth == self.options.max_depth {
                continue;
            }
            for (wi, share) in self.split(&site).into_iter().flatten() {
                let carried = carried.times(share);
                let most = Lanes::max(Lanes::max(carried.x, carried.y), carried.z);
                if most.to_f64() > self.options.cutoff
                    && let Some(ray) = stage.onward(&site, wi)
                {
                    stack.push(Branch { ray, carried, depth: depth + 1 });
                }
            }
        }
        sum
    }
}
