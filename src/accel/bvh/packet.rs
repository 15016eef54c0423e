//! Sixteen rays that run alike, through the tree together: a node is tested once, by intervals that hold all rays, and a
//! child once more, by the rays themselves; at leaves the lanes are rays, not triangles.
//!
//! Interval bounds follow from the monotone slab arithmetic as the boxes' do (see [`crate::accel::ray`]), so answers are
//! those of single rays to the bit.
//!
//! I. Wald, P. Slusallek, C. Benthin, M. Wagner, *Interactive Rendering with Coherent Ray Tracing*, 2001; S. Boulos
//! et al., *Packet-based Whitted and Distribution Ray Tracing*, 2007, for the intervals.

use super::Bvh;
use super::node::{Child, Entry, Node, Stack, key};
use super::single::{planes, splat8};
use crate::accel::block::{BLOCK, Block, in_order, own_box};
use crate::accel::ray::{Eight, Heading, Ready, load8, prepare, proper, slabs};
use crate::accel::{Hit, Ray};
use crate::geometry::ray_triangle::{along, watertight};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};

/// Rays in a packet: two groups of eight lanes.
pub const SIZE: usize = 16;
const GROUPS: usize = SIZE / 8;
/// Rays run alike if they stay this close, as a part of the scene's size, from one side of it to the other.
const SPREAD: f64 = 0.1;

/// The rays, their nearest hits, and the intervals that hold them.
pub struct Packet<T: Real, S: Simd> {
    rays: [Ready<T::V8<S>>; GROUPS],
    heading: Heading,
    ignore: [i32; SIZE],
    t: [[T; 8]; GROUPS],
    u: [[T; 8]; GROUPS],
    v: [[T; 8]; GROUPS],
    face: [[i32; 8]; GROUPS],
    /// The origin's extremes that enter earliest and leave latest; the extremes of the reciprocal direction.
    near: [T; 3],
    far: [T; 3],
    inverse: [[T; 3]; 2],
    t_min: T,
}

/// A packet of rays that share their heading and stay close together; None if they do not.
#[inline(always)]
pub fn gather<T: Real, S: Simd>(s: S, tree: &Bvh<T>, rays: impl Fn(usize) -> Ray<T>) -> Option<Packet<T, S>> {
    let heading = Heading::of(rays(0).direction);
    // Most batches without coherence are told apart here.
    if Heading::of(rays(SIZE - 1).direction) != heading || Heading::of(rays(SIZE / 2).direction) != heading {
        return None;
    }
    let rays_ready = [
        gather_group(
            s,
            tree,
            heading,
            #[inline(always)]
            |l| rays(l),
        )?,
        gather_group(
            s,
            tree,
            heading,
            #[inline(always)]
            |l| rays(8 + l),
        )?,
    ];
    if !close(tree, heading, &rays_ready) {
        return None;
    }
    let [a, b] = &rays_ready;
    let (mut near, mut far, mut inverse) = ([T::zero(); 3], [T::zero(); 3], [[T::zero(); 3]; 2]);
    for k in 0..3 {
        let (near_range, far_range) = (range(a.near[k], b.near[k]), range(a.far[k], b.far[k]));
        let side = heading.negative[k];
        (near[k], far[k]) = (near_range[1 - side], far_range[side]);
        [inverse[0][k], inverse[1][k]] = range(a.inverse[k], b.inverse[k]);
    }
    let mut ignore = [-1; SIZE];
    for i in 0..SIZE {
        ignore[i] = rays(i).ignore_face;
    }
    Some(Packet {
        heading,
        ignore,
        t: [a.t_max.to_array(), b.t_max.to_array()],
        u: [[T::zero(); 8]; GROUPS],
        v: [[T::zero(); 8]; GROUPS],
        face: [[-1; 8]; GROUPS],
        near,
        far,
        inverse,
        t_min: range(a.t_min, b.t_min)[0],
        rays: rays_ready,
    })
}

