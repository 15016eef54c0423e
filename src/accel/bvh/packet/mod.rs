//! Sixteen rays that run alike, through the tree together: a node is tested once, by intervals that hold all rays, and a
//! child once more, by the rays themselves; at leaves the lanes are rays, not triangles.
//!
//! Interval bounds follow from the monotone slab arithmetic as the boxes' do (see [`crate::accel::ray`]), so answers are
//! those of single rays to the bit.
//!
//! I. Wald, P. Slusallek, C. Benthin, M. Wagner, *Interactive Rendering with Coherent Ray Tracing*, 2001; S. Boulos
//! et al., *Packet-based Whitted and Distribution Ray Tracing*, 2007, for the intervals.

mod every;
mod gather;

pub use gather::gather;

use super::Bvh;
use super::node::{Child, Entry, Node, Stack, key};
use super::single::{planes, splat8};
use crate::accel::batch::Sixteen;
use crate::accel::block::{BLOCK, Block, splat4};
use crate::accel::ray::{Heading, Ready, load8, slabs};
use crate::geometry::ray_triangle::{Crossing, watertight};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use std::hint::black_box;
use std::sync::atomic::{Ordering, compiler_fence};

/// Rays in a packet: two groups of eight lanes.
pub const SIZE: usize = 16;
const GROUPS: usize = SIZE / 8;

/// The rays, their nearest hits, and the intervals that hold them.
pub struct Packet<T: Real, S: Simd> {
    rays: [Ready<T::V8<S>>; GROUPS],
    heading: Heading,
    /// The faces that rays ignore, if any ignores one.
    ignore: Option<[i32; SIZE]>,
    t: [T::V8<S>; GROUPS],
    u: [T::V8<S>; GROUPS],
    v: [T::V8<S>; GROUPS],
    /// Integers in the low bits; what is hit is what `t` says.
    face: [T::V8<S>; GROUPS],
    /// The origin's extremes that enter earliest and leave latest; the extremes of the reciprocal direction.
    near: [T::V8<S>; 3],
    far: [T::V8<S>; 3],
    inverse: [[T::V8<S>; 3]; 2],
    t_min: T::V8<S>,
}

impl<T: Real, S: Simd> Packet<T, S> {
    /// Traces the rays. Enters the level anew: compiled once for all that gather packets.
    #[inline(never)]
    pub fn trace<const ANY: bool>(&mut self, s: S, tree: &Bvh<T>) {
        s.vectorize(
            #[inline(always)]
            || self.trace_here::<ANY>(s, tree),
        )
    }

    #[inline(always)]
    fn trace_here<const ANY: bool>(&mut self, s: S, tree: &Bvh<T>) {
        black_box(&mut *self);
        let mut end = self.end();
        let (mut turn, mut credit) = (0u32, 0u32);
        let mut stack = Stack::new();
        stack.push(Entry::new(T::zero(), Child::ROOT));
        while let Some(entry) = stack.pop() {
            // Else the compiler would copy the whole packet to other places of the stack before each stretch of nodes.
            compiler_fence(Ordering::SeqCst);
            if entry.after(key(end)) {
                continue;
            }
            let child = entry.child();
            if child.is_leaf() {
                if self.leaf::<ANY>(s, tree.run(child), end) {
                    end = self.end();
                    if ANY && end == -T::INFINITY {
                        return;
                    }
                }
                continue;
            }
            let node = tree.node(child);
            let (mut bits, entries) = self.children(s, node, end);
            let base = stack.len();
            while bits != 0 {
                let i = bits.trailing_zeros() as usize & 7;
                bits &= bits - 1;
                // Rays that go very much alike fill their intervals: then one test in four tells whether it still pays.
                turn = turn.wrapping_add(1);
                if credit > 0 || turn == 4 {
                    let passes = self.any_passes(s, node, i);
                    credit = if passes { credit.saturating_sub(1) } else { 16 };
                    if !passes {
                        continue;
                    }
                }
                stack.insert(base, Entry::new(entries[i], node.children[i]));
            }
        }
    }

