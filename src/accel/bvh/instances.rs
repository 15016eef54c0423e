//! Two levels: a tree over placed copies of other trees, which share what they are copies of.
//!
//! A ray is carried into each object's own space, unnormalised, so that `t` stays, and answered there by the object's tree.
//! Equal `t` goes to the lowest instance, then the lowest face. So the answer is that of every instance for itself, to
//! the bit; the upper tree must only never cull a hit.
//!
//! **Why it does not.** Let `M` place an object, `W` be the computed inverse, `κ = ‖M‖ ‖W‖`, `ε` the machine epsilon of the
//! structure and `ε'` that of double precision, in which rays are carried over and then rounded. Origin and direction are off by
//! a few `ε (‖W‖ |o| + |w|)` and `ε |d|`, and where a hit is found, `t |d| <= B + |o|` in the object's space, whose coordinates are
//! at most `B`. With the pads of the object's own slabs (see [`crate::accel::ray`]), which are of that size too, the
//! world's ray is at `t` within `16 (ε + κ ε') ‖M‖ (B + |w| + ‖W‖ |o|)` of the object's box. Boxes are widened by
//! twice the part without `|o|`, and the ray's slabs by twice the part with it.
//!
//! The upper tree is a [`Bvh`] over triangles whose own boxes are those of the instances, so that its walk hands over their numbers.

use super::{Bvh, Method};
use crate::accel::block::Block;
use crate::accel::lists::{OutOfMemory, lists, zeros};
use crate::accel::query::{self, ALL_HITS, Query, Rays, one_or_each};
use crate::accel::ray::ready;
use crate::accel::structure::{Counted, Counter, Stats, Structure, Uncounted, Visit};
use crate::accel::{Hit, Ray};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use std::sync::Arc;

const PIECE: usize = 1024;
/// Twice the bound above.
const SLACK: f64 = 32.0;

/// The upper three rows of an affine matrix.
pub type Affine = [[f64; 4]; 3];

/// An object in its place.
pub struct Instance<T> {
    pub object: Arc<Bvh<T>>,
    pub to_world: Affine,
    pub to_object: Affine,
}

/// Objects in their places, and the tree over them.
pub struct Instances<T> {
    upper: Bvh<T>,
    instances: Vec<Instance<T>>,
    /// How much slabs are widened, times the origin's largest coordinate.
    widening: T,
}

/// The largest sum of a row's magnitudes, of the linear part.
fn norm(m: &Affine) -> f64 {
    m.iter().map(|r| r[0].abs() + r[1].abs() + r[2].abs()).fold(0.0, f64::max)
}

fn largest(v: impl IntoIterator<Item = f64>) -> f64 {
    v.into_iter().fold(0.0, |m, x| m.max(x.abs()))
}

impl<T: Real> Instance<T> {
    /// The error of carrying rays over, as a part of what is carried.
    fn error(&self) -> f64 {
        let condition = norm(&self.to_world) * norm(&self.to_object);
        SLACK * (T::EPSILON.to_f64() + condition * f64::EPSILON)
    }

    /// The box in the world, widened.
    fn bounds(&self) -> [[T; 3]; 2] {
        let [low, high] = self.object.bounds().map(|p| p.map(|x| x.to_f64()));
        let reach = largest(low.into_iter().chain(high)) + largest(self.to_object.map(|r| r[3]));
        let pad = self.error() * (norm(&self.to_world) * reach + largest(self.to_world.map(|r| r[3])));
        let end = |row: &[f64; 4], least: bool| {
            (0..3).fold(row[3], |sum, j| {
                let (a, b) = (row[j] * low[j], row[j] * high[j]);
                sum + if (a < b) == least { a } else { b }
            })
        };
        let low = self.to_world.map(|row| T::of(end(&row, true) - pad));
        [low, self.to_world.map(|row| T::of(end(&row, false) + pad))]
    }

    /// The ray in the object's space.
    #[inline(always)]
    fn carry(&self, ray: &Ray<T>) -> Ray<T> {
        let (o, d) = (ray.origin, ray.direction);
        let mut carried = *ray;
        for (k, m) in self.to_object.iter().enumerate() {
            let linear = |v: [T; 3]| m[0] * v[0].to_f64() + m[1] * v[1].to_f64() + m[2] * v[2].to_f64();
            (carried.origin[k], carried.direction[k]) = (T::of(linear(o) + m[3]), T::of(linear(d)));
        }
        carried
    }
}