/// Eight rays made ready; None if one is no ray or goes another way.
#[inline(always)]
fn gather_group<T: Real, S: Simd>(
    s: S,
    tree: &Bvh<T>,
    heading: Heading,
    rays: impl Fn(usize) -> Ray<T>,
) -> Option<Ready<T::V8<S>>> {
    let Eight { origin: o, direction: d, t_min: low, t_max: high } = Eight::load(s, rays);
    let mut same = proper(o, d, low, high) & along(heading.order[2], d);
    for k in 0..3 {
        let negative = d[k].less(d[k].num(0.0));
        same = same & if heading.negative[k] == 1 { negative } else { !negative };
    }
    if T::V8::<S>::bits(same) != 0xff {
        return None;
    }
    Some(prepare(&tree.bounds, o, d, low, high).ready(heading))
}

/// The least and the greatest of sixteen lanes.
#[inline(always)]
fn range<T: Real, V: SimdBase<S, Element = T> + Lanes<Elem = T>, S: Simd>(a: V, b: V) -> [T; 2] {
    [SimdBase::min(a, b).reduce_min(), SimdBase::max(a, b).reduce_max()]
}

/// Whether the rays pass the first and the last plane of the scene, across the heading, close together.
#[inline(always)]
fn close<T: Real, S: Simd>(tree: &Bvh<T>, heading: Heading, [a, b]: &[Ready<T::V8<S>>; GROUPS]) -> bool {
    let [low, high] = &tree.bounds;
    let size = (high[0] - low[0]).max(high[1] - low[1]).max(high[2] - low[2]);
    let limit = size * T::of(SPREAD);
    for corner in [low, high] {
        let z = a.scale.like(corner[heading.order[2]]);
        let (az, bz) = (z - a.origin.z, z - b.origin.z);
        let x = range(a.origin.x + a.shear.x * az, b.origin.x + b.shear.x * bz);
        let y = range(a.origin.y + a.shear.y * az, b.origin.y + b.shear.y * bz);
        // Also if an end is NaN.
        if !(x[1] - x[0] <= limit && y[1] - y[0] <= limit) {
            return false;
        }
    }
    true
}

