//! The nodes and blocks of a planned tree, with exact boxes, written in parallel.

use super::collapse::{Plan, Tree};
use super::node::{Child, Node};
use crate::accel::block::{BLOCK, Block};
use crate::accel::bounds::{Box4, vertex};
use crate::dispatch;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use rayon::prelude::*;
use std::mem::MaybeUninit;
use std::sync::atomic::{AtomicBool, Ordering};

/// Where a part is written: its stretches of the final arrays, and the indices at which they begin.
pub struct Stretch<'a, T> {
    nodes: &'a mut [MaybeUninit<Node<T>>],
    node: usize,
    blocks: &'a mut [MaybeUninit<Block<T>>],
    block: usize,
}

impl<'a, T> Stretch<'a, T> {
    /// The whole arrays.
    pub fn new(nodes: &'a mut [MaybeUninit<Node<T>>], blocks: &'a mut [MaybeUninit<Block<T>>]) -> Self {
        Stretch { nodes, node: 0, blocks, block: 0 }
    }
    /// The first node apart.
    fn node(self) -> (&'a mut MaybeUninit<Node<T>>, Self) {
        let (first, nodes) = self.nodes.split_first_mut().expect("a stretch is as long as planned");
        (first, Stretch { nodes, node: self.node + 1, ..self })
    }
    /// A stretch of its own for each plan.
    fn cut(mut self, plans: &[Plan]) -> Vec<Self> {
        let each = plans.iter().map(|plan| {
            let (nodes, rest) = std::mem::take(&mut self.nodes).split_at_mut(plan.nodes);
            let (blocks, more) = std::mem::take(&mut self.blocks).split_at_mut(plan.blocks);
            let mine = Stretch { nodes, node: self.node, blocks, block: self.block };
            (self.nodes, self.node) = (rest, self.node + plan.nodes);
            (self.blocks, self.block) = (more, self.block + plan.blocks);
            mine
        });
        each.collect()
    }
}

/// A mesh, and the tree over its faces.
pub struct Mesh<'a, T, B> {
    pub tree: &'a B,
    pub positions: &'a [[T; 3]],
    pub faces: &'a [[i32; 3]],
    /// Once it is set, nothing more is written.
    pub stop: &'a AtomicBool,
}

impl<T: Real, B: Tree> Mesh<'_, T, B> {
    /// Writes the whole tree as planned. A leaf at the root becomes the only child of a node.
    pub fn emit_root(&self, plan: &Plan, out: Stretch<T>) {
        if plan.nodes > 0 {
            self.emit(plan, out);
            return;
        }
        let (first, out) = out.node();
        let (child, corners) = self.emit(plan, out);
        let node = first.write(Node::empty());
        node.set(0, child, &corners);
    }

    /// Writes a part as planned; what refers to it, and its box.
    fn emit(&self, plan: &Plan, out: Stretch<T>) -> (Child, Corners<T>) {
        if self.stop.load(Ordering::Relaxed) {
            return (Child::EMPTY, [[T::zero(); 4]; 2]);
        }
        if plan.below.is_empty() {
            return dispatch!(s => self.emit_part(s, plan, out));
        }
        let me = out.node;
        let (place, out) = out.node();
        let stretches = out.cut(&plan.below);
        let below: Vec<_> =
            plan.below.par_iter().zip(stretches).map(|(plan, out)| self.emit(plan, out)).collect();
        let node = place.write(Node::empty());
        let mut all = [[T::INFINITY; 4], [-T::INFINITY; 4]];
        for (slot, (child, corners)) in below.iter().enumerate() {
            node.set(slot, *child, corners);
            for k in 0..3 {
                all[0][k] = Lanes::min(all[0][k], corners[0][k]);
                all[1][k] = Lanes::max(all[1][k], corners[1][k]);
            }
        }
        (Child::node(me), all)
    }

    /// The same by one thread: leaves first, then nodes from the deepest up.
    #[inline(always)]
    fn emit_part<S: Simd>(&self, s: S, plan: &Plan, out: Stretch<T>) -> (Child, Corners<T>) {
        let mut leaves = Vec::with_capacity(plan.leaves.len());
        let (mut first, mut block) = (plan.first, out.block);
        let mut places = &mut out.blocks[..plan.blocks];
        for &count in &plan.leaves {
            let count = count as usize;
            let blocks = count.div_ceil(BLOCK);
            let (mine, rest) = places.split_at_mut(blocks);
            let corners = self.emit_leaf(s, first, count, mine);
            leaves.push((Child::leaf(block, blocks), corners));
            (places, first, block) = (rest, first + count, block + blocks);
        }
        if plan.children.is_empty() {
            return leaves[0];
        }
        let mut boxes = vec![[[T::zero(); 4]; 2]; plan.children.len()];
        for me in (0..plan.children.len()).rev() {
            let node = out.nodes[me].write(Node::empty());
            let mut all = Box4::<T, S>::empty(s);
            for (slot, child) in plan.children[me].parts().iter().enumerate() {
                let (child, corners) = match child.leaf() {
                    Some(leaf) => leaves[leaf],
                    None => (Child::node(out.node + child.node()), boxes[child.node()]),
                };
                node.set(slot, child, &corners);
                all = all.union(Box4::load(s, &corners));
            }
            boxes[me] = all.store();
        }
        (Child::node(out.node), boxes[0])
    }

    /// Writes a leaf's blocks; its box.
    #[inline(always)]
    fn emit_leaf<S: Simd>(
        &self,
        s: S,
        first: usize,
        count: usize,
        places: &mut [MaybeUninit<Block<T>>],
    ) -> Corners<T> {
        let mut all = Box4::<T, S>::empty(s);
        let mut at = first;
        for place in places {
            // The last triangle stands in for those that lack.
            let last = first + count - 1;
            let faces = [0, 1, 2, 3].map(
                #[inline(always)]
                |lane| self.tree.face(last.min(at + lane)),
            );
            let block = place.write(Block::EMPTY);
            let corners =
                [self.faces[faces[0]], self.faces[faces[1]], self.faces[faces[2]], self.faces[faces[3]]];
            for v in 0..3 {
                let a = vertex(s, self.positions, corners[0][v]);
                let b = vertex(s, self.positions, corners[1][v]);
                let c = vertex(s, self.positions, corners[2][v]);
                let d = vertex(s, self.positions, corners[3][v]);
                all = all.with(a).with(b).with(c).with(d);
                let (ac, bd) = (a.zip_low(c), b.zip_low(d));
                ac.zip_low(bd).store_array(&mut block.vertices[v][0]);
                ac.zip_high(bd).store_array(&mut block.vertices[v][1]);
                a.zip_high(c).zip_low(b.zip_high(d)).store_array(&mut block.vertices[v][2]);
            }
            for lane in 0..BLOCK {
                if at + lane <= last {
                    block.faces[lane] = faces[lane] as i32;
                } else {
                    block.clear(lane);
                }
            }
            at += BLOCK;
        }
        all.store()
    }
}

/// A box: lower and upper corner, each with a lane that means nothing.
type Corners<T> = [[T; 4]; 2];

impl<T: Real> Node<T> {
    #[inline(always)]
    fn set(&mut self, slot: usize, child: Child, corners: &Corners<T>) {
        self.set_child(slot, child);
        for side in 0..2 {
            for k in 0..3 {
                self.planes[side][k][slot] = corners[side][k];
            }
        }
    }
}
