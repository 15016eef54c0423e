//! Path tracing: every light path up to a number of reflections, by chance, without bias.
//!
//! At each surface every light is asked directly (next-event estimation), and the path goes on in a direction of the
//! material. Area lights and emitting faces can be reached in both ways, which the power heuristic weighs. From the
//! fourth reflection on, paths that carry little end by Russian roulette. Rectangles are seen from the side that
//! shines, and stop the path there; from behind they are not there, and they shade nothing. Surfaces have two sides.
//! The pixel is a box: samples are even over it. Random numbers come from pixel, sample and seed alone.
//!
//! J. T. Kajiya, *The rendering equation*, 1986; E. Veach, *Robust Monte Carlo methods for light transport
//! simulation*, 1997, chapters 9 and 10.

use super::emitters::brightness;
use super::surface::Spot;
use super::{Pinhole, Surfaces, Tally, leave};
use crate::accel::Ray;
use crate::dispatch;
use crate::light::Light;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::sampling::generator::Generator;
use crate::sampling::triangle::{Method, square_to_triangle};
use crate::simd::Simd;
use crate::vec::Vec3;

/// How a picture is sampled.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    pub width: usize,
    /// Samples `start` … `start + samples` of every pixel.
    pub samples: u32,
    pub start: u32,
    /// The most reflections of a path; 0 shows emission alone, 1 direct light.
    pub max_depth: u32,
    pub seed: u64,
}

/// Reflections before paths may end by chance.
const ROULETTE_FROM: u32 = 3;

/// The weight of the strategy whose density is `own`, against the `other`'s (power heuristic).
#[inline(always)]
fn weight<T: Real>(own: T, other: T) -> T {
    // By the quotient: squares of large densities overflow.
    let ratio = other / own;
    T::one() / (T::one() + ratio * ratio)
}

/// Light that arrives at a surface if nothing is in between.
struct Arrival<T> {
    wi: Vec3<T>,
    distance: T,
    /// Radiance over density, or irradiance.
    value: Vec3<T>,
    /// Infinite where the material cannot find the light itself.
    pdf: T,
}

/// A path under way.
struct Path<'a, 'b, T> {
    scene: &'a Surfaces<'b, T>,
    random: Generator,
    pixel: u64,
    sample: u32,
    max_depth: u32,
}

impl<T: Real> Path<'_, '_, T> {
    /// Four random numbers for this depth: block 0 is the direction's, the others the lights'.
    #[inline(always)]
    fn random(&self, depth: u32, block: usize) -> [T; 4] {
        let blocks = 2 + self.scene.lights.len();
        self.random.quad(self.pixel, self.sample, 1 + depth * blocks as u32 + block as u32)
    }

    /// The radiance that arrives against `ray`.
    #[inline(always)]
    fn trace<S: Simd>(&self, s: S, mut ray: Ray<T>) -> Vec3<T> {
        let scene = self.scene;
        let (zero, one) = (T::zero(), T::one());
        let (mut sum, mut carried) = (Vec3::splat(zero), Vec3::splat(one));
        // The density with which the last direction was drawn; infinite from the eye, where nothing else draws.
        let mut pdf = T::INFINITY;
        for depth in 0.. {
            let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
            let hit = scene.bvh.closest_hit(s, &ray);
            if let Some((radiance, other)) = self.rect_before(origin, direction, hit.t) {
                return sum + carried.times(radiance) * weight(pdf, other);
            }
            if !hit.is_hit() {
                return sum + carried.times(scene.background);
            }
            let Some(spot) = scene.at(&hit, direction) else { return sum };
            if brightness(spot.emission) > 0.0 {
                let other = self.emitter_pdf(&spot, hit.t, direction);
                sum = sum + carried.times(spot.emission.into()) * weight(pdf, other);
            }
            if depth == self.max_depth {
                return sum;
            }
            sum = sum + carried.times(self.lights(s, &spot, depth));

            // Go on in a direction of the material.
            let u = self.random(depth, 0);
            let wi = spot.lobes.sample(spot.wo, [u[0], u[1], u[2]]);
            let out = spot.frame.world(wi);
            pdf = spot.lobes.pdf(wi, spot.wo);
            if !(wi.z > zero && pdf > zero && out.dot(spot.normal) > zero) {
                return sum;
            }
            carried = carried.times(spot.lobes.eval(wi, spot.wo)) * (wi.z / pdf);
            let largest = Lanes::max(Lanes::max(carried.x, carried.y), carried.z);
            if depth >= ROULETTE_FROM {
                let survival = Lanes::min(largest, T::of(0.95));
                if u[3] >= survival {
                    return sum;
                }
                carried = carried * (one / survival);
            } else if !(largest > zero) {
                return sum;
            }
            ray = leave(spot.point, spot.normal, out, scene.offset, T::INFINITY);
        }
        sum
    }

    /// The nearest rectangle that shines against the ray before `t`: its radiance and the density of drawing it.
    #[inline(always)]
    fn rect_before(&self, origin: Vec3<T>, direction: Vec3<T>, t: T) -> Option<(Vec3<T>, T)> {
        let mut nearest = (t, None);
        for light in self.scene.lights {
            if let Light::Rect(rect) = light
                && let Some(sighting) = rect.meet(origin, direction)
                && sighting.distance < nearest.0
            {
                nearest = (sighting.distance, Some((rect.radiance, sighting.pdf)));
            }
        }
        nearest.1
    }

