//! Paths that are traced together: all their rays of a depth in one batch, then what they meet, then all shadow rays.
//!
//! The queues are kept from wave to wave, so that memory does not grow with samples. What a path collects depends on
//! its own random numbers alone, and sums are added in the order of the queue: no bit depends on threads.
//!
//! S. Laine, T. Karras, T. Aila, *Megakernels considered harmful: wavefront path tracing on GPUs*, 2013.

use super::draws::Draws;
use super::lighting::{Lighting, weight};
use super::path_trace::{Options, Strategy};
use super::surface::Spot;
use super::{Surfaces, leave};
use crate::accel::{Hit, Ray};
use crate::brdf::{Bsdf, Draw};
use crate::light::Light;
use crate::math;
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use crate::vec::Vec3;

/// Which pair of random numbers of a surface is for what.
pub mod purpose {
    /// Of the camera's: place in the pixel; place on the lens; time.
    pub const PIXEL: u32 = 0;
    pub const LENS: u32 = 1;
    pub const TIME: u32 = 2;
    /// The direction in which the path goes on.
    pub const DIRECTION: u32 = 3;
    /// Which lobe of the material, and whether the path ends.
    pub const CHOICE: u32 = 4;
    /// Which source of light, and which of its faces.
    pub const SOURCE: u32 = 5;
    /// The point of the light; one more for every further source.
    pub const LIGHT: u32 = 6;
    /// Pairs a depth, if no more than one source is asked.
    pub const EACH: u32 = 4;
}

/// A path under way, beside its ray.
#[derive(Clone, Copy, Debug)]
pub struct Path<T> {
    /// Which of the wave's.
    pub slot: u32,
    /// Value over density so far.
    pub carried: Vec3<T>,
    /// With which the ray's direction was drawn; infinite where nothing else finds what it meets.
    pub pdf: T,
    /// Undoes what interfaces did to radiance, which says nothing of the light to come.
    pub scale: T,
    /// Shading normal of where the ray starts; zero where light comes from both sides.
    pub normal: Vec3<T>,
}

/// The queues.
pub struct Wave<T> {
    pub rays: Vec<Ray<T>>,
    pub paths: Vec<Path<T>>,
    pub hits: Vec<Hit<T>>,
    /// Which copy of a mesh each hit is of, -1 for none; empty where there are no copies.
    pub copies: Vec<i32>,
    /// Those of the next depth.
    pub next_rays: Vec<Ray<T>>,
    pub next_paths: Vec<Path<T>>,
    pub shadow_rays: Vec<Ray<T>>,
    /// What each shadow ray carries if nothing is in its way, to which slot, from which source.
    pub carried: Vec<(Vec3<T>, u32, u32)>,
    blocked: Vec<bool>,
    /// Paths that met diffusers, and those that met other materials.
    diffuse: Vec<u32>,
    other: Vec<u32>,
    /// Rays that met nothing, where there is a panorama.
    pub sky: Vec<u32>,
    /// Of each slot: its key, its sample, the radiance so far.
    pub keys: Vec<u32>,
    pub samples: Vec<u32>,
    pub sums: Vec<Vec3<T>>,
}

impl<T: Real> Wave<T> {
    /// With room for so many paths.
    pub fn new(paths: usize) -> Self {
        Wave {
            rays: Vec::with_capacity(paths),
            paths: Vec::with_capacity(paths),
            hits: Vec::with_capacity(paths),
            copies: Vec::new(),
            next_rays: Vec::with_capacity(paths),
            next_paths: Vec::with_capacity(paths),
            shadow_rays: Vec::with_capacity(paths),
            carried: Vec::with_capacity(paths),
            blocked: Vec::with_capacity(paths),
            diffuse: Vec::with_capacity(paths),
            other: Vec::new(),
            sky: Vec::new(),
            keys: Vec::with_capacity(paths),
            samples: Vec::with_capacity(paths),
            sums: Vec::with_capacity(paths),
        }
    }

    /// Makes room for new paths.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
        self.keys.clear();
        self.samples.clear();
        self.sums.clear();
    }

    /// Which copy of a mesh a hit is of.
    #[inline(always)]
    pub fn copy(&self, i: usize) -> i32 {
        if self.copies.is_empty() { -1 } else { self.copies[i] }
    }

    /// Adds the path of the next slot, whose key and sample are there.
    #[inline(always)]
    pub fn start(&mut self, ray: Ray<T>) {
        let slot = self.sums.len() as u32;
        let one = Vec3::splat(T::one());
        self.rays.push(ray);
        let normal = Vec3::splat(T::zero());
        self.paths.push(Path { slot, carried: one, pdf: T::INFINITY, scale: T::one(), normal });
        self.sums.push(Vec3::splat(T::zero()));
    }
}

