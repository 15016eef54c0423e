//! The one protocol of all structures: they say which triangles a ray may meet, nearest first, and everything else
//! follows. The nearest hit, any hit and all hits are three ways to listen to the same walk.
//!
//! A structure is right if its walk hands over every triangle whose own box the ray passes (see [`super::ray`]) before the
//! visitor's end: then its answers are brute force's to the bit. It may hand over others, and one more than once.

use super::batch::{Sink, Source};
use super::block::{self, BLOCK, Block};
use super::lists::OutOfMemory;
use super::met::{Met, settle};
use super::ray::{Heading, Ready, ready};
use super::{Hit, Ray};
use crate::real::Real;
use crate::simd::Simd;

/// Counts what a ray costs.
pub trait Counter {
    const COUNTS: bool;
    /// Boxes, cells or planes tested.
    fn boxes(&mut self, n: usize);
    fn triangles(&mut self, n: usize);
}

/// Costs nothing.
pub struct Uncounted;

impl Counter for Uncounted {
    const COUNTS: bool = false;
    #[inline(always)]
    fn boxes(&mut self, _: usize) {}
    #[inline(always)]
    fn triangles(&mut self, _: usize) {}
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    pub boxes: u32,
    pub triangles: u32,
}

impl Counter for Counted {
    const COUNTS: bool = true;
    #[inline(always)]
    fn boxes(&mut self, n: usize) {
        self.boxes = self.boxes.saturating_add(n as u32);
    }
    #[inline(always)]
    fn triangles(&mut self, n: usize) {
        self.triangles = self.triangles.saturating_add(n as u32);
    }
}

/// What a walk reports to.
pub trait Visit<T: Real> {
    /// What the ray enters later than this need not be visited; may come nearer with every leaf.
    fn end(&self) -> T;
    /// Tells of boxes, cells or planes tested.
    fn boxes(&mut self, n: usize);
    /// Tests triangles; true if nothing more need be visited.
    fn leaf<S: Simd>(&mut self, s: S, blocks: &[Block<T>]) -> bool;
}

/// The size and make of a structure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    pub faces: usize,
    /// Inner nodes; a grid is one.
    pub nodes: usize,
    /// Leaves that hold triangles.
    pub leaves: usize,
    /// Nodes above the deepest leaf.
    pub depth: usize,
    /// Triangles in leaves, each as often as it stands there.
    pub references: usize,
    /// Nodes entered and triangles tested by a line through the scene's box, on average, if nothing stops it.
    pub sah_cost: f64,
    pub bytes: usize,
    /// Filled child slots of a node, and triangles tested together, on average.
    pub children_per_node: f64,
    pub triangles_per_block: f64,
}

/// Faces, or fragments of them, from front to back.
#[derive(Debug, Default)]
pub struct Ordered<T> {
    pub face: Vec<i32>,
    pub corners: Vec<[[T; 3]; 3]>,
    /// Whether a face stands in the list.
    listed: Vec<bool>,
}

impl<T: Real> Ordered<T> {
    pub fn new(faces: usize) -> Self {
        Ordered { face: vec![], corners: vec![], listed: vec![false; faces] }
    }
    /// Appends a whole face, once.
    pub fn whole(&mut self, face: u32, corners: [[T; 3]; 3]) {
        if !std::mem::replace(&mut self.listed[face as usize], true) {
            self.part(face, corners);
        }
    }
    /// Appends a part of a face.
    pub fn part(&mut self, face: u32, corners: [[T; 3]; 3]) {
        self.face.push(face as i32);
        self.corners.push(corners);
    }
}

/// A structure over triangles. What its queries return equals [`super::brute_force`] to the bit.
pub trait Structure<T: Real>: Send + Sync {
    /// The exact bounds of all triangles: zeros if there are none.
    fn bounds(&self) -> [[T; 3]; 2];

    fn stats(&self) -> Stats;

