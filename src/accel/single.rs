//! One ray through the tree: a node's eight boxes in lanes, the nearest child first; a block's four triangles in lanes.

use super::node::{Block, Child, Entry, Node, Stack, key};
use super::ray::{Heading, Ready, slabs};
use super::{Bvh, Hit};
use crate::geometry::ray_triangle::watertight;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crate::vec::Vec3;

/// Which children of a node the ray passes before `end`, as bits, and where it enters each.
#[inline(always)]
pub fn children<T: Real, S: Simd>(
    s: S,
    node: &Node<T>,
    ray: &Ready<T>,
    heading: Heading,
    end: T,
) -> (u32, [T; 8]) {
    let splat = |x: T| <T::V8<S> as SimdBase<S>>::splat(s, x);
    let load = |side: usize, k: usize| <T::V8<S> as SimdBase<S>>::load_array_ref(s, &node.planes[side][k]);
    let enter = |k: usize| (load(heading.negative[k], k) - splat(ray.near[k])) * splat(ray.inverse[k]);
    let leave = |k: usize| (load(1 - heading.negative[k], k) - splat(ray.far[k])) * splat(ray.inverse[k]);
    // The bare minimum and maximum of the machine: no NaN arises, and the sign of a zero does not matter here.
    let max = |a: T::V8<S>, b: T::V8<S>| SimdBase::max(a, b);
    let min = |a: T::V8<S>, b: T::V8<S>| SimdBase::min(a, b);
    let entry = max(max(enter(0), enter(1)), max(enter(2), splat(ray.t_min)));
    let exit = min(min(leave(0), leave(1)), min(leave(2), splat(end)));
    (T::V8::<S>::bits(Lanes::less_eq(entry, exit)), entry.to_array())
}

/// Tests the triangles of a leaf, and keeps the nearest hit. With `ANY`, returns true at the first.
#[inline(always)]
pub fn leaf<const ANY: bool, T: Real, S: Simd>(
    s: S,
    blocks: &[Block<T>],
    ray: &Ready<T>,
    heading: Heading,
    ignore: i32,
    hit: &mut Hit<T>,
) -> bool {
    let splat = |x: T| <T::V4<S> as SimdBase<S>>::splat(s, x);
    let [kx, ky, kz] = heading.order;
    let (origin, shear) = (ray.origin.map(splat), ray.shear.map(splat));
    for block in blocks {
        let corner = |j: usize| {
            let [x, y, z] =
                [kx, ky, kz].map(|k| <T::V4<S> as SimdBase<S>>::load_array_ref(s, &block.vertices[j][k]));
            Vec3::new(x, y, z)
        };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let Some((mask, x)) = watertight(origin, shear, a, b, c) else { continue };
        let mask = mask & Lanes::less(splat(ray.t_min), x.t) & Lanes::less_eq(x.t, splat(hit.t));
        if T::V4::<S>::bits(mask) == 0 {
            continue;
        }
        // The hit must pass its triangle's own box, by the arithmetic of the nodes.
        let (low, high) = corners_box(a.to_array(), b.to_array(), c.to_array());
        let flip = heading.order.map(|k| heading.negative[k] == 1);
        let of = |v: [T; 3]| heading.order.map(|k| splat(v[k]));
        let near = std::array::from_fn(|i| if flip[i] { high[i] } else { low[i] });
        let far = std::array::from_fn(|i| if flip[i] { low[i] } else { high[i] });
        let (entry, exit) = slabs(near, far, of(ray.near), of(ray.far), of(ray.inverse));
        let passed = Lanes::less_eq(entry, exit) & Lanes::less_eq(splat(ray.t_min), exit);
        let t = Lanes::max(x.t, entry);
        let mut bits = T::V4::<S>::bits(mask & passed & Lanes::less_eq(t, splat(hit.t)));
        let (t, u, v) = (t.to_array(), x.u.to_array(), x.v.to_array());
        while bits != 0 {
            let l = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let face = block.faces[l];
            if face != ignore && (t[l] < hit.t || (t[l] == hit.t && face < hit.face)) {
                *hit = Hit { t: t[l], u: u[l], v: v[l], face };
                if ANY {
                    return true;
                }
            }
        }
    }
    false
}

/// The bounds of triangles, component by component.
#[inline(always)]
pub fn corners_box<V: Lanes>(a: [V; 3], b: [V; 3], c: [V; 3]) -> ([V; 3], [V; 3]) {
    (std::array::from_fn(|k| a[k].min(b[k]).min(c[k])), std::array::from_fn(|k| a[k].max(b[k]).max(c[k])))
}

/// The ray through the whole tree.
#[inline(always)]
pub fn trace<const ANY: bool, T: Real, S: Simd>(
    s: S,
    tree: &Bvh<T>,
    ray: &Ready<T>,
    heading: Heading,
    ignore: i32,
) -> Hit<T> {
    let mut hit = ray.unhit();
    let mut stack = Stack::new();
    stack.push(Entry::new(T::zero(), Child::ROOT));
    while let Some(entry) = stack.pop() {
        if entry.after(key(hit.t)) {
            continue;
        }
        let mut child = entry.child();
        loop {
            if child.is_leaf() {
                if leaf::<ANY, T, S>(s, tree.run(child), ray, heading, ignore, &mut hit) {
                    return hit;
                }
                break;
            }
            let node = tree.node(child);
            let (mut bits, entries) = children(s, node, ray, heading, hit.t);
            let Some(first) = next(&mut bits, node, &entries) else { break };
            // Most often one or two children are passed: the nearer is gone into, the other waits.
            let Some(second) = next(&mut bits, node, &entries) else {
                child = first.child();
                continue;
            };
            let (mut nearest, later) = if second < first { (second, first) } else { (first, second) };
            let base = stack.len();
            stack.push(later);
            while let Some(mut other) = next(&mut bits, node, &entries) {
                if other < nearest {
                    std::mem::swap(&mut other, &mut nearest);
                }
                stack.insert(base, other);
            }
            child = nearest.child();
        }
    }
    hit
}

#[inline(always)]
fn next<T: Real>(bits: &mut u32, node: &Node<T>, entries: &[T; 8]) -> Option<Entry> {
    if *bits == 0 {
        return None;
    }
    let i = bits.trailing_zeros() as usize & 7;
    *bits &= *bits - 1;
    Some(Entry::new(entries[i], node.children[i]))
}