    /// The density per solid angle with which an emitting point is drawn from `distance` away.
    #[inline(always)]
    fn emitter_pdf(&self, spot: &Spot<T>, distance: T, direction: Vec3<T>) -> T {
        let per_area = T::of(brightness(spot.emission) / self.scene.emitters.total());
        distance * (distance * per_area / direction.dot(spot.normal).abs())
    }

    /// Light from all lights and from emitting faces, reflected once.
    #[inline(always)]
    fn lights<S: Simd>(&self, s: S, spot: &Spot<T>, depth: u32) -> Vec3<T> {
        let lights = self.scene.lights;
        let mut sum = Vec3::splat(T::zero());
        // One loop, so that the traversal is compiled once: the emitting faces come last.
        for k in 0..=lights.len() {
            let arrival = match lights.get(k) {
                Some(Light::Rect(rect)) => {
                    let u = self.random(depth, 1 + k);
                    rect.sample(spot.point, [u[0], u[1]]).map(|sighting| Arrival {
                        wi: sighting.wi,
                        distance: sighting.distance,
                        value: rect.radiance * (T::one() / sighting.pdf),
                        pdf: sighting.pdf,
                    })
                }
                Some(light) => light.beam(spot.point).map(|beam| Arrival {
                    wi: beam.wi,
                    distance: beam.distance,
                    value: beam.irradiance,
                    pdf: T::INFINITY,
                }),
                None if self.scene.emitters.is_empty() => None,
                None => self.emitter(spot, self.random(depth, 1 + k)),
            };
            if let Some(arrival) = arrival {
                sum = sum + self.reflected(s, spot, &arrival);
            }
        }
        sum
    }

    /// Light from one emitting face.
    #[inline(always)]
    fn emitter(&self, spot: &Spot<T>, u: [T; 4]) -> Option<Arrival<T>> {
        let scene = self.scene;
        let face = scene.emitters.draw(u[0].to_f64());
        let [a, b, c] = scene.corners(face);
        let [v, w] = square_to_triangle([u[1], u[2]], Method::Fold);
        let point = a * (T::one() - v - w) + b * v + c * w;
        let emission = scene.emission[scene.material_ids[face] as usize];
        let to = point - spot.point;
        let wi = to.normalize();
        let distance = to.dot(wi);
        let cos_light = (b - a).cross(c - a).normalize().dot(wi).abs();
        let per_area = T::of(brightness(emission) / scene.emitters.total());
        let pdf = distance * (distance * per_area / cos_light);
        // The ray ends before the emitter by as much as it starts above the surface, seen at the emitter's angle.
        let end = distance - (scene.offset + scene.offset) / cos_light;
        let value = Vec3::from(emission) * (T::one() / pdf);
        let seen = pdf > T::zero() && pdf.is_finite() && end > T::zero();
        seen.then_some(Arrival { wi, distance: end, value, pdf })
    }

    /// What the surface reflects of light that arrives, unless something is in between.
    #[inline(always)]
    fn reflected<S: Simd>(&self, s: S, spot: &Spot<T>, light: &Arrival<T>) -> Vec3<T> {
        let none = Vec3::splat(T::zero());
        let local = spot.frame.local(light.wi);
        if !(local.z > T::zero() && light.wi.dot(spot.normal) > T::zero()) {
            return none;
        }
        let f = spot.lobes.eval(local, spot.wo).times(light.value) * local.z;
        let share =
            if light.pdf.is_finite() { weight(light.pdf, spot.lobes.pdf(local, spot.wo)) } else { T::one() };
        let ray = leave(spot.point, spot.normal, light.wi, self.scene.offset, light.distance);
        if self.scene.bvh.any_hit(s, &ray) { none } else { f * share }
    }
}

/// Mean radiance of each pixel and the variance of that mean, row by row.
pub fn path_trace<T: Real>(
    watch: &mut dyn Watch,
    scene: &Surfaces<'_, T>,
    camera: &Pinhole<T>,
    options: Options,
    mean: &mut [[T; 3]],
    variance: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    // About 10 ms of paths.
    let piece = (8192 / options.samples.max(1) as usize).clamp(1, 256);
    parallel::for_each(
        watch,
        (mean, variance),
        piece,
        |first, (mean, variance)| dispatch!(s => body(s, scene, camera, options, first, mean, variance)),
    )
}

#[inline(always)]
fn body<T: Real, S: Simd>(
    s: S,
    scene: &Surfaces<'_, T>,
    camera: &Pinhole<T>,
    options: Options,
    first: usize,
    mean: &mut [[T; 3]],
    variance: &mut [[T; 3]],
) {
    let random = Generator::new(options.seed);
    for k in 0..mean.len() {
        let pixel = first + k;
        let (column, row) = (T::of((pixel % options.width) as f64), T::of((pixel / options.width) as f64));
        let mut tally = Tally::default();
        for sample in options.start..options.start + options.samples {
            let path = Path { scene, random, pixel: pixel as u64, sample, max_depth: options.max_depth };
            let u: [T; 4] = random.quad(path.pixel, sample, 0);
            let direction = camera.direction(column + u[0], row + u[1]);
            tally.add(path.trace(s, Ray::new(camera.eye.to_array(), direction.to_array())));
        }
        (mean[k], variance[k]) = (tally.mean.map(T::of), tally.variance().map(T::of));
    }
}
