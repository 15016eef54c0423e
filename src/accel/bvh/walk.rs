//! The tree by the protocol of all structures.

use super::node::{Child, Entry, Stack, key};
use super::{Bvh, single};
use crate::accel::batch::{Sink, Source};
use crate::accel::lists::OutOfMemory;
use crate::accel::met::Met;
use crate::accel::ray::{Heading, Ready};
use crate::accel::structure::{Stats, Structure, Visit};
use crate::real::Real;
use crate::simd::Simd;

impl<T: Real> Structure<T> for Bvh<T> {
    fn bounds(&self) -> [[T; 3]; 2] {
        self.bounds
    }

    fn stats(&self) -> Stats {
        super::stats::stats(self)
    }

    /// Boxes counted are those of every node visited, empty slots left out.
    #[inline(always)]
    fn walk<S: Simd, V: Visit<T>>(&self, s: S, ray: &Ready<T>, heading: Heading, visit: &mut V) {
        let (mut stack, sides) = (Stack::new(), single::Sides::of(heading));
        stack.push(Entry::new(T::zero(), Child::ROOT));
        while let Some(entry) = stack.pop() {
            if entry.after(key(visit.end())) {
                continue;
            }
            let child = entry.child();
            if child.is_leaf() {
                if visit.leaf(s, self.run(child)) {
                    return;
                }
                continue;
            }
            let node = self.node(child);
            visit.boxes(node.children.iter().filter(|&&c| c != Child::EMPTY).count());
            let (mut bits, entries) = single::children(s, node, ray, &sides, visit.end());
            let base = stack.len();
            while let Some(entry) = single::next(&mut bits, node, &entries) {
                stack.insert(base, entry);
            }
        }
    }

    #[inline(always)]
    fn closest_batch<S: Simd>(&self, s: S, count: usize, rays: impl Source<T>, answer: impl Sink<T>) {
        self.trace_batch::<false, S>(s, count, rays, answer);
    }

    #[inline(always)]
    fn any_batch<S: Simd>(&self, s: S, count: usize, rays: impl Source<T>, answer: impl Sink<T>) {
        self.trace_batch::<true, S>(s, count, rays, answer);
    }

    #[inline(always)]
    fn every_batch<S: Simd>(
        &self,
        s: S,
        range: (usize, usize),
        rays: impl Source<T>,
        met: &mut Met<T>,
    ) -> Result<(), OutOfMemory> {
        self.every_hit(s, range, &rays, met)
    }
}
