//! What the tracers before path tracing share: what a ray meets, with its reflection model; light from the lights, with
//! shadows; how samples of a pixel become its tally.

use super::camera::Camera;
use super::draws::Draws;
use super::film::Tally;
use super::filter::Filter;
use super::lighting::{Lighting, weight};
use super::surface::Spot;
use super::{Surfaces, leave};
use crate::accel::{Hit, Ray};
use crate::brdf::metallic_roughness::{Lobes, MIN_ALPHA};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::sampling::sampler::Sampler;
use crate::simd::Simd;
use crate::vec::Vec3;

/// A scene, and all its sources of light.
pub struct Stage<'a, T> {
    pub scene: &'a Surfaces<'a, T>,
    /// Every source is asked.
    pub lighting: &'a Lighting<T>,
}

/// Which four numbers of a sample are for what: the first of all, of each depth, and how many for each source.
pub mod purpose {
    /// Place in the pixel, and on the lens.
    pub const EYE: u32 = 0;
    pub const TIME: u32 = 1;
    pub const FIRST: u32 = 2;
}

/// How a picture is sampled.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    pub width: usize,
    pub samples: u32,
    pub start: u32,
    /// The most mirrors of a path; 0 shows light that comes straight from the lights' first surface.
    pub max_depth: u32,
    pub seed: u64,
    /// Branches that carry less than this are not followed.
    pub cutoff: f64,
}

/// A sample of a pixel.
#[derive(Clone, Copy)]
pub struct Sample {
    draws: Draws,
    key: u32,
    index: u32,
}

impl Sample {
    /// Four independent numbers.
    #[inline(always)]
    pub fn quad<T: Real>(&self, purpose: u32) -> [T; 4] {
        let [a, b] = self.draws.pair(self.key, self.index, 2 * purpose);
        let [c, d] = self.draws.pair(self.key, self.index, 2 * purpose + 1);
        [a, b, c, d]
    }
}

/// A material as rough as nothing: its mirrors are perfect ones.
#[inline(always)]
pub fn polished<T: Real>(lobes: &Lobes<T>) -> bool {
    lobes.alpha <= T::of(MIN_ALPHA) && lobes.is_specular()
}

impl<T: Real> Stage<'_, T> {
    /// The nearest hit, and the copy of a mesh that it is of, -1 for none.
    #[inline(always)]
    pub fn closest_hit<S: Simd>(&self, s: S, ray: &Ray<T>) -> (Hit<T>, i32) {
        let (mut hit, mut copy) = ([self.scene.bvh.closest_hit(s, ray)], [-1]);
        if let Some(copies) = self.scene.copies {
            copies.closest_hits(s, &[*ray], &mut hit, &mut copy);
        }
        (hit[0], copy[0])
    }

    #[inline(always)]
    fn any_hit<S: Simd>(&self, s: S, ray: &Ray<T>) -> bool {
        let mut blocked = [self.scene.bvh.any_hit(s, ray)];
        if let Some(copies) = self.scene.copies {
            copies.any_hits(s, &[*ray], &mut blocked);
        }
        blocked[0]
    }

    /// The ray that leaves a surface along a local direction; None where the face is in the way.
    #[inline(always)]
    pub fn onward(&self, site: &Spot<T>, wi: Vec3<T>) -> Option<Ray<T>> {
        let out = site.frame.world(wi);
        let crosses = (wi.z > T::zero()) != (site.wo.z > T::zero());
        let side = out.dot(site.normal);
        let passes = if crosses { side < T::zero() } else { side > T::zero() };
        passes.then(|| leave(site.point, site.normal, out, self.scene.offset, T::INFINITY))
    }

    /// What a ray sees that meets no surface: a light in front of it, else what is behind all. `own` is the density with
    /// which the ray was drawn, that its share be weighed against the light's own draws; infinite where nothing else
    /// draws. None if the surface is seen.
    #[inline(always)]
    pub fn beyond(&self, ray: &Ray<T>, hit: &Hit<T>, own: T) -> Option<Vec3<T>> {
        let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
        let lights = self.scene.lights;
        if let Some((k, met)) = self.lighting.standing.nearest(lights, ray, hit.t) {
            return Some(lights[k].shown(origin, &met) * weight(own, met.pdf));
        }
        if hit.is_hit() {
            return None;
        }
        let mut ambient = Vec3::splat(T::zero());
        for &k in self.lighting.ambient() {
            if let Some(met) = lights[k as usize].meet(origin, direction) {
                ambient = ambient + lights[k as usize].shown(origin, &met) * weight(own, met.pdf);
            }
        }
        Some(match self.scene.environment {
            Some(sky) => {
                let (radiance, pdf) = sky.eval_and_pdf(direction);
                ambient + radiance * weight(own, pdf)
            }
            None => ambient + self.scene.background,
        })
    }

    /// What a source sends to a surface, times `reflect` of the local direction and of the draw's density, which has the
    /// cosine in it; with shadow.
    #[inline(always)]
    pub fn lit<S: Simd>(
        &self,
        s: S,
        site: &Spot<T>,
        source: usize,
        u: [T; 4],
        reflect: impl Fn(Vec3<T>, T) -> Vec3<T>,
    ) -> Vec3<T> {
        let none = Vec3::splat(T::zero());
        let [a, b, pick, _] = u;
        let Some(light) = self.scene.arrival(self.lighting, source, site.point, pick, [a, b]) else {
            return none;
        };
        let wi = site.frame.local(light.wi);
        let below = wi.z <= T::zero() || light.wi.dot(site.normal) <= T::zero();
        if below && !site.bsdf.transmits() {
            return none;
        }
        let value = reflect(wi, light.pdf).times(light.value);
        if !(Lanes::max(Lanes::max(value.x, value.y), value.z) > T::zero()) {
            return none;
        }
        let ray = leave(site.point, site.normal, light.wi, self.scene.offset, light.distance);
        let hidden = self.lighting.standing.hides(self.scene.lights, &ray, source, self.scene.offset);
        if hidden || self.any_hit(s, &ray) { none } else { value }
    }
}