/// A ray in the world, and the instance in which it ignores its face; -1 for none.
#[derive(Clone, Copy)]
struct WorldRay<T> {
    ray: Ray<T>,
    ignore_instance: i32,
}

impl<T: Real> WorldRay<T> {
    /// In the space of an instance.
    #[inline(always)]
    fn within(&self, scene: &Instances<T>, number: i32) -> Ray<T> {
        let mut ray = scene.instances[number as usize].carry(&self.ray);
        if number != self.ignore_instance {
            ray.ignore_face = -1;
        }
        ray
    }
}

/// What the walk through the upper tree finds: the nearest hit, or any.
struct Nearest<'a, T: Real, C, const ANY: bool> {
    scene: &'a Instances<T>,
    ray: &'a WorldRay<T>,
    counter: &'a mut C,
    /// In the world's scaled `t`.
    end: T,
    unscale: T,
    hit: Hit<T>,
    instance: i32,
}

impl<T: Real, C: Counter, const ANY: bool> Visit<T> for Nearest<'_, T, C, ANY> {
    #[inline(always)]
    fn end(&self) -> T {
        self.end
    }
    #[inline(always)]
    fn boxes(&mut self, n: usize) {
        self.counter.boxes(n);
    }
    #[inline(always)]
    fn leaf<S: Simd>(&mut self, s: S, blocks: &[Block<T>]) -> bool {
        for number in numbers(blocks) {
            let mut ray = self.ray.within(self.scene, number);
            if self.instance >= 0 {
                // What is as near counts too: the number decides.
                ray.t_max = self.hit.t.next_up();
            }
            let object = &*self.scene.instances[number as usize].object;
            let hit = if C::COUNTS {
                Structure::closest_hit(object, s, &ray, self.counter)
            } else {
                object.closest_hit(s, &ray)
            };
            let nearer = hit.t < self.hit.t || (hit.t == self.hit.t && number < self.instance);
            if hit.is_hit() && (self.instance < 0 || nearer) {
                (self.hit, self.instance, self.end) = (hit, number, hit.t * self.unscale);
                if ANY {
                    return true;
                }
            }
        }
        false
    }
}

/// Every hit.
struct Every<'a, T: Real, C> {
    scene: &'a Instances<T>,
    ray: &'a WorldRay<T>,
    counter: &'a mut C,
    end: T,
    found: &'a mut Vec<(Hit<T>, i32)>,
    buffer: Vec<Hit<T>>,
    full: bool,
}

impl<T: Real, C: Counter> Visit<T> for Every<'_, T, C> {
    #[inline(always)]
    fn end(&self) -> T {
        self.end
    }
    #[inline(always)]
    fn boxes(&mut self, n: usize) {
        self.counter.boxes(n);
    }
    #[inline(always)]
    fn leaf<S: Simd>(&mut self, s: S, blocks: &[Block<T>]) -> bool {
        for number in numbers(blocks) {
            let ray = self.ray.within(self.scene, number);
            let object = &*self.scene.instances[number as usize].object;
            self.buffer.clear();
            let met = Structure::all_hits(object, s, &ray, self.counter, &mut self.buffer);
            if met.is_err() || self.found.try_reserve(self.buffer.len()).is_err() {
                self.full = true;
                return true;
            }
            self.found.extend(self.buffer.iter().map(|&hit| (hit, number)));
        }
        false
    }
}

/// The instances that leaves of the upper tree hold.
#[inline(always)]
fn numbers<T>(blocks: &[Block<T>]) -> impl Iterator<Item = i32> {
    blocks.iter().flat_map(|b| b.faces).filter(|&f| f >= 0)
}

/// Where hits of instances go.
pub struct Found<'a, T> {
    pub hits: crate::accel::query::Found<'a, T>,
    pub instance: &'a mut [i32],
}

impl<T: Real> Found<'_, T> {
    #[inline(always)]
    fn put(&mut self, i: usize, (hit, instance): (Hit<T>, i32)) {
        self.hits.put(i, hit);
        self.instance[i] = instance;
    }
}

