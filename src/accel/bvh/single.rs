//! One ray through the tree: a node's eight boxes in lanes, the nearest child first.

use super::Bvh;
use super::node::{Child, Entry, Node, Stack, WIDTH, key};
use crate::accel::Hit;
use crate::accel::block::leaf;
use crate::accel::ray::{Heading, Ready};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};

/// Where a node holds the planes that rays of a heading enter and leave its boxes through, by axis.
#[derive(Clone, Copy)]
pub struct Sides {
    near: [usize; 3],
    far: [usize; 3],
}

impl Sides {
    #[inline(always)]
    pub fn of(heading: Heading) -> Self {
        let n = heading.negative;
        let place = [n[0] & 1, n[1] & 1, n[2] & 1];
        let (low, high) = ([0, WIDTH, 2 * WIDTH], [3 * WIDTH, 4 * WIDTH, 5 * WIDTH]);
        let ahead = |k: usize, side: usize| if side == 0 { low[k] } else { high[k] };
        Sides {
            near: [ahead(0, place[0]), ahead(1, place[1]), ahead(2, place[2])],
            far: [ahead(0, 1 - place[0]), ahead(1, 1 - place[1]), ahead(2, 1 - place[2])],
        }
    }
}

/// The children of a node that the ray passes before `end`, and where it enters each.
#[inline(always)]
fn passed<T: Real, S: Simd>(
    s: S,
    node: &Node<T>,
    ray: &Ready<T>,
    sides: &Sides,
    end: T,
) -> (<T::V8<S> as Lanes>::Mask, T::V8<S>) {
    let (mut entry, mut exit) = (splat8::<T, S>(s, ray.t_min), splat8::<T, S>(s, end));
    for k in 0..3 {
        let inverse = splat8::<T, S>(s, ray.inverse[k]);
        // Sound: sides are places of planes within a node.
        let (near, far) = unsafe { (node.planes_at(sides.near[k]), node.planes_at(sides.far[k])) };
        let near = (T::V8::<S>::load_array_ref(s, near) - splat8::<T, S>(s, ray.near[k])) * inverse;
        let far = (T::V8::<S>::load_array_ref(s, far) - splat8::<T, S>(s, ray.far[k])) * inverse;
        // The bare minimum and maximum of the machine: no NaN arises, and the sign of a zero does not matter here.
        (entry, exit) = (SimdBase::max(entry, near), SimdBase::min(exit, far));
    }
    (Lanes::less_eq(entry, exit), entry)
}

/// Which children of a node the ray passes before `end`, as bits, and where it enters each.
#[inline(always)]
pub fn children<T: Real, S: Simd>(
    s: S,
    node: &Node<T>,
    ray: &Ready<T>,
    sides: &Sides,
    end: T,
) -> (u32, [T; 8]) {
    let (mask, entry) = passed(s, node, ray, sides, end);
    (T::V8::<S>::bits(mask), entry.to_array())
}

/// Puts the children of a node that the ray passes before `end` on the stack, the nearest on top.
#[inline(always)]
pub fn add_children<T: Real, S: Simd>(
    s: S,
    node: &Node<T>,
    ray: &Ready<T>,
    sides: &Sides,
    end: T,
    stack: &mut Stack,
) {
    let (mask, entry) = passed(s, node, ray, sides, end);
    let zero = splat8::<T, S>(s, T::zero());
    // What is added makes of -0 +0.
    let entry = SimdBase::max(entry, zero) + zero;
    let entry = T::V8::<S>::select(mask, entry, splat8(s, T::INFINITY));
    stack.add(node, T::V8::<S>::bits(mask), &entry.to_array());
}

#[inline(always)]
pub fn splat8<T: Real, S: Simd>(s: S, x: T) -> T::V8<S> {
    SimdBase::splat(s, x)
}

/// The lower (0) or upper (1) planes of a node's boxes on one axis.
#[inline(always)]
pub fn planes<T: Real, S: Simd>(s: S, node: &Node<T>, side: usize, axis: usize) -> T::V8<S> {
    // Masked, so that no bounds are checked.
    SimdBase::load_array_ref(s, &node.planes[side & 1][axis])
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
    let (mut hit, sides) = (ray.unhit(), Sides::of(heading));
    let mut stack = Stack::new();
    stack.push(Entry::new(T::zero(), Child::ROOT));
    while let Some(entry) = stack.pop() {
        if entry.after(key(hit.t)) {
            continue;
        }
        let child = entry.child();
        if child.is_leaf() {
            if leaf::<ANY, T, S>(s, tree.run(child), ray, &heading, ignore, &mut hit) {
                return hit;
            }
        } else {
            add_children(s, tree.node(child), ray, &sides, hit.t, &mut stack);
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
