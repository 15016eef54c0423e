//! One ray through the tree: a node's eight boxes in lanes, the nearest child first.

use super::Bvh;
use super::node::{Child, Entry, Node, Stack, key};
use crate::accel::Hit;
use crate::accel::block::leaf;
use crate::accel::ray::{Heading, Ready};
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
            let Some(nearest) = descend(&mut bits, node, &entries, &mut stack) else { break };
            child = nearest;
        }
    }
    hit
}

/// The nearest of the passed children; the others wait on the stack.
#[inline(always)]
pub fn descend<T: Real>(
    bits: &mut u32,
    node: &Node<T>,
    entries: &[T; 8],
    stack: &mut Stack,
) -> Option<Child> {
    let first = next(bits, node, entries)?;
    // Most often one or two children are passed.
    let Some(second) = next(bits, node, entries) else { return Some(first.child()) };
    // Minimum and maximum rather than a comparison, whose outcome could not be guessed.
    let mut nearest = first.min(second);
    let base = stack.len();
    stack.push(first.max(second));
    while let Some(other) = next(bits, node, entries) {
        stack.insert(base, other.max(nearest));
        nearest = other.min(nearest);
    }
    Some(nearest.child())
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