/// Where samples go, as in [`super::path_trace`].
pub struct Film<'a, T> {
    pub mean: &'a mut [[T; 3]],
    pub variance: &'a mut [[T; 3]],
    pub outliers: &'a mut [i32],
}

/// The radiance that arrives against a ray.
pub trait Tracer<T: Real>: Sync {
    fn radiance<S: Simd>(&self, s: S, ray: Ray<T>, sample: Sample) -> Vec3<T>;
}

/// A picture by one ray after the other.
pub fn picture<T: Real>(
    watch: &mut dyn Watch,
    tracer: &impl Tracer<T>,
    camera: &Camera<T>,
    filter: &Filter,
    options: Options,
    film: Film<'_, T>,
) -> Result<(), Interrupted> {
    // About 10 ms of rays.
    let piece = (4096 / options.samples.max(1) as usize).clamp(1, 256);
    let Film { mean, variance, outliers } = film;
    parallel::for_each(
        watch,
        (mean, variance, outliers),
        piece,
        |first, (mean, variance, outliers)| dispatch!(s => pixels(s, tracer, camera, filter, options, first, Film { mean, variance, outliers })),
    )
}

#[inline(always)]
fn pixels<T: Real, S: Simd>(
    s: S,
    tracer: &impl Tracer<T>,
    camera: &Camera<T>,
    filter: &Filter,
    options: Options,
    first: usize,
    film: Film<'_, T>,
) {
    let half = T::of(0.5);
    let draws = Draws::new(Sampler::Independent { seed: options.seed }, options.seed);
    for k in 0..film.mean.len() {
        let pixel = first + k;
        let (x, y) = (T::of((pixel % options.width) as f64), T::of((pixel / options.width) as f64));
        let (mut tally, key) = (Tally::EMPTY, draws.key(pixel as u32));
        for index in options.start..options.start + options.samples {
            let sample = Sample { draws, key, index };
            let [a, b, lens @ ..] = sample.quad::<T>(purpose::EYE);
            let [dx, dy] = filter.warp([a, b]);
            let [time, ..] = sample.quad::<T>(purpose::TIME);
            let ray = camera.ray(x + half + dx, y + half + dy, lens, time);
            tally.add(tracer.radiance(s, ray, sample));
        }
        (film.mean[k], film.variance[k]) = (tally.mean.map(T::of), tally.variance().map(T::of));
        film.outliers[k] = tally.outliers as i32;
    }
}
