//! Arrays of rays in, arrays of hits out: cut into pieces for the threads.

use super::lists::{Lists, OutOfMemory, batches, zeros};
use super::met::Met;
use super::squares::{Hits, Stretch, stretches, task};
use super::structure::{Counted, Ordered, Stats, Structure};
use super::{Hit, Ray};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Pieces, Watch};
use crate::real::Real;
use crate::vec::Vec3;
use std::sync::atomic::Ordering;

/// Rays in arrays; intervals and ignored faces are one for all, or one a ray.
#[derive(Clone, Copy)]
pub struct Rays<'a, T> {
    pub origins: &'a [[T; 3]],
    pub directions: &'a [[T; 3]],
    pub t_min: &'a [T],
    pub t_max: &'a [T],
    pub ignore_face: &'a [i32],
    /// The width of the picture whose rows the rays are; 0 if they are none.
    pub width: usize,
}

/// Rays after which a search for every hit can be stopped.
pub const ALL_HITS: usize = 64;

impl<T: Real> Rays<'_, T> {
    #[inline(always)]
    pub fn get(&self, i: usize) -> Ray<T> {
        Ray {
            origin: self.origins[i],
            direction: self.directions[i],
            t_min: one_or_each(self.t_min, i),
            t_max: one_or_each(self.t_max, i),
            ignore_face: one_or_each(self.ignore_face, i),
        }
    }
}

#[inline(always)]
pub fn one_or_each<X: Copy>(list: &[X], i: usize) -> X {
    if list.len() == 1 { list[0] } else { list[i] }
}

/// Where hits go.
pub struct Found<'a, T> {
    pub t: &'a mut [T],
    pub face: &'a mut [i32],
    pub u: &'a mut [T],
    pub v: &'a mut [T],
}

impl<T: Real> Found<'_, T> {
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.t.len()
    }
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }
    #[inline(always)]
    pub fn put(&mut self, i: usize, hit: Hit<T>) {
        (self.t[i], self.face[i], self.u[i], self.v[i]) = (hit.t, hit.face, hit.u, hit.v);
    }
}

impl<T: Send> Pieces for Found<'_, T> {
    fn items(&self) -> usize {
        self.t.len()
    }
    fn cut(self, at: usize) -> (Self, Self) {
        let ((t, t2), (face, face2)) = (self.t.split_at_mut(at), self.face.split_at_mut(at));
        let ((u, u2), (v, v2)) = (self.u.split_at_mut(at), self.v.split_at_mut(at));
        (Found { t, face, u, v }, Found { t: t2, face: face2, u: u2, v: v2 })
    }
}

/// Every hit of every ray: those of ray `i` stand from `offsets[i]` to `offsets[i + 1]`, by `t`, then by face.
#[derive(Debug, Default)]
pub struct AllHits<T> {
    pub offsets: Vec<i64>,
    pub t: Vec<T>,
    pub face: Vec<i32>,
    pub u: Vec<T>,
    pub v: Vec<T>,
}

impl<T: Real> AllHits<T> {
    /// Places for `n` hits, if there is memory for them.
    pub fn zeros(n: usize) -> Result<Self, OutOfMemory> {
        Ok(AllHits { offsets: Vec::new(), t: zeros(n)?, face: zeros(n)?, u: zeros(n)?, v: zeros(n)? })
    }
    pub fn places(&mut self) -> Found<'_, T> {
        Found { t: &mut self.t, face: &mut self.face, u: &mut self.u, v: &mut self.v }
    }
}

/// What [`Queries::counts`] follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    ClosestHit,
    AnyHit,
    AllHits,
}

/// Arrays of rays through any [`Structure`].
pub trait Queries<T: Real>: Send + Sync {
    /// The nearest hits.
    fn closest_hits(&self, watch: &mut dyn Watch, rays: &Rays<T>, found: Found<T>)
    -> Result<(), Interrupted>;
    /// Whether each ray hits anything.
    fn any_hits(&self, watch: &mut dyn Watch, rays: &Rays<T>, out: &mut [bool]) -> Result<(), Interrupted>;
    /// Every hit. Memory is linear in hits, twice over for a moment.
    fn all_hits(
        &self,
        watch: &mut dyn Watch,
        rays: &Rays<T>,
        count: usize,
    ) -> Result<Result<AllHits<T>, OutOfMemory>, Interrupted>;
    /// Boxes and triangles that each ray tests, one ray at a time.
    fn counts(
        &self,
        watch: &mut dyn Watch,
        rays: &Rays<T>,
        query: Query,
        out: (&mut [i32], &mut [i32]),
    ) -> Result<(), Interrupted>;
    /// The structure's size and make.
    fn make(&self) -> Stats;
    /// Faces from front to back.
    fn ordered(&self, eye: [T; 3]) -> Option<Ordered<T>>;
}

