//! A bounding volume hierarchy: nodes of eight boxes over blocks of four triangles.

mod boxes;
mod build;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // arrays of points come from Python alone
pub(crate) mod closest;
mod collapse;
mod cut;
mod emit;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // as above
mod every;
mod few;
mod lbvh;
mod node;
mod packet;
mod single;
mod stats;
mod stream;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // as above
pub(crate) mod overlap;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // as above
pub(crate) mod instances;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // as above
mod topology;
mod walk;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // as above
pub(crate) mod winding;

use super::batch::{List, Sink, Source};
use super::block::Block;
use super::{Hit, Ray, bounds, ray};
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::simd::Simd;
use node::{Child, Node};

/// A tree of boxes, eight children a node, over triangles in blocks of four.
pub struct Bvh<T> {
    nodes: Vec<Node<T>>,
    blocks: Vec<Block<T>>,
    /// What rays of a batch that have little in common are traced through instead, if it is not empty.
    few: few::Few<T>,
    bounds: [[T; 3]; 2],
    faces: usize,
}

/// How a tree is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Binned surface area heuristic: the best to trace.
    Sah,
    /// Halves by the order of centres.
    Median,
    /// Morton order: the fastest to build.
    Lbvh,
}

impl<T: Real> Bvh<T> {
    /// More faces than this are not held.
    pub const MAX_FACES: usize = Child::MAX_BLOCKS;

    /// Indices must be in range, coordinates finite, and faces at most [`Self::MAX_FACES`].
    pub fn build(
        watch: &mut dyn Watch,
        positions: &[[T; 3]],
        faces: &[[i32; 3]],
        method: Method,
    ) -> Result<Self, Interrupted> {
        assert!(faces.len() <= Self::MAX_FACES);
        parallel::run_forking(watch, |stop| {
            let scene = bounds::scene_bounds_until(stop, positions, faces);
            let relative = boxes::Relative::to(&scene);
            let wide = match method {
                Method::Lbvh => {
                    let sorted = lbvh::Sorted::new(positions, faces, relative, stop);
                    collapse::collapse(&sorted, sorted.root(), positions, faces, stop)
                }
                Method::Sah | Method::Median => {
                    let split = if method == Method::Sah { build::Split::Sah } else { build::Split::Median };
                    let mut items = boxes::items(positions, faces, relative, stop);
                    let branches = build::binary_tree(&mut items, split, stop);
                    let cuts = collapse::Cuts { items: &items, branches: &branches };
                    collapse::collapse(&cuts, 0, positions, faces, stop)
                }
            };
            let few = few::Few::new(positions, faces);
            Bvh { nodes: wide.nodes, blocks: wide.blocks, few, bounds: scene, faces: faces.len() }
        })
    }

    // The four queries below serve other kernels from inside their dispatch. Each enters the level anew rather than
    // being inlined there, so that traversal is compiled once a level and precision, not once a caller.

    /// The nearest hit of one ray, inside a dispatch.
    #[inline(never)]
    pub fn closest_hit<S: Simd>(&self, s: S, ray: &Ray<T>) -> Hit<T> {
        s.vectorize(
            #[inline(always)]
            || match ray::ready(&self.bounds, ray) {
                None => Hit::no_ray(),
                Some((ready, heading)) => {
                    ready.finish(single::trace::<false, T, S>(s, self, &ready, heading, ray.ignore_face))
                }
            },
        )
    }

    /// Whether anything is hit.
    #[inline(never)]
    pub fn any_hit<S: Simd>(&self, s: S, ray: &Ray<T>) -> bool {
        s.vectorize(
            #[inline(always)]
            || match ray::ready(&self.bounds, ray) {
                None => false,
                Some((ready, heading)) => {
                    single::trace::<true, T, S>(s, self, &ready, heading, ray.ignore_face).is_hit()
                }
            },
        )
    }

    /// The nearest hits of a batch, which should hold at least some hundred rays.
    #[inline(never)]
    pub fn closest_hits<S: Simd>(&self, s: S, rays: &[Ray<T>], hits: &mut [Hit<T>]) {
        s.vectorize(
            #[inline(always)]
            || self.trace_batch::<false, S>(s, rays.len(), List(rays), |i: usize, hit| hits[i] = hit),
        )
    }