    /// Hands triangles to `visit`, nearest first as far as the structure can tell. Should be `#[inline(always)]`.
    fn walk<S: Simd, V: Visit<T>>(&self, s: S, ray: &Ready<T>, heading: Heading, visit: &mut V);

    /// Faces by their distance from an eye, as far as the structure orders space.
    fn order(&self, _eye: [T; 3]) -> Option<Ordered<T>> {
        None
    }

    /// Rays that a thread takes at a time, some milliseconds' worth.
    fn rays_a_task(&self) -> usize {
        // Enough that the last rays of a task, with ever fewer beside them, do not matter.
        2048
    }

    // The queries enter the level anew rather than being inlined where they are called, so that a walk is compiled once.

    /// The nearest hit of one ray, inside a dispatch.
    #[inline(never)]
    fn closest_hit<S: Simd, C: Counter>(&self, s: S, ray: &Ray<T>, counter: &mut C) -> Hit<T> {
        s.vectorize(
            #[inline(always)]
            || match nearest::<false, T, S, C, Self>(self, s, ray, counter) {
                None => Hit::no_ray(),
                Some((ready, hit)) => ready.finish(hit),
            },
        )
    }

    /// Whether anything is hit.
    #[inline(never)]
    fn any_hit<S: Simd, C: Counter>(&self, s: S, ray: &Ray<T>, counter: &mut C) -> bool {
        s.vectorize(
            #[inline(always)]
            || nearest::<true, T, S, C, Self>(self, s, ray, counter).is_some_and(|(_, hit)| hit.is_hit()),
        )
    }

    /// Appends every hit to `found`, by `t`, then by face, each face once.
    #[inline(never)]
    fn all_hits<S: Simd, C: Counter>(
        &self,
        s: S,
        ray: &Ray<T>,
        counter: &mut C,
        found: &mut Vec<Hit<T>>,
    ) -> Result<(), OutOfMemory> {
        s.vectorize(
            #[inline(always)]
            || every(self, s, ray, counter, found),
        )
    }

    /// Hands every ray's nearest hit to `answer`, in whatever order.
    #[inline(always)]
    fn closest_batch<S: Simd>(&self, s: S, count: usize, rays: impl Source<T>, mut answer: impl Sink<T>) {
        for i in 0..count {
            answer.put(i, self.closest_hit(s, &rays.ray(i), &mut Uncounted));
        }
    }

    /// Hands to `answer` a hit of every ray that hits anything, of which only that it is one counts, in whatever order.
    #[inline(always)]
    fn any_batch<S: Simd>(&self, s: S, count: usize, rays: impl Source<T>, mut answer: impl Sink<T>) {
        for i in 0..count {
            let hit = self.any_hit(s, &rays.ray(i), &mut Uncounted);
            answer.put(i, if hit { Hit { face: 0, ..Hit::miss() } } else { Hit::miss() });
        }
    }

    /// Adds every hit of `count` rays from `first` on to `met`, in whatever order.
    #[inline(always)]
    fn every_batch<S: Simd>(
        &self,
        s: S,
        (first, count): (usize, usize),
        rays: impl Source<T>,
        met: &mut Met<T>,
    ) -> Result<(), OutOfMemory> {
        let mut found = Vec::new();
        for i in first..first + count {
            self.all_hits(s, &rays.ray(i), &mut Uncounted, &mut found)?;
            met.reserve(found.len())?;
            for &hit in &found {
                met.put(i as u32, hit);
            }
            found.clear();
        }
        Ok(())
    }
}

/// Keeps the nearest hit; with `ANY`, stops at the first.
struct Nearest<'a, const ANY: bool, T, C> {
    ray: &'a Ready<T>,
    heading: Heading,
    ignore: i32,
    hit: Hit<T>,
    counter: &'a mut C,
}