impl<T: Send> parallel::Pieces for Found<'_, T> {
    fn items(&self) -> usize {
        self.instance.len()
    }
    fn cut(self, at: usize) -> (Self, Self) {
        let ((hits, h2), (instance, i2)) = (self.hits.cut(at), self.instance.split_at_mut(at));
        (Found { hits, instance }, Found { hits: h2, instance: i2 })
    }
}

/// Every hit of every ray, by `t`, instance and face.
pub struct AllHits<T> {
    pub hits: query::AllHits<T>,
    pub instance: Vec<i32>,
}

/// Rays in the world. The instances in which their faces are ignored are one for all, or one a ray.
#[derive(Clone, Copy)]
pub struct WorldRays<'a, T> {
    pub rays: Rays<'a, T>,
    pub ignore_instance: &'a [i32],
}

impl<T: Real> WorldRays<'_, T> {
    #[inline(always)]
    fn get(&self, i: usize) -> WorldRay<T> {
        WorldRay { ray: self.rays.get(i), ignore_instance: one_or_each(self.ignore_instance, i) }
    }
}

impl<T: Real> Instances<T> {
    pub fn new(watch: &mut dyn Watch, instances: Vec<Instance<T>>) -> Result<Self, Interrupted> {
        let positions: Vec<[T; 3]> = instances.iter().flat_map(|i| i.bounds()).collect();
        let faces: Vec<[i32; 3]> = (0..instances.len() as i32).map(|i| [2 * i, 2 * i + 1, 2 * i]).collect();
        let stretch = |i: &Instance<T>| i.error() * norm(&i.to_world) * norm(&i.to_object);
        let widening = T::of(instances.iter().map(stretch).fold(0.0, f64::max));
        Ok(Instances { upper: Bvh::build(watch, &positions, &faces, Method::Sah)?, instances, widening })
    }

    /// Walks the upper tree; None if the ray is none.
    #[inline(always)]
    fn walk<S: Simd, V: Visit<T>>(&self, s: S, ray: &Ray<T>, visit: impl FnOnce(T, T) -> V) -> Option<V> {
        let (mut world, heading) = ready(&self.upper.bounds(), ray)?;
        let [x, y, z] = ray.origin.map(Lanes::abs);
        let pad = self.widening * Lanes::max(x, Lanes::max(y, z));
        for k in 0..3 {
            let pad = if heading.negative[k] == 1 { -pad } else { pad };
            (world.near[k], world.far[k]) = (world.near[k] + pad, world.far[k] - pad);
        }
        let mut visit = visit(world.t_max, T::one() / world.scale);
        Structure::walk(&self.upper, s, &world, heading, &mut visit);
        Some(visit)
    }

    #[inline(never)]
    fn nearest<S: Simd, C: Counter, const ANY: bool>(
        &self,
        s: S,
        ray: &WorldRay<T>,
        counter: &mut C,
    ) -> (Hit<T>, i32) {
        s.vectorize(
            #[inline(always)]
            || {
                let hit = Hit::miss();
                let walked = self.walk(s, &ray.ray, |end, unscale| Nearest::<T, C, ANY> {
                    scene: self,
                    ray,
                    counter,
                    end,
                    unscale,
                    hit,
                    instance: -1,
                });
                walked.map_or((Hit::no_ray(), -1), |v| (v.hit, v.instance))
            },
        )
    }

    /// Appends every hit of a ray.
    #[inline(never)]
    fn every<S: Simd, C: Counter>(
        &self,
        s: S,
        ray: &WorldRay<T>,
        counter: &mut C,
        found: &mut Vec<(Hit<T>, i32)>,
    ) -> Result<(), OutOfMemory> {
        let first = found.len();
        let full = s.vectorize(
            #[inline(always)]
            || {
                let walked = self.walk(s, &ray.ray, |end, _| Every {
                    scene: self,
                    ray,
                    counter,
                    end,
                    found,
                    buffer: Vec::new(),
                    full: false,
                });
                walked.is_some_and(|v| v.full)
            },
        );
        if full {
            return Err(OutOfMemory);
        }
        found[first..].sort_unstable_by(|(a, i), (b, j)| {
            let t = a.t.partial_cmp(&b.t).expect("hits have numbers");
            t.then(i.cmp(j)).then(a.face.cmp(&b.face))
        });
        Ok(())
    }

