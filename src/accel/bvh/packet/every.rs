//! Every hit of a packet's rays. Nothing is visited in order, since nothing ends the search early.

use super::{GROUPS, Packet, SIZE};
use crate::accel::Hit;
use crate::accel::block::{BLOCK, Block};
use crate::accel::bvh::Bvh;
use crate::accel::bvh::node::{Child, Entry, Stack};
use crate::accel::bvh::single::splat8;
use crate::accel::lists::OutOfMemory;
use crate::accel::met::Met;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use std::hint::black_box;
use std::sync::atomic::{Ordering, compiler_fence};

impl<T: Real, S: Simd> Packet<T, S> {
    /// Adds every hit of the rays, which are those from number `first` on.
    #[inline(always)]
    pub fn every(&mut self, s: S, tree: &Bvh<T>, first: u32, met: &mut Met<T>) -> Result<(), OutOfMemory> {
        black_box(&mut *self);
        let end = self.end();
        let mut stack = Stack::new();
        stack.push(Entry::new(T::zero(), Child::ROOT));
        while let Some(entry) = stack.pop() {
            compiler_fence(Ordering::SeqCst);
            let child = entry.child();
            if child.is_leaf() {
                for block in tree.run(child) {
                    met.reserve(SIZE * BLOCK)?;
                    self.block(s, block, end, first, met);
                }
                continue;
            }
            let node = tree.node(child);
            let (mut bits, _) = self.children(s, node, end);
            while bits != 0 {
                let i = bits.trailing_zeros() as usize & 7;
                bits &= bits - 1;
                if self.any_passes(s, node, i) {
                    stack.push(Entry::new(T::zero(), node.children[i]));
                }
            }
        }
        Ok(())
    }

    /// Adds every hit on the triangles of a block, for which there must be room.
    #[inline(always)]
    fn block(&self, s: S, block: &Block<T>, end: T, first: u32, met: &mut Met<T>) {
        let mut boxes = self.own_boxes(s, block, end);
        while let Some((lane, corners, own)) = boxes.next(s, block, self.heading.order) {
            for g in 0..GROUPS {
                let Some((mask, x)) = self.crossing(g, corners, own) else { continue };
                let ray = &self.rays[g];
                let mut bits = T::V8::<S>::bits(mask & Lanes::less(x.t, ray.t_max));
                let t = (x.t * ray.scale + splat8(s, T::zero())).to_array();
                let (u, v, face) = (x.u.to_array(), x.v.to_array(), block.faces[lane]);
                while bits != 0 {
                    let l = bits.trailing_zeros() as usize & 7;
                    bits &= bits - 1;
                    if self.ignore.is_none_or(|ignore| ignore[8 * g + l] != face) {
                        met.put(first + (8 * g + l) as u32, Hit { t: t[l], u: u[l], v: v[l], face });
                    }
                }
            }
        }
    }
}