    /// The answers.
    #[inline(always)]
    pub fn hits(&self, s: S) -> Sixteen<T> {
        let zero = T::zero();
        let mut hits = Sixteen { t: [zero; SIZE], u: [zero; SIZE], v: [zero; SIZE], face: [-1; SIZE] };
        for g in 0..GROUPS {
            // As in `Ready::finish`. A hit comes before the end.
            let hit = Lanes::less(self.t[g], self.rays[g].t_max);
            let t = self.t[g] * self.rays[g].scale + splat8(s, zero);
            let t = T::V8::<S>::select(hit, t, splat8(s, T::INFINITY));
            let (at, face) = (8 * g..8 * g + 8, self.face[g].to_array());
            hits.t[at.clone()].copy_from_slice(&t.to_array());
            hits.u[at.clone()].copy_from_slice(&self.u[g].to_array());
            hits.v[at].copy_from_slice(&self.v[g].to_array());
            for l in 0..8 {
                hits.face[8 * g + l] = face[l].low_bits();
            }
        }
        hits
    }

    /// The latest end of all rays.
    #[inline(always)]
    fn end(&self) -> T {
        SimdBase::max(self.t[0], self.t[1]).reduce_max()
    }

    /// Children that some ray may pass, as bits, and where none enters earlier.
    #[inline(always)]
    fn children(&self, s: S, node: &Node<T>, end: T) -> (u32, [T; 8]) {
        let (mut entry, mut exit) = (self.t_min, splat8::<T, S>(s, end));
        for k in 0..3 {
            let side = self.heading.negative[k];
            let (least, greatest) = (self.inverse[0][k], self.inverse[1][k]);
            let near = planes(s, node, side, k) - self.near[k];
            let far = planes(s, node, 1 - side, k) - self.far[k];
            entry = SimdBase::max(entry, SimdBase::min(near * least, near * greatest));
            exit = SimdBase::min(exit, SimdBase::max(far * least, far * greatest));
        }
        (T::V8::<S>::bits(Lanes::less_eq(entry, exit)), entry.to_array())
    }

    /// Whether any ray passes the box of child `i` before its hit.
    #[inline(always)]
    fn any_passes(&self, s: S, node: &Node<T>, i: usize) -> bool {
        for g in 0..GROUPS {
            let ray = &self.rays[g];
            let (mut entry, mut exit) = (ray.t_min, self.t[g]);
            for k in 0..3 {
                let side = self.heading.negative[k];
                let near = splat8::<T, S>(s, node.planes[side & 1][k][i & 7]) - ray.near[k];
                let far = splat8::<T, S>(s, node.planes[(1 - side) & 1][k][i & 7]) - ray.far[k];
                entry = SimdBase::max(entry, near * ray.inverse[k]);
                exit = SimdBase::min(exit, far * ray.inverse[k]);
            }
            if T::V8::<S>::bits(Lanes::less_eq(entry, exit)) != 0 {
                return true;
            }
        }
        false
    }

    /// Tests the triangles of a leaf one by one; true if a ray's hit came nearer.
    #[inline(always)]
    fn leaf<const ANY: bool>(&mut self, s: S, blocks: &[Block<T>], end: T) -> bool {
        let mut nearer = false;
        for block in blocks {
            let mut boxes = self.own_boxes(s, block, end);
            while let Some((lane, corners, own)) = boxes.next(s, block, self.heading.order) {
                for g in 0..GROUPS {
                    nearer |= self.triangle::<ANY>(s, g, block.faces[lane], corners, own);
                }
            }
        }
        nearer
    }

