//! Many rays that have little in common: sixteen are traced in turns, a node each, and the node that a ray needs next
//! is fetched while the others work. Memory latency, not arithmetic, is what such rays wait for.

use super::node::{Child, Stack, key};
use super::{Bvh, single};
use crate::accel::block::leaf;
use crate::accel::ray::{Heading, Ready, ready};
use crate::accel::{Hit, Ray};
use crate::real::Real;
use crate::simd::Simd;

/// Rays under way at a time.
const ROWS: usize = 16;

/// A ray under way.
struct Row<T> {
    ray: Ready<T>,
    heading: Heading,
    ignore: i32,
    hit: Hit<T>,
    /// What it visits in its next turn.
    child: Child,
    index: usize,
    stack: Stack,
}

impl<T: Real> Row<T> {
    #[inline(always)]
    fn new(index: usize, ignore: i32, (ray, heading): (Ready<T>, Heading)) -> Self {
        Row { hit: ray.unhit(), ray, heading, ignore, child: Child::ROOT, index, stack: Stack::new() }
    }

    /// [`Row::new`] in place: the stack is large, and need not be moved.
    #[inline(always)]
    fn restart(&mut self, index: usize, ignore: i32, (ray, heading): (Ready<T>, Heading)) {
        self.hit = ray.unhit();
        (self.ray, self.heading, self.ignore) = (ray, heading, ignore);
        (self.child, self.index) = (Child::ROOT, index);
        self.stack.clear();
    }

    /// Visits one child; false if none is left.
    #[inline(always)]
    fn turn<const ANY: bool, S: Simd>(&mut self, s: S, tree: &Bvh<T>) -> bool {
        if self.child.is_leaf() {
            let run = tree.run(self.child);
            if leaf::<ANY, T, S>(s, run, &self.ray, self.heading, self.ignore, &mut self.hit) {
                return false;
            }
        } else {
            let node = tree.node(self.child);
            let (mut bits, entries) = single::children(s, node, &self.ray, self.heading, self.hit.t);
            if let Some(mut nearest) = single::next(&mut bits, node, &entries) {
                let base = self.stack.len();
                while let Some(mut other) = single::next(&mut bits, node, &entries) {
                    if other < nearest {
                        std::mem::swap(&mut other, &mut nearest);
                    }
                    self.stack.insert(base, other);
                }
                self.child = nearest.child();
                tree.prefetch(self.child);
                return true;
            }
        }
        let end = key(self.hit.t);
        while let Some(entry) = self.stack.pop() {
            if !entry.after(end) {
                self.child = entry.child();
                tree.prefetch(self.child);
                return true;
            }
        }
        false
    }
}

/// The next of the `chosen` rays that is one, from `next` on; those that are none are answered at once.
#[inline(always)]
fn take<T: Real, R: Fn(usize) -> Ray<T>, F: FnMut(usize, Hit<T>)>(
    tree: &Bvh<T>,
    rays: &R,
    chosen: &[u32],
    next: &mut usize,
    answer: &mut F,
) -> Option<(usize, i32, (Ready<T>, Heading))> {
    while let Some(&index) = chosen.get(*next) {
        *next += 1;
        let ray = rays(index as usize);
        match ready(&tree.bounds, &ray) {
            Some(made) => return Some((index as usize, ray.ignore_face, made)),
            None => answer(index as usize, Hit::no_ray()),
        }
    }
    None
}

/// Traces the `chosen` rays and hands each answer, with its ray's index, to `answer`.
#[inline(always)]
pub fn trace<const ANY: bool, T: Real, S: Simd, R: Fn(usize) -> Ray<T>, F: FnMut(usize, Hit<T>)>(
    s: S,
    tree: &Bvh<T>,
    rays: R,
    chosen: &[u32],
    mut answer: F,
) {
    let mut next = 0;
    let mut rows: Vec<Row<T>> = Vec::with_capacity(ROWS.min(chosen.len()));
    while rows.len() < ROWS
        && let Some((index, ignore, made)) = take(tree, &rays, chosen, &mut next, &mut answer)
    {
        rows.push(Row::new(index, ignore, made));
    }
    while !rows.is_empty() {
        let mut i = 0;
        while i < rows.len() {
            let row = &mut rows[i];
            if row.turn::<ANY, S>(s, tree) {
                i += 1;
                continue;
            }
            answer(row.index, row.ray.finish(row.hit));
            match take(tree, &rays, chosen, &mut next, &mut answer) {
                Some((index, ignore, made)) => row.restart(index, ignore, made),
                None => {
                    rows.swap_remove(i);
                }
            }
        }
    }
}
