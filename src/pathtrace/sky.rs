//! The panorama of the sky as paths meet it, and as surfaces ask it.
//!
//! A surface that asks for light draws a few directions in proportion to the sky's brightness, and keeps one of them in
//! proportion to what it would bring there: brightness times reflection times cosine, which no table knows. Only that
//! one is looked along for what stands in the way, so shadow rays are spared below the horizon and where little is
//! reflected. What is kept stands for all candidates by their mean.
//!
//! J. Talbot, D. Cline, P. Egbert, *Importance resampling for global illumination*, 2005.

use super::diffuse::{Arrivals, Group, gather, load};
use super::lighting::weight;
use super::path_trace::Strategy;
use super::surface::{Spot, choose};
use super::wave::{Tracer, Wave};
use crate::environment::panorama::Panorama;
use crate::light::Arrival;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crate::vec::Vec3;

/// Directions from which a surface keeps one: on a bunny under a museum two took 30 % off the squared error, four hardly
/// more.
pub const CANDIDATES: u32 = 2;

/// The sample of one candidate: those of one surface follow each other.
#[inline(always)]
fn candidate(sample: u32, m: u32) -> u32 {
    sample.wrapping_mul(CANDIDATES).wrapping_add(m)
}

#[inline(always)]
fn sum<V: Lanes>(v: Vec3<V>) -> V {
    v.x + v.y + v.z
}

/// One kept of those offered so far, in proportion to their weights, by one random number in all.
struct Reservoir<V> {
    total: V,
    u: V,
}

impl<V: Lanes> Reservoir<V> {
    /// Whether the next one replaces what was kept.
    #[inline(always)]
    fn offer(&mut self, weight: V) -> V::Mask {
        let (zero, one) = (weight.num(0.0), weight.num(1.0));
        let total = self.total + weight;
        let share = V::select(zero.less(weight), weight / total, zero);
        let taken = self.u.less(share);
        // What is left of the number is even again.
        let left = V::select(taken, self.u / share, (self.u - share) / (one - share));
        self.u = V::select(zero.less(share), left.min(one), self.u);
        self.total = total;
        taken
    }
}

impl<T: Real> Tracer<'_, T> {
    /// Radiance of the sky along the rays of a queue that met nothing.
    #[inline(always)]
    pub fn look_up<S: Simd>(&self, s: S, sky: &Panorama<T>, wave: &mut Wave<T>, before: u32) {
        let queue = std::mem::take(&mut wave.sky);
        let source = self.lighting.sky();
        let count = T::of(f64::from(CANDIDATES));
        let mut start = 0;
        while start < queue.len() {
            let n = (queue.len() - start).min(8);
            let mut index = [queue[start] as usize; 8];
            for l in 0..n {
                index[l] = queue[start + l] as usize;
            }
            let wi = gather::<T, S>(
                s,
                #[inline(always)]
                |l| wave.rays[index[l]].direction,
            );
            let (radiance, pdf) = sky.look(s, wi);
            let (r, g, b) = (radiance.x.to_array(), radiance.y.to_array(), radiance.z.to_array());
            let pdf = pdf.to_array();
            for l in 0..n {
                let path = &wave.paths[index[l]];
                let chance =
                    self.lighting.chance(source, wave.rays[index[l]].origin.into(), path.normal, before);
                let share = self.found(path.pdf, pdf[l] * chance * count);
                let sum = &mut wave.sums[path.slot as usize];
                *sum = *sum + path.carried.times(Vec3::new(r[l], g[l], b[l])) * share;
            }
            start += n;
        }
        wave.sky = queue;
    }

    /// One direction of the sky for each of eight diffusers, kept of several.
    #[inline(always)]
    pub fn ask_sky<S: Simd>(
        &self,
        s: S,
        sky: &Panorama<T>,
        group: &Group<T::V8<S>>,
        pair: u32,
        pick: &[T; 8],
        chance: T::V8<S>,
    ) -> Arrivals<T::V8<S>> {
        let (zero, infinite) = (chance.num(0.0), chance.like(T::INFINITY));
        let none = Vec3::new(zero, zero, zero);
        let many = chance.num(f64::from(CANDIDATES));
        let mis = self.options.strategy == Strategy::Mis;
        let mut kept = Arrivals { wi: none, distance: infinite, value: none, pdf: infinite, seen: 0 };
        let (mut reservoir, mut goal) = (Reservoir { total: zero, u: load::<T, S>(s, pick) }, zero);
        for m in 0..CANDIDATES {
            let mut samples = group.samples;
            for l in 0..8 {
                samples[l] = candidate(samples[l], m);
            }
            let draw = sky.samples(s, &self.draws.pairs::<T>(&group.keys, &samples, pair));
            let cos = draw.wi.dot(group.frame.z);
            let above = zero.less(cos) & zero.less(draw.wi.dot(group.normal)) & zero.less(draw.pdf);
            let mut target = sum(draw.radiance) * cos;
            if mis {
                let direction_pdf = cos * chance.num(std::f64::consts::FRAC_1_PI);
                target *= weight(draw.pdf * many * chance, direction_pdf);
            }
            let taken = reservoir.offer(Lanes::select(above, target / draw.pdf, zero));
            kept.wi = choose(taken, draw.wi, kept.wi);
            kept.value = choose(taken, draw.radiance, kept.value);
            kept.pdf = Lanes::select(taken, draw.pdf, kept.pdf);
            goal = Lanes::select(taken, target, goal);
        }
        kept.value = kept.value * (reservoir.total / (many * goal));
        kept.pdf *= many;
        kept.seen = T::V8::<S>::bits(zero.less(goal));
        kept
    }

    /// One direction of the sky for a surface of any material, kept of several.
    #[inline(always)]
    pub fn ask_sky_for(
        &self,
        sky: &Panorama<T>,
        spot: &Spot<T>,
        (key, sample, pair): (u32, u32, u32),
        pick: T,
        chance: T,
    ) -> Option<Arrival<T>> {
        let zero = T::zero();
        let many = T::of(f64::from(CANDIDATES));
        let (mut reservoir, mut goal, mut kept) = (Reservoir { total: zero, u: pick }, zero, None);
        for m in 0..CANDIDATES {
            let draw = sky.sample(self.draws.pair(key, candidate(sample, m), pair));
            let local = spot.frame.local(draw.wi);
            if !(draw.pdf > zero && spot.agrees(local, draw.wi)) {
                continue;
            }
            let mut target = sum(spot.bsdf.eval(local, spot.wo).times(draw.radiance)) * local.z.abs();
            if self.options.strategy == Strategy::Mis {
                target *= weight(draw.pdf * many * chance, self.direction_pdf(spot, local));
            }
            if reservoir.offer(target / draw.pdf) {
                (kept, goal) = (Some(draw), target);
            }
        }
        let draw = kept?;
        let value = draw.radiance * (reservoir.total / (many * goal));
        Some(Arrival { wi: draw.wi, distance: T::INFINITY, value, pdf: draw.pdf * many })
    }
}