    /// The boxes of a block's triangles, by the interval test of [`Self::children`].
    #[inline(always)]
    fn own_boxes(&self, s: S, block: &Block<T>, end: T) -> OwnBoxes<T> {
        let mut boxes = OwnBoxes { bits: 0, near: [[T::zero(); BLOCK]; 3], far: [[T::zero(); BLOCK]; 3] };
        let (mut entry, mut exit) = (splat4::<T, S>(s, self.t_min.as_array()[0]), splat4::<T, S>(s, end));
        for k in 0..3 {
            let [a, b, c] = &block.vertices;
            let (a, b, c) = (load4::<T, S>(s, &a[k]), load4::<T, S>(s, &b[k]), load4::<T, S>(s, &c[k]));
            let (lower, upper) = (Lanes::min(Lanes::min(a, b), c), Lanes::max(Lanes::max(a, b), c));
            let (near, far) = if self.heading.negative[k] == 0 { (lower, upper) } else { (upper, lower) };
            (boxes.near[k], boxes.far[k]) = (near.to_array(), far.to_array());
            let (least, greatest) = (
                splat4::<T, S>(s, self.inverse[0][k].as_array()[0]),
                splat4::<T, S>(s, self.inverse[1][k].as_array()[0]),
            );
            let near = near - splat4::<T, S>(s, self.near[k].as_array()[0]);
            let far = far - splat4::<T, S>(s, self.far[k].as_array()[0]);
            entry = SimdBase::max(entry, SimdBase::min(near * least, near * greatest));
            exit = SimdBase::min(exit, SimdBase::max(far * least, far * greatest));
        }
        boxes.bits = T::V4::<S>::bits(Lanes::less_eq(entry, exit));
        boxes
    }

    /// Where a group of rays crosses a triangle, not after its hits so far. What is raised to its own box's entry may come
    /// after them.
    #[inline(always)]
    fn crossing(
        &self,
        g: usize,
        [a, b, c]: Corners<T, S>,
        [near, far]: [[T::V8<S>; 3]; 2],
    ) -> Option<(<T::V8<S> as Lanes>::Mask, Crossing<T::V8<S>>)> {
        let ray = &self.rays[g];
        let (mask, x) = watertight(ray.origin, ray.shear, a.into(), b.into(), c.into())?;
        let mask = mask & Lanes::less(ray.t_min, x.t) & Lanes::less_eq(x.t, self.t[g]);
        if T::V8::<S>::bits(mask) == 0 {
            return None;
        }
        // The triangle's own box, as in `single::leaf`.
        let (entry, exit) = slabs(near, far, ray.near, ray.far, ray.inverse);
        let mask = mask & Lanes::less_eq(entry, exit) & Lanes::less_eq(ray.t_min, exit);
        Some((mask, Crossing { t: Lanes::max(x.t, entry), ..x }))
    }

    /// Tests a triangle against a group of rays.
    #[inline(always)]
    fn triangle<const ANY: bool>(
        &mut self,
        s: S,
        g: usize,
        face: i32,
        corners: Corners<T, S>,
        own: [[T::V8<S>; 3]; 2],
    ) -> bool {
        let Some((mask, x)) = self.crossing(g, corners, own) else { return false };
        let (t, end) = (x.t, self.t[g]);
        let (better, equal) = (mask & Lanes::less(t, end), mask & t.equal(end));
        if self.ignore.is_some() || T::V8::<S>::bits(equal) != 0 {
            return self.one_by_one::<ANY>(s, g, face, mask & Lanes::less_eq(t, end), x);
        }
        if T::V8::<S>::bits(better) == 0 {
            return false;
        }
        // One hit is enough: before everything, so that the ray meets nothing more.
        let t = if ANY { splat8(s, -T::INFINITY) } else { t };
        self.t[g] = T::V8::<S>::select(better, t, end);
        self.u[g] = T::V8::<S>::select(better, x.u, self.u[g]);
        self.v[g] = T::V8::<S>::select(better, x.v, self.v[g]);
        self.face[g] = T::V8::<S>::select(better, splat8(s, T::of_low_bits(face)), self.face[g]);
        true
    }