impl<T: Real, S: Simd> Packet<T, S> {
    /// Traces the rays.
    #[inline(always)]
    pub fn trace<const ANY: bool>(&mut self, s: S, tree: &Bvh<T>) {
        let mut end = self.end(s);
        let mut stack = Stack::new();
        stack.push(Entry::new(T::zero(), Child::ROOT));
        while let Some(entry) = stack.pop() {
            if entry.after(key(end)) {
                continue;
            }
            let child = entry.child();
            if child.is_leaf() {
                if self.leaf::<ANY>(s, tree.run(child)) {
                    end = self.end(s);
                    if ANY && end < self.t_min {
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
                if self.any_passes(s, node, i) {
                    stack.insert(base, Entry::new(entries[i], node.children[i]));
                }
            }
        }
    }

    /// The answer of one ray.
    #[inline(always)]
    pub fn hit(&self, i: usize) -> Hit<T> {
        let (g, l) = (i / 8, i % 8);
        if self.face[g][l] < 0 {
            return Hit::miss();
        }
        // As in `Ready::finish`.
        let t = self.t[g][l] * self.rays[g].scale.as_array()[l] + T::zero();
        Hit { t, u: self.u[g][l], v: self.v[g][l], face: self.face[g][l] }
    }

    /// The latest end of all rays.
    #[inline(always)]
    fn end(&self, s: S) -> T {
        SimdBase::max(load8::<T, S>(s, &self.t[0]), load8::<T, S>(s, &self.t[1])).reduce_max()
    }

    /// Children that some ray may pass, as bits, and where none enters earlier.
    #[inline(always)]
    fn children(&self, s: S, node: &Node<T>, end: T) -> (u32, [T; 8]) {
        let (mut entry, mut exit) = (splat8::<T, S>(s, self.t_min), splat8::<T, S>(s, end));
        for k in 0..3 {
            let side = self.heading.negative[k];
            let (least, greatest) =
                (splat8::<T, S>(s, self.inverse[0][k]), splat8::<T, S>(s, self.inverse[1][k]));
            let near = planes(s, node, side, k) - splat8::<T, S>(s, self.near[k]);
            let far = planes(s, node, 1 - side, k) - splat8::<T, S>(s, self.far[k]);
            entry = SimdBase::max(entry, SimdBase::min(near * least, near * greatest));
            exit = SimdBase::min(exit, SimdBase::max(far * least, far * greatest));
        }
        (T::V8::<S>::bits(Lanes::less_eq(entry, exit)), entry.to_array())
    }

    /// Whether any ray passes the box of child `i` before its hit.
    #[inline(always)]
    fn any_passes(&self, s: S, node: &Node<T>, i: usize) -> bool {
        for (ray, t) in self.rays.iter().zip(&self.t) {
            let (mut entry, mut exit) = (ray.t_min, load8::<T, S>(s, t));
            for k in 0..3 {
                let side = self.heading.negative[k];
                let near = splat8::<T, S>(s, node.planes[side][k][i]) - ray.near[k];
                let far = splat8::<T, S>(s, node.planes[1 - side][k][i]) - ray.far[k];
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
    fn leaf<const ANY: bool>(&mut self, s: S, blocks: &[Block<T>]) -> bool {
        let mut nearer = false;
        for block in blocks {
            for (lane, &face) in block.faces.iter().enumerate() {
                if face < 0 {
                    break;
                }
                let order = self.heading.order;
                let a = broadcast(s, &block.vertices[0], lane, order);
                let b = broadcast(s, &block.vertices[1], lane, order);
                let c = broadcast(s, &block.vertices[2], lane, order);
                for g in 0..GROUPS {
                    nearer |= self.triangle::<ANY>(s, g, face, [a, b, c]);
                }
            }
        }
        nearer
    }

    /// Tests a triangle against a group of rays.
    #[inline(always)]
    fn triangle<const ANY: bool>(
        &mut self,
        s: S,
        g: usize,
        face: i32,
        [a, b, c]: [[T::V8<S>; 3]; 3],
    ) -> bool {
        let ray = &self.rays[g];
        let Some((mask, x)) = watertight(ray.origin, ray.shear, a.into(), b.into(), c.into()) else {
            return false;
        };
        let end = load8::<T, S>(s, &self.t[g]);
        let mask = mask & Lanes::less(ray.t_min, x.t) & Lanes::less_eq(x.t, end);
        if T::V8::<S>::bits(mask) == 0 {
            return false;
        }
        // The triangle's own box, as in `single::leaf`.
        let order = self.heading.order;
        let (near, far) = own_box(self.heading, a, b, c);
        let (entry, exit) = slabs(
            near,
            far,
            in_order(order, ray.near),
            in_order(order, ray.far),
            in_order(order, ray.inverse),
        );
        let mask = mask & Lanes::less_eq(entry, exit) & Lanes::less_eq(ray.t_min, exit);
        let t = Lanes::max(x.t, entry);
        let mut bits = T::V8::<S>::bits(mask & Lanes::less_eq(t, end));
        let (t, u, v) = (t.to_array(), x.u.to_array(), x.v.to_array());
        let mut nearer = false;
        while bits != 0 {
            let l = bits.trailing_zeros() as usize & 7;
            bits &= bits - 1;
            let loses = t[l] == self.t[g][l] && face >= self.face[g][l];
            if loses || self.ignore[8 * g + l] == face {
                continue;
            }
            nearer = true;
            (self.u[g][l], self.v[g][l], self.face[g][l]) = (u[l], v[l], face);
            // One hit is enough: before everything, so that the ray meets nothing more.
            self.t[g][l] = if ANY { -T::INFINITY } else { t[l] };
        }
        nearer
    }
}

/// One vertex of one triangle of a block, for every ray.
#[inline(always)]
fn broadcast<T: Real, S: Simd>(s: S, v: &[[T; BLOCK]; 3], lane: usize, order: [usize; 3]) -> [T::V8<S>; 3] {
    [splat8(s, v[order[0]][lane]), splat8(s, v[order[1]][lane]), splat8(s, v[order[2]][lane])]
}