    /// An object in its place.
    #[inline(always)]
    pub fn get(&self, i: usize) -> &Instance<T> {
        &self.instances[i]
    }

    /// Of all instances; as wide as the tree over them.
    pub fn bounds(&self) -> [[T; 3]; 2] {
        self.upper.bounds()
    }

    /// The nearest hit of one ray, and its instance; -1 for none.
    #[inline(always)]
    pub fn closest_hit<S: Simd>(&self, s: S, ray: &Ray<T>) -> (Hit<T>, i32) {
        self.nearest::<_, _, false>(s, &WorldRay { ray: *ray, ignore_instance: -1 }, &mut Uncounted)
    }

    /// Whether anything is in the way of one ray.
    #[inline(always)]
    pub fn any_hit<S: Simd>(&self, s: S, ray: &Ray<T>) -> bool {
        let ray = WorldRay { ray: *ray, ignore_instance: -1 };
        self.nearest::<_, _, true>(s, &ray, &mut Uncounted).1 >= 0
    }

    pub fn closest_hits(
        &self,
        watch: &mut dyn Watch,
        rays: &WorldRays<T>,
        found: Found<T>,
    ) -> Result<(), Interrupted> {
        parallel::for_each(watch, found, PIECE, |first, mut found| {
            dispatch!(s => for i in 0..found.instance.len() {
                found.put(i, self.nearest::<_, _, false>(s, &rays.get(first + i), &mut Uncounted));
            })
        })
    }

    pub fn any_hits(
        &self,
        watch: &mut dyn Watch,
        rays: &WorldRays<T>,
        out: &mut [bool],
    ) -> Result<(), Interrupted> {
        parallel::for_each(watch, out, PIECE, |first, out: &mut [bool]| {
            dispatch!(s => for (i, out) in out.iter_mut().enumerate() {
                *out = self.nearest::<_, _, true>(s, &rays.get(first + i), &mut Uncounted).1 >= 0;
            })
        })
    }

    pub fn all_hits(
        &self,
        watch: &mut dyn Watch,
        rays: &WorldRays<T>,
        count: usize,
    ) -> Result<Result<AllHits<T>, OutOfMemory>, Interrupted> {
        let all = lists(
            watch,
            count,
            ALL_HITS,
            false,
            |i, found, _| dispatch!(s => self.every(s, &rays.get(i), &mut Uncounted, found)),
        )?;
        let Ok(all) = all else { return Ok(Err(OutOfMemory)) };
        let n = all.total();
        let (Ok(mut hits), Ok(mut instance)) = (query::AllHits::zeros(n), zeros(n)) else {
            return Ok(Err(OutOfMemory));
        };
        let into = Found { hits: hits.places(), instance: &mut instance };
        hits.offsets = all.bring(watch, into, Found::put)?;
        Ok(Ok(AllHits { hits, instance }))
    }

    /// Boxes of both levels and triangles that each ray tests, one ray at a time.
    pub fn counts(
        &self,
        watch: &mut dyn Watch,
        rays: &WorldRays<T>,
        query: Query,
        out: (&mut [i32], &mut [i32]),
    ) -> Result<(), Interrupted> {
        let task = if query == Query::AllHits { ALL_HITS } else { PIECE };
        parallel::for_each(watch, out, task, |first, (boxes, triangles): (&mut [i32], &mut [i32])| {
            let mut found = Vec::new();
            dispatch!(s => for i in 0..boxes.len() {
                let (ray, mut counted) = (rays.get(first + i), Counted::default());
                match query {
                    Query::ClosestHit => drop(self.nearest::<_, _, false>(s, &ray, &mut counted)),
                    Query::AnyHit => drop(self.nearest::<_, _, true>(s, &ray, &mut counted)),
                    Query::AllHits => {
                        // Without memory for one ray's hits the count is of those before.
                        let _ = self.every(s, &ray, &mut counted, &mut found);
                        found.clear();
                    }
                }
                (boxes[i], triangles[i]) = (counted.boxes as i32, counted.triangles as i32);
            })
        })
    }

    /// The size and make of the upper tree, over as many faces as there are instances.
    pub fn stats(&self) -> Stats {
        let placed = self.instances.len() * size_of::<Instance<T>>();
        let upper = Structure::stats(&self.upper);
        Stats { bytes: upper.bytes + placed, ..upper }
    }
}