#[inline(always)]
fn nearest<const ANY: bool, T: Real, S: Simd, C: Counter, A: Structure<T> + ?Sized>(
    structure: &A,
    s: S,
    ray: &Ray<T>,
    counter: &mut C,
) -> Option<(Ready<T>, Hit<T>)> {
    let (made, heading) = ready(&structure.bounds(), ray)?;
    let ignore = ray.ignore_face;
    let mut visit = Nearest::<ANY, T, C> { ray: &made, heading, ignore, hit: made.unhit(), counter };
    structure.walk(s, &made, heading, &mut visit);
    let hit = visit.hit;
    Some((made, hit))
}

impl<const ANY: bool, T: Real, C: Counter> Visit<T> for Nearest<'_, ANY, T, C> {
    #[inline(always)]
    fn end(&self) -> T {
        self.hit.t
    }
    #[inline(always)]
    fn boxes(&mut self, n: usize) {
        self.counter.boxes(n);
    }
    #[inline(always)]
    fn leaf<S: Simd>(&mut self, s: S, blocks: &[Block<T>]) -> bool {
        count(self.counter, blocks);
        block::leaf::<ANY, T, S>(s, blocks, self.ray, &self.heading, self.ignore, &mut self.hit)
    }
}

/// Keeps every hit.
struct Every<'a, T, C> {
    ray: &'a Ready<T>,
    heading: Heading,
    ignore: i32,
    found: &'a mut Vec<Hit<T>>,
    full: bool,
    counter: &'a mut C,
}

#[inline(always)]
fn every<T: Real, S: Simd, C: Counter, A: Structure<T> + ?Sized>(
    structure: &A,
    s: S,
    ray: &Ray<T>,
    counter: &mut C,
    found: &mut Vec<Hit<T>>,
) -> Result<(), OutOfMemory> {
    let Some((made, heading)) = ready(&structure.bounds(), ray) else { return Ok(()) };
    let first = found.len();
    let ignore = ray.ignore_face;
    let mut visit = Every { ray: &made, heading, ignore, found, full: false, counter };
    structure.walk(s, &made, heading, &mut visit);
    if visit.full {
        return Err(OutOfMemory);
    }
    let kept = settle(&mut found[first..]);
    found.truncate(first + kept);
    Ok(())
}

impl<T: Real, C: Counter> Visit<T> for Every<'_, T, C> {
    #[inline(always)]
    fn end(&self) -> T {
        self.ray.t_max
    }
    #[inline(always)]
    fn boxes(&mut self, n: usize) {
        self.counter.boxes(n);
    }
    #[inline(always)]
    fn leaf<S: Simd>(&mut self, s: S, blocks: &[Block<T>]) -> bool {
        count(self.counter, blocks);
        if self.found.try_reserve(blocks.len() * BLOCK).is_err() {
            self.full = true;
            return true;
        }
        block::all::<T, S>(
            s,
            blocks,
            self.ray,
            &self.heading,
            self.ignore,
            #[inline(always)]
            |hit| self.found.push(self.ray.finish(hit)),
        );
        false
    }
}

#[inline(always)]
fn count<T, C: Counter>(counter: &mut C, blocks: &[Block<T>]) {
    if C::COUNTS {
        counter.triangles(blocks.iter().flat_map(|b| b.faces).filter(|&face| face >= 0).count());
    }
}

/// How likely a line through the scene's box passes a box inside: the ratio of their surfaces.
pub struct Chances(f64);

impl Chances {
    pub fn new<T: Real>(scene: [[T; 3]; 2]) -> Self {
        Chances(half_surface(scene))
    }
    /// One in a scene without surface, all of whose boxes are alike.
    pub fn of<T: Real>(&self, inside: [[T; 3]; 2]) -> f64 {
        if self.0 > 0.0 { half_surface(inside) / self.0 } else { 1.0 }
    }
}

/// Half the surface of a box.
pub fn half_surface<T: Real>(corners: [[T; 3]; 2]) -> f64 {
    let [x, y, z] = std::array::from_fn(|k| (corners[1][k].to_f64() - corners[0][k].to_f64()).max(0.0));
    x * y + y * z + z * x
}