    /// Takes the hits of a triangle that may be ignored, or comes as near as another face.
    #[cold]
    #[inline(never)]
    fn one_by_one<const ANY: bool>(
        &mut self,
        s: S,
        g: usize,
        face: i32,
        hit: <T::V8<S> as Lanes>::Mask,
        x: Crossing<T::V8<S>>,
    ) -> bool {
        s.vectorize(
            #[inline(always)]
            || {
                let mut bits = T::V8::<S>::bits(hit);
                let (t, u, v) = (x.t.to_array(), x.u.to_array(), x.v.to_array());
                let (mut end, mut best_u, mut best_v) =
                    (self.t[g].to_array(), self.u[g].to_array(), self.v[g].to_array());
                let mut faces = self.face[g].to_array();
                let mut nearer = false;
                while bits != 0 {
                    let l = bits.trailing_zeros() as usize & 7;
                    bits &= bits - 1;
                    let loses = t[l] == end[l] && face >= faces[l].low_bits();
                    if loses || self.ignore.is_some_and(|ignore| ignore[8 * g + l] == face) {
                        continue;
                    }
                    nearer = true;
                    (best_u[l], best_v[l], faces[l]) = (u[l], v[l], T::of_low_bits(face));
                    end[l] = if ANY { -T::INFINITY } else { t[l] };
                }
                (self.t[g], self.face[g]) = (load8::<T, S>(s, &end), load8::<T, S>(s, &faces));
                (self.u[g], self.v[g]) = (load8::<T, S>(s, &best_u), load8::<T, S>(s, &best_v));
                nearer
            },
        )
    }
}

#[inline(always)]
fn load4<T: Real, S: Simd>(s: S, x: &[T; BLOCK]) -> T::V4<S> {
    SimdBase::load_array_ref(s, x)
}

/// The boxes of a block's triangles: the planes where the rays enter and leave, and which some ray may pass, as bits. No
/// other can be hit. Empty lanes are NaN, which passes nothing.
struct OwnBoxes<T> {
    bits: u32,
    near: [[T; BLOCK]; 3],
    far: [[T; BLOCK]; 3],
}

impl<T: Real> OwnBoxes<T> {
    /// The next triangle that some ray may pass: its lane, its corners and its own box, for every ray.
    #[inline(always)]
    #[allow(clippy::type_complexity)]
    fn next<S: Simd>(
        &mut self,
        s: S,
        block: &Block<T>,
        order: [usize; 3],
    ) -> Option<(usize, Corners<T, S>, [[T::V8<S>; 3]; 2])> {
        if self.bits == 0 {
            return None;
        }
        let lane = self.bits.trailing_zeros() as usize & (BLOCK - 1);
        self.bits &= self.bits - 1;
        let a = broadcast(s, &block.vertices[0], lane, order);
        let b = broadcast(s, &block.vertices[1], lane, order);
        let c = broadcast(s, &block.vertices[2], lane, order);
        let (near, far) = (&self.near, &self.far);
        let own = [
            [splat8(s, near[0][lane]), splat8(s, near[1][lane]), splat8(s, near[2][lane])],
            [splat8(s, far[0][lane]), splat8(s, far[1][lane]), splat8(s, far[2][lane])],
        ];
        Some((lane, [a, b, c], own))
    }
}

/// The corners of one triangle, for every ray.
type Corners<T, S> = [[<T as Real>::V8<S>; 3]; 3];

/// One vertex of one triangle of a block, for every ray.
#[inline(always)]
fn broadcast<T: Real, S: Simd>(s: S, v: &[[T; BLOCK]; 3], lane: usize, order: [usize; 3]) -> [T::V8<S>; 3] {
    [splat8(s, v[order[0]][lane]), splat8(s, v[order[1]][lane]), splat8(s, v[order[2]][lane])]
}