/// What all waves of a picture share.
pub struct Tracer<'a, T> {
    pub scene: &'a Surfaces<'a, T>,
    pub lighting: &'a Lighting<T>,
    /// Rows of materials that are perfect diffusers.
    pub diffuse: &'a [bool],
    pub draws: Draws,
    pub options: Options,
}

impl<T: Real> Tracer<'_, T> {
    /// Follows all paths of the wave to their ends.
    #[inline(always)]
    pub fn trace<S: Simd>(&self, s: S, wave: &mut Wave<T>) {
        for depth in 0..=self.options.max_depth {
            if wave.rays.is_empty() {
                return;
            }
            wave.hits.resize(wave.rays.len(), Hit::miss());
            if self.scene.copies.is_some() {
                wave.copies.resize(wave.rays.len(), -1);
            }
            self.scene.closest_hits(s, &wave.rays, &mut wave.hits, &mut wave.copies);
            self.collect(s, wave, depth);
            if depth == self.options.max_depth {
                return;
            }
            wave.next_rays.clear();
            wave.next_paths.clear();
            wave.shadow_rays.clear();
            wave.carried.clear();
            self.diffuse(s, wave, depth);
            self.others(wave, depth);
            self.shadows(s, wave);
            std::mem::swap(&mut wave.rays, &mut wave.next_rays);
            std::mem::swap(&mut wave.paths, &mut wave.next_paths);
        }
    }

    /// The share of light that a direction of density `own` found, where the light's own draws have density `other`.
    #[inline(always)]
    pub fn found(&self, own: T, other: T) -> T {
        match self.options.strategy {
            Strategy::Mis => weight(own, other),
            Strategy::Light if own.is_finite() => T::zero(),
            _ => T::one(),
        }
    }

    /// The emission that rays meet; sorts the surfaces that go on.
    #[inline(always)]
    fn collect<S: Simd>(&self, s: S, wave: &mut Wave<T>, depth: u32) {
        let scene = self.scene;
        wave.diffuse.clear();
        wave.other.clear();
        wave.sky.clear();
        let before = depth.saturating_sub(1);
        for i in 0..wave.rays.len() {
            let copy = wave.copy(i);
            let (ray, hit, path) = (&wave.rays[i], wave.hits[i], wave.paths[i]);
            let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
            let sum = &mut wave.sums[path.slot as usize];
            if let Some((source, met)) = self.lighting.standing.nearest(scene.lights, ray, hit.t) {
                let radiance = scene.lights[source].shown(origin, &met);
                let share =
                    self.found(path.pdf, met.pdf * self.lighting.chance(source, origin, path.normal, before));
                *sum = *sum + path.carried.times(radiance) * share;
            } else if hit.is_hit() {
                let row = scene.row_of(hit.face as usize, copy);
                // Copies emit nothing.
                if copy < 0
                    && let Some((radiance, other)) =
                        scene.glow(self.lighting, hit.face as usize, ray, path.normal, hit.t, before)
                {
                    *sum = *sum + path.carried.times(radiance) * self.found(path.pdf, other);
                }
                if self.diffuse[row] { wave.diffuse.push(i as u32) } else { wave.other.push(i as u32) }
            } else if hit.t == T::INFINITY {
                let arrives = self.beyond(origin, direction, &path, before);
                *sum = *sum + path.carried.times(arrives);
                if scene.environment.is_some() {
                    wave.sky.push(i as u32);
                }
            }
        }
        if let Some(sky) = scene.environment {
            self.look_up(s, sky, wave, before);
        }
    }

    /// Radiance from where nothing is but a panorama, weighed.
    #[inline(always)]
    fn beyond(&self, origin: Vec3<T>, direction: Vec3<T>, path: &Path<T>, before: u32) -> Vec3<T> {
        let mut sum = self.scene.background;
        for &k in self.lighting.ambient() {
            let light = &self.scene.lights[k as usize];
            if let Light::Ambient { radiance } = light {
                let chance = self.lighting.chance(k as usize, origin, path.normal, before);
                sum = sum + *radiance * self.found(path.pdf, light.pdf(origin, direction) * chance);
            }
        }
        sum
    }

    /// Surfaces of all materials, one at a time.
    #[inline(always)]
    fn others(&self, wave: &mut Wave<T>, depth: u32) {
        for q in 0..wave.other.len() {
            let i = wave.other[q] as usize;
            let (direction, path) = (Vec3::from(wave.rays[i].direction), wave.paths[i]);
            let Some(spot) = self.scene.at(&wave.hits[i], wave.copy(i), direction) else { continue };
            self.ask_lights(wave, &spot, path, depth);
            self.go_on(wave, &spot, path, depth);
        }
    }

    /// Which of the path's pairs is for a purpose at a depth.
    #[inline(always)]
    pub fn pair(&self, depth: u32, purpose: u32) -> u32 {
        purpose + depth * (purpose::EACH + self.lighting.asked().saturating_sub(1))
    }

    /// Shadow rays to the lights.
    #[inline(always)]
    fn ask_lights(&self, wave: &mut Wave<T>, spot: &Spot<T>, path: Path<T>, depth: u32) {
        let lighting = self.lighting;
        if lighting.sources() == 0 || spot.bsdf.is_smooth() {
            return;
        }
        let (key, sample) = (wave.keys[path.slot as usize], wave.samples[path.slot as usize]);
        let [choice, pick] = self.draws.pair::<T>(key, sample, self.pair(depth, purpose::SOURCE));
        // Where rays to the side that is seen start.
        let from = spot.point + spot.normal * self.scene.offset;
        let (range, chance) = if lighting.asks_all(depth) {
            (0..lighting.sources(), T::one())
        } else {
            let Some((source, chance)) = lighting.draw(from, spot.side(), choice) else { return };
            (source..source + 1, chance)
        };
        let first = range.start;
        for source in range {
            let pair = self.pair(depth, purpose::LIGHT + (source - first) as u32);
            let light = match self.scene.environment {
                Some(sky) if source == lighting.sky() => {
                    self.ask_sky_for(sky, spot, (key, sample, pair), pick, chance)
                }
                _ => {
                    let u = self.draws.pair(key, sample, pair);
                    self.scene.arrival(lighting, source, spot.point, pick, u)
                }
            };
            let Some(light) = light else { continue };
            let beam = !light.pdf.is_finite();
            if !beam && !self.options.strategy.asks_lights() {
                continue;
            }
            let local = spot.frame.local(light.wi);
            if !spot.agrees(local, light.wi) {
                continue;
            }
            let share = if beam || self.options.strategy == Strategy::Light {
                T::one()
            } else {
                weight(light.pdf * chance, self.direction_pdf(spot, local))
            };
            let f = spot.bsdf.eval(local, spot.wo).times(light.value) * (local.z.abs() * share / chance);
            let value = path.carried.times(f);
            if value != Vec3::splat(T::zero()) {
                let ray = leave(spot.point, spot.normal, light.wi, self.scene.offset, light.distance);
                wave.shadow_rays.push(ray);
                wave.carried.push((value, path.slot, source as u32));
            }
        }
    }

    /// The next direction.
    #[inline(always)]
    fn go_on(&self, wave: &mut Wave<T>, spot: &Spot<T>, path: Path<T>, depth: u32) {
        let (zero, one) = (T::zero(), T::one());
        let (key, sample) = (wave.keys[path.slot as usize], wave.samples[path.slot as usize]);
        let u: [T; 2] = self.draws.pair(key, sample, self.pair(depth, purpose::DIRECTION));
        let [lobe, fate] = self.draws.pair::<T>(key, sample, self.pair(depth, purpose::CHOICE));
        let mut lobe = lobe;
        let mut half = one;
        let mut uniform = self.options.strategy == Strategy::Uniform && !spot.bsdf.is_smooth();
        let mixed = uniform && partly_smooth(&spot.bsdf);
        if mixed {
            // What no direction finds is drawn by the material, and only that: half of the time, so twice as much.
            (lobe, half) = (lobe + lobe, one + one);
            uniform = lobe < one;
            lobe = if uniform { lobe } else { lobe - one };
        }
        let draw = if uniform {
            let mut wi = uniform_hemisphere(u[0], u[1]);
            if spot.bsdf.transmits() && lobe < T::of(0.5) {
                wi = -wi;
            }
            let pdf = self.direction_pdf(spot, wi);
            let weight = spot.bsdf.eval(wi, spot.wo) * (wi.z.abs() / pdf);
            Some(Draw { wi, weight, pdf, specular: false, eta: one })
        } else {
            spot.bsdf.sample(spot.wo, [u[0], u[1], lobe])
        };
        let Some(mut draw) = draw else { return };
        if mixed {
            if !uniform && !draw.specular {
                return;
            }
            draw.weight = draw.weight * half;
        }
        let out = spot.frame.world(draw.wi);
        if !(draw.pdf > zero && spot.agrees(draw.wi, out)) {
            return;
        }
        let (carried, scale) = (path.carried.times(draw.weight), path.scale * draw.eta * draw.eta);
        let survival = self.survival(carried * scale, depth);
        if !(fate < survival) {
            return;
        }
        let carried = carried * (one / survival);
        let pdf = if draw.specular { T::INFINITY } else { draw.pdf };
        wave.next_rays.push(leave(spot.point, spot.normal, out, self.scene.offset, T::INFINITY));
        wave.next_paths.push(Path { carried, pdf, scale, normal: spot.side(), ..path });
    }

    /// The density with which the strategy draws a direction.
    #[inline(always)]
    pub fn direction_pdf(&self, spot: &Spot<T>, wi: Vec3<T>) -> T {
        if self.options.strategy != Strategy::Uniform {
            spot.bsdf.pdf(wi, spot.wo)
        } else {
            T::one() / (T::of(if spot.bsdf.transmits() { 4.0 } else { 2.0 }) * T::PI)
        }
    }

    /// The chance with which a path goes on.
    #[inline(always)]
    pub fn survival<V: Lanes<Elem = T>>(&self, carried: Vec3<V>, depth: u32) -> V {
        let largest = carried.x.max(carried.y).max(carried.z);
        let (zero, one) = (largest.num(0.0), largest.num(1.0));
        if depth < self.options.roulette {
            // What carries nothing ends.
            V::select(zero.less(largest), one, zero)
        } else {
            largest.min(one)
        }
    }

    /// Adds what shadow rays carry where nothing is in their way.
    #[inline(always)]
    fn shadows<S: Simd>(&self, s: S, wave: &mut Wave<T>) {
        if wave.shadow_rays.is_empty() {
            return;
        }
        wave.blocked.resize(wave.shadow_rays.len(), false);
        self.scene.bvh.any_hits(s, &wave.shadow_rays, &mut wave.blocked);
        if let Some(copies) = self.scene.copies {
            copies.any_hits(s, &wave.shadow_rays, &mut wave.blocked);
        }
        let standing = &self.lighting.standing;
        for (i, &(value, slot, source)) in wave.carried.iter().enumerate() {
            let ray = &wave.shadow_rays[i];
            if !wave.blocked[i] && !standing.hides(self.scene.lights, ray, source as usize, self.scene.offset)
            {
                let sum = &mut wave.sums[slot as usize];
                *sum = *sum + value;
            }
        }
    }

    /// The queue of diffusers; see [`super::diffuse`].
    #[inline(always)]
    fn diffuse<S: Simd>(&self, s: S, wave: &mut Wave<T>, depth: u32) {
        let queue = std::mem::take(&mut wave.diffuse);
        super::diffuse::shade(s, self, wave, &queue, depth);
        wave.diffuse = queue;
    }
}

/// Whether a material may have a perfect mirror or pane beside what is rough.
#[inline(always)]
fn partly_smooth<T: Real>(bsdf: &Bsdf<T>) -> bool {
    match bsdf {
        Bsdf::Plastic(_) | Bsdf::RoughDielectric(_) | Bsdf::Principled(_) => true,
        // Equal indices pass light straight.
        _ => matches!(bsdf, Bsdf::CompensatedGlass(_) | Bsdf::CompensatedPrincipled(_)),
    }
}

/// A direction about z, evenly over the hemisphere.
#[inline(always)]
pub fn uniform_hemisphere<V: Lanes>(u: V, v: V) -> Vec3<V> {
    let r = ((u.num(1.0) - u) * (u.num(1.0) + u)).sqrt();
    let (sin, cos) = math::sin_cos_turns(v);
    Vec3::new(r * cos, r * sin, u)
}
