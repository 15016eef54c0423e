//! One ray through the tree: a node's eight boxes in lanes, the nearest child first; a block's four triangles in lanes.

use super::node::{Block, Child, Entry, Node, Stack, key};
use super::ray::{Heading, Ready, slabs};
use super::{Bvh, Hit};
use crate::geometry::ray_triangle::watertight;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};

/// Which children of a node the ray passes before `end`, as bits, and where it enters each.
#[inline(always)]
pub fn children<T: Real, S: Simd>(
    s: S,
    node: &Node<T>,
    ray: &Ready<T>,
    heading: Heading,
    end: T,
) -> (u32, [T; 8]) {
    let end = splat8::<T, S>(s, end);
    let (mut entry, mut exit) = (splat8::<T, S>(s, ray.t_min), end);
    for k in 0..3 {
        let side = heading.negative[k];
        let inverse = splat8::<T, S>(s, ray.inverse[k]);
        let near = (planes(s, node, side, k) - splat8::<T, S>(s, ray.near[k])) * inverse;
        let far = (planes(s, node, 1 - side, k) - splat8::<T, S>(s, ray.far[k])) * inverse;
        // The bare minimum and maximum of the machine: no NaN arises, and the sign of a zero does not matter here.
        (entry, exit) = (SimdBase::max(entry, near), SimdBase::min(exit, far));
    }
    (T::V8::<S>::bits(Lanes::less_eq(entry, exit)), entry.to_array())
}

#[inline(always)]
pub fn splat8<T: Real, S: Simd>(s: S, x: T) -> T::V8<S> {
    SimdBase::splat(s, x)
}

#[inline(always)]
fn splat4<T: Real, S: Simd>(s: S, x: T) -> T::V4<S> {
    SimdBase::splat(s, x)
}

/// The lower (0) or upper (1) planes of a node's boxes on one axis.
#[inline(always)]
pub fn planes<T: Real, S: Simd>(s: S, node: &Node<T>, side: usize, axis: usize) -> T::V8<S> {
    SimdBase::load_array_ref(s, &node.planes[side][axis])
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
    let order = heading.order;
    let origin = splat4x3::<T, S>(s, ray.origin.to_array());
    let shear = splat4x3::<T, S>(s, ray.shear.to_array());
    for block in blocks {
        let (a, b, c) = (corner(s, block, 0, order), corner(s, block, 1, order), corner(s, block, 2, order));
        let Some((mask, x)) = watertight(origin.into(), shear.into(), a.into(), b.into(), c.into()) else {
            continue;
        };
        let end = splat4::<T, S>(s, hit.t);
        let mask = mask & Lanes::less(splat4::<T, S>(s, ray.t_min), x.t) & Lanes::less_eq(x.t, end);
        if T::V4::<S>::bits(mask) == 0 {
            continue;
        }
        // The hit must pass its triangle's own box, by the arithmetic of the nodes.
        let (near, far) = own_box(heading, a, b, c);
        let (entry, exit) = slabs(
            near,
            far,
            splat4x3::<T, S>(s, in_order(order, ray.near)),
            splat4x3::<T, S>(s, in_order(order, ray.far)),
            splat4x3::<T, S>(s, in_order(order, ray.inverse)),
        );
        let passed = Lanes::less_eq(entry, exit) & Lanes::less_eq(splat4::<T, S>(s, ray.t_min), exit);
        let t = Lanes::max(x.t, entry);
        let mut bits = T::V4::<S>::bits(mask & passed & Lanes::less_eq(t, end));
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

#[inline(always)]
pub fn in_order<X: Copy>(order: [usize; 3], v: [X; 3]) -> [X; 3] {
    [v[order[0]], v[order[1]], v[order[2]]]
}

#[inline(always)]
fn splat4x3<T: Real, S: Simd>(s: S, v: [T; 3]) -> [T::V4<S>; 3] {
    [splat4::<T, S>(s, v[0]), splat4::<T, S>(s, v[1]), splat4::<T, S>(s, v[2])]
}

/// One vertex of each of four triangles.
#[inline(always)]
fn corner<T: Real, S: Simd>(s: S, block: &Block<T>, vertex: usize, order: [usize; 3]) -> [T::V4<S>; 3] {
    let [x, y, z] = in_order(order, [0, 1, 2]);
    let v = &block.vertices[vertex];
    [
        SimdBase::load_array_ref(s, &v[x]),
        SimdBase::load_array_ref(s, &v[y]),
        SimdBase::load_array_ref(s, &v[z]),
    ]
}

/// The planes of triangles' own boxes that rays of a heading enter and leave through, like the corners in its order.
#[inline(always)]
pub fn own_box<V: Lanes>(heading: Heading, a: [V; 3], b: [V; 3], c: [V; 3]) -> ([V; 3], [V; 3]) {
    let (mut near, mut far) = (a, a);
    for i in 0..3 {
        let (low, high) = (a[i].min(b[i]).min(c[i]), a[i].max(b[i]).max(c[i]));
        let ahead = heading.negative[heading.order[i]] == 0;
        (near[i], far[i]) = if ahead { (low, high) } else { (high, low) };
    }
    (near, far)
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

/// The next passed child, and where the ray enters it.
#[inline(always)]
pub fn next<T: Real>(bits: &mut u32, node: &Node<T>, entries: &[T; 8]) -> Option<Entry> {
    if *bits == 0 {
        return None;
    }
    let i = bits.trailing_zeros() as usize & 7;
    *bits &= *bits - 1;
    Some(Entry::new(entries[i], node.children[i]))
}
