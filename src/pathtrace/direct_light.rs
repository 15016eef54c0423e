//! Light from the lights, reflected once, with shadows: the reference of every shadow technique, at given points.
//!
//! A punctual light takes one shadow ray. An area light takes `samples` points of its area and, where the material has
//! mirrors whose lobe is bright beside it, as many directions of that, weighed by the balance heuristic. Both are Owen-scrambled Sobol' points
//! with a scramble of its own for every receiver, so the error at an edge of shadow falls faster than 1/√samples. A
//! run of samples that goes on where another ended (`start`) extends the same sequence; different seeds are independent.
//! Lights of some size stop the light of others, as in [`super::path_trace`].
//!
//! Sums are in double. The variance is that of independent samples: of scrambled points an upper bound as a rule, so
//! two seeds tell more.
//!
//! E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995; A. B. Owen,
//! *Scrambled net variance for integrals of smooth functions*, 1997.

use super::standing::Standing;
use super::{Tally, leave};
use crate::accel::{Bvh, Ray};
use crate::brdf::ggx;
use crate::dispatch;
use crate::light::unshadowed::{Receiver, Receivers, digits};
use crate::light::{Light, Sighting};
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::sampling::sobol::Scramble;
use crate::simd::Simd;
use crate::vec::Vec3;

/// Which samples are taken.
#[derive(Clone, Copy, Debug)]
pub struct Samples {
    pub count: u32,
    pub start: u32,
    pub seed: u64,
}

/// Samples whose shadow rays are traced together.
const BATCH: usize = 256;

/// What a thread traces with, kept from receiver to receiver.
struct Bench<T> {
    rays: Vec<Ray<T>>,
    /// What each ray carries if nothing is in its way, and which sample of the batch it belongs to.
    carried: Vec<(Vec3<T>, usize)>,
    blocked: Vec<bool>,
}

/// A light among all, which may stand in its way.
#[derive(Clone, Copy)]
struct Asked<'a, T> {
    lights: &'a [Light<T>],
    number: usize,
    standing: &'a Standing<T>,
    /// How far above surfaces rays start.
    offset: T,
}

impl<T: Real> Asked<'_, T> {
    #[inline(always)]
    fn light(&self) -> &Light<T> {
        &self.lights[self.number]
    }
    /// Whether another light stops the ray.
    #[inline(always)]
    fn hidden(&self, ray: &Ray<T>) -> bool {
        self.standing.hides(self.lights, ray, self.number, self.offset)
    }
}

/// A receiver, its geometric normal, and how far above it rays start.
#[derive(Clone, Copy)]
struct Site<T> {
    receiver: Receiver<T>,
    normal: Vec3<T>,
    offset: T,
}

impl<T: Real> Site<T> {
    /// Adds a ray towards a sighted point if the surface reflects it; `both`: the lobe is sampled as well as the light.
    #[inline(always)]
    fn aim(
        &self,
        bench: &mut Bench<T>,
        light: &Light<T>,
        s: &Sighting<T>,
        wi: Vec3<T>,
        sample: usize,
        both: bool,
    ) {
        let r = &self.receiver;
        if wi.z <= T::zero() || s.wi.dot(self.normal) <= T::zero() {
            return;
        }
        let lobe = if both { ggx::ggx_pdf(wi, r.wo, r.lobes.alpha) } else { T::zero() };
        let value = r.lobes.eval(wi, r.wo).times(light.shown(r.point, s)) * (wi.z / (s.pdf + lobe));
        bench.rays.push(leave(r.point, self.normal, s.wi, self.offset, s.distance));
        bench.carried.push((value, sample));
    }

    /// Samples one area light.
    #[inline(always)]
    fn area<S: Simd>(
        &self,
        s: S,
        bvh: &Bvh<T>,
        asked: Asked<'_, T>,
        scramble: &[Scramble; 4],
        digits: &[[u32; 3]],
        bench: &mut Bench<T>,
    ) -> Tally {
        let (r, light, mut tally) = (&self.receiver, asked.light(), Tally::EMPTY);
        let both = r.lobe_matters(light);
        for batch in digits.chunks(BATCH) {
            bench.rays.clear();
            bench.carried.clear();
            for (k, x) in batch.iter().enumerate() {
                let u = [scramble[0].fraction(x[0]), scramble[1].fraction(x[1])];
                if let Some(sighting) = light.sight(r.point, u) {
                    self.aim(bench, light, &sighting, r.frame.local(sighting.wi), k, both);
                }
                if both {
                    let u = [scramble[2].fraction(x[0]), scramble[3].fraction(x[1])];
                    let wi = ggx::ggx_sample(r.wo, u, r.lobes.alpha);
                    if let Some(sighting) = light.meet(r.point, r.frame.world(wi)) {
                        self.aim(bench, light, &sighting, wi, k, both);
                    }
                }
            }
            let mut values = [Vec3::splat(T::zero()); BATCH];
            if !bench.rays.is_empty() {
                bench.blocked.resize(bench.rays.len(), false);
                bvh.any_hits(s, &bench.rays, &mut bench.blocked);
                for (i, &(value, sample)) in bench.carried.iter().enumerate() {
                    if !bench.blocked[i] && !asked.hidden(&bench.rays[i]) {
                        values[sample] = values[sample] + value;
                    }
                }
            }
            values[..batch.len()].iter().for_each(|&x| tally.add(x));
        }
        tally
    }