    /// Whether each ray of a batch hits anything.
    #[inline(never)]
    pub fn any_hits<S: Simd>(&self, s: S, rays: &[Ray<T>], hits: &mut [bool]) {
        s.vectorize(
            #[inline(always)]
            || {
                self.trace_batch::<true, S>(s, rays.len(), List(rays), |i: usize, hit: Hit<T>| {
                    hits[i] = hit.is_hit()
                })
            },
        )
    }

    /// Hands every ray's hit to `answer`, in whatever order: runs of rays that go alike are traced as packets, the
    /// others in turns.
    #[inline(always)]
    pub(in crate::accel) fn trace_batch<const ANY: bool, S: Simd>(
        &self,
        s: S,
        count: usize,
        rays: impl Source<T>,
        mut answer: impl Sink<T>,
    ) {
        let mut apart: Vec<u32> = Vec::new();
        // Few triangles stop any ray sooner than packets do.
        let packets = if ANY && !self.few.is_empty() { 0 } else { count / packet::SIZE };
        let whole = packets * packet::SIZE;
        for first in (0..whole).step_by(packet::SIZE) {
            match packet::gather(s, self, &rays, first) {
                Some(mut packet) => {
                    packet.trace::<ANY>(s, self);
                    answer.sixteen(first, &packet.hits(s));
                }
                None => apart.extend((first..first + packet::SIZE).map(|i| i as u32)),
            }
        }
        apart.extend((whole..count).map(|i| i as u32));
        if self.few.is_empty() {
            stream::trace::<ANY, T, S, _, _>(s, self, &rays, &apart, &mut answer);
        } else {
            self.few.trace::<ANY, S>(s, &self.bounds, &rays, &apart, &mut answer);
        }
    }

    /// The exact bounds of all triangles: zeros if there are none.
    pub fn bounds(&self) -> [[T; 3]; 2] {
        self.bounds
    }

    /// The number of triangles.
    pub fn faces(&self) -> usize {
        self.faces
    }

    #[inline(always)]
    fn node(&self, child: Child) -> &Node<T> {
        // Sound: inner children of a built tree are indices of its nodes, and it has a root.
        unsafe { self.nodes.get_unchecked(child.index()) }
    }

    #[inline(always)]
    fn run(&self, child: Child) -> &[Block<T>] {
        let (first, count) = child.run();
        // Sound: leaves of a built tree are runs of its blocks.
        unsafe { self.blocks.get_unchecked(first..first + count) }
    }

    /// Asks for what a child refers to before it is needed. Without a branch: whether it is a leaf could not be guessed.
    #[inline(always)]
    fn prefetch(&self, child: Child) {
        let leaf = child.is_leaf();
        let base = if leaf { self.blocks.as_ptr().cast::<u8>() } else { self.nodes.as_ptr().cast::<u8>() };
        let size = if leaf { size_of::<Block<T>>() } else { size_of::<Node<T>>() };
        let place = if leaf { child.run().0 } else { child.index() };
        fetch_lines(base.wrapping_add(place * size), size_of::<Block<T>>().max(size_of::<Node<T>>()));
    }
}

/// Asks for the cache lines of so many bytes; a hint without other effect.
#[inline(always)]
fn fetch_lines(from: *const u8, bytes: usize) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..bytes.div_ceil(64) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // Sound: SSE is part of x86-64, and a prefetch touches no memory as far as the program can tell.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(from.wrapping_add(64 * line).cast::<i8>()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (from, bytes);
}

/// Asks for the cache lines of `x`; a hint without other effect.
#[inline(always)]
fn fetch<X>(x: &X) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..size_of::<X>().div_ceil(64) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // Sound: SSE is part of x86-64, and a prefetch touches no memory as far as the program can tell.
        unsafe { _mm_prefetch::<_MM_HINT_T0>((x as *const X).cast::<i8>().add(64 * line)) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = x;
}