impl<T: Real, A: Structure<T>> Queries<T> for A {
    fn closest_hits(
        &self,
        watch: &mut dyn Watch,
        rays: &Rays<T>,
        found: Found<T>,
    ) -> Result<(), Interrupted> {
        parallel::for_each(watch, found, task(self.rays_a_task(), rays.width), |first, mut found| {
            for (start, count, order) in stretches(rays.width, found.len()) {
                let from = Stretch { rays, start: first + start, order };
                let to = Hits { found: &mut found, start, order };
                dispatch!(s => self.closest_batch(s, count, from, to))
            }
        })
    }

    fn any_hits(&self, watch: &mut dyn Watch, rays: &Rays<T>, out: &mut [bool]) -> Result<(), Interrupted> {
        parallel::for_each(watch, out, task(self.rays_a_task(), rays.width), |first, out: &mut [bool]| {
            for (start, count, order) in stretches(rays.width, out.len()) {
                let from = Stretch { rays, start: first + start, order };
                dispatch!(s => self.any_batch(
                    s,
                    count,
                    from,
                    #[inline(always)]
                    |i: usize, hit: Hit<T>| out[start + order.place(i)] = hit.is_hit(),
                ))
            }
        })
    }

    fn all_hits(
        &self,
        watch: &mut dyn Watch,
        rays: &Rays<T>,
        count: usize,
    ) -> Result<Result<AllHits<T>, OutOfMemory>, Interrupted> {
        // Few a task, since a ray may have as many hits as there are faces.
        let piece = task(4 * ALL_HITS, rays.width);
        let all = batches(watch, count, piece, true, |first, numbers, found, stop| {
            let mut met = Met::new();
            for (start, count, order) in stretches(rays.width, numbers.len()) {
                let from = Stretch { rays, start: first + start, order };
                for few in (0..count).step_by(ALL_HITS) {
                    if stop.load(Ordering::Relaxed) {
                        return Ok(());
                    }
                    let range = (few, ALL_HITS.min(count - few));
                    dispatch!(s => self.every_batch(s, range, from, &mut met))?;
                }
                met.bring(|i| order.place(i), &mut numbers[start..start + count], found)?;
            }
            Ok(())
        })?;
        all.map_or_else(|full| Ok(Err(full)), |all| gather(watch, all))
    }

    fn counts(
        &self,
        watch: &mut dyn Watch,
        rays: &Rays<T>,
        query: Query,
        out: (&mut [i32], &mut [i32]),
    ) -> Result<(), Interrupted> {
        parallel::for_each(
            watch,
            out,
            if query == Query::AllHits { ALL_HITS } else { self.rays_a_task() },
            |first, (boxes, triangles): (&mut [i32], &mut [i32])| {
                let mut found = Vec::new();
                dispatch!(s => for i in 0..boxes.len() {
                    let (ray, mut counted) = (rays.get(first + i), Counted::default());
                    match query {
                        Query::ClosestHit => drop(Structure::closest_hit(self, s, &ray, &mut counted)),
                        Query::AnyHit => drop(Structure::any_hit(self, s, &ray, &mut counted)),
                        Query::AllHits => {
                            // Without memory for one ray's hits the count is of those before.
                            let _ = Structure::all_hits(self, s, &ray, &mut counted, &mut found);
                            found.clear();
                        }
                    }
                    (boxes[i], triangles[i]) = (counted.boxes as i32, counted.triangles as i32);
                })
            },
        )
    }

    fn make(&self) -> Stats {
        Structure::stats(self)
    }

    fn ordered(&self, eye: [T; 3]) -> Option<Ordered<T>> {
        self.order(eye)
    }
}

/// Brings the hits of all rays into arrays.
fn gather<T: Real>(
    watch: &mut dyn Watch,
    all: Lists<Hit<T>>,
) -> Result<Result<AllHits<T>, OutOfMemory>, Interrupted> {
    let Ok(mut hits) = AllHits::zeros(all.total()) else { return Ok(Err(OutOfMemory)) };
    hits.offsets = all.bring(watch, hits.places(), Found::put)?;
    Ok(Ok(hits))
}

/// Unit normals by winding of the faces that were hit; NaN where none was, and on faces without area.
pub fn normals<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    hit: &[i32],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (hit, out), 1 << 14, |_, (hit, out): (&[i32], &mut [[T; 3]])| {
        for (out, &face) in out.iter_mut().zip(hit) {
            *out = if face < 0 {
                [T::NAN; 3]
            } else {
                let [a, b, c] = faces[face as usize].map(|i| Vec3::from(positions[i as usize]));
                (b - a).cross(c - a).normalize().to_array()
            };
        }
    })
}