    /// Light from a punctual light.
    #[inline(always)]
    fn beam<S: Simd>(&self, s: S, bvh: &Bvh<T>, asked: Asked<'_, T>) -> Vec3<T> {
        let none = Vec3::splat(T::zero());
        let Some((radiance, wi, distance)) = self.receiver.beam(asked.light()) else { return none };
        if wi.dot(self.normal) <= T::zero() {
            return none;
        }
        let ray = leave(self.receiver.point, self.normal, wi, self.offset, distance);
        if asked.hidden(&ray) || bvh.any_hit(s, &ray) { none } else { radiance }
    }
}

/// Geometric normals, one each (None: the receivers' own), and how far above the surface rays start.
#[derive(Clone, Copy)]
pub struct Footing<'a, T> {
    pub normals: Option<&'a [[T; 3]]>,
    pub offset: T,
}

/// Radiance towards the eye at each receiver and the variance of that mean; zeros where there is no surface.
pub fn direct_light_many<T: Real>(
    watch: &mut dyn Watch,
    bvh: &Bvh<T>,
    receivers: &Receivers<'_, T>,
    footing: Footing<'_, T>,
    lights: &[Light<T>],
    samples: Samples,
    mean: &mut [[T; 3]],
    variance: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    let digits = digits(samples.start, samples.count);
    let standing = Standing::new(lights);
    // About 10 ms of rays.
    let rays = 2 * digits.len().max(1) * lights.len().max(1);
    parallel::for_each(
        watch,
        (mean, variance),
        (100_000 / rays).clamp(1, 1 << 12),
        |first, (mean, variance)| dispatch!(s => body(s, bvh, receivers, footing, lights, &standing, samples.seed, &digits, first, mean, variance)),
    )
}

#[inline(always)]
fn body<T: Real, S: Simd>(
    s: S,
    bvh: &Bvh<T>,
    receivers: &Receivers<'_, T>,
    footing: Footing<'_, T>,
    lights: &[Light<T>],
    standing: &Standing<T>,
    seed: u64,
    digits: &[[u32; 3]],
    first: usize,
    mean: &mut [[T; 3]],
    variance: &mut [[T; 3]],
) {
    let mut bench = Bench { rays: Vec::new(), carried: Vec::new(), blocked: Vec::new() };
    for k in 0..mean.len() {
        let i = first + k;
        let (mut sum, mut spread) = ([0.0; 3], [0.0; 3]);
        if let Some(receiver) = receivers.at(i) {
            let normal = footing.normals.map_or(receiver.frame.z, |n| n[i].into());
            let site = Site { receiver, normal, offset: footing.offset };
            for (l, light) in lights.iter().enumerate() {
                let asked = Asked { lights, number: l, standing, offset: footing.offset };
                if light.has_area() {
                    let stream = (l as u64) << 40 | i as u64;
                    let scramble = std::array::from_fn(|d| Scramble::new(seed, stream, d as u32));
                    let tally = site.area(s, bvh, asked, &scramble, digits, &mut bench);
                    let of_mean = tally.variance();
                    (0..3)
                        .for_each(|c| (sum[c], spread[c]) = (sum[c] + tally.mean[c], spread[c] + of_mean[c]));
                } else {
                    let radiance = site.beam(s, bvh, asked).to_array();
                    (0..3).for_each(|c| sum[c] += radiance[c].to_f64());
                }
            }
            // A receiver that is NaN anywhere is NaN, though no ray of it reports a hit.
            let nan = (receiver.point + normal + receiver.wo).dot(Vec3::splat(T::zero())).to_f64();
            sum = sum.map(|x| x + nan);
        }
        (mean[k], variance[k]) = (sum.map(T::of), spread.map(T::of));
    }
}
