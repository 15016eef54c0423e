//! From a binary tree to nodes of eight children and blocks of four triangles: which parts of the tree become what.
//!
//! Parts are measured first, so that each task writes into its own stretch of the final arrays (see [`super::emit`]);
//! nodes and blocks stand in the order of depth, whatever the number of threads.

use super::boxes::Item;
use super::build::Branch;
use super::emit::{Mesh, Stretch};
use super::node::{Node, WIDTH};
use crate::accel::block::{BLOCK, Block};
use crate::memory;
use crate::real::Real;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Parts of more triangles than this are spread over threads.
const TASK: usize = 1 << 13;

/// Nodes and blocks; the root is the first node, without children if there is no triangle.
pub struct Wide<T> {
    pub nodes: Vec<Node<T>>,
    pub blocks: Vec<Block<T>>,
}

/// A binary tree that says which of its parts become children.
pub trait Tree: Sync {
    /// A subtree.
    type Part: Copy + Send + Sync;

    /// The triangles of a part, as an interval of the tree's order, and whether they become a leaf.
    fn span(&self, part: Self::Part) -> (usize, usize, bool);
    /// The children of a part that is no leaf.
    fn front(&self, part: Self::Part) -> Front<Self::Part>;
    /// The face at a place of the tree's order.
    fn face(&self, at: usize) -> usize;
}

/// At most eight parts.
#[derive(Clone, Copy)]
pub struct Front<P> {
    parts: [P; WIDTH],
    len: usize,
}

impl<P: Copy> Front<P> {
    /// The first `len` of some parts.
    #[inline]
    pub fn new(parts: [P; WIDTH], len: usize) -> Self {
        Front { parts, len }
    }
    #[inline]
    pub fn parts(&self) -> &[P] {
        &self.parts[..self.len]
    }
}

/// The tree of cuts over items.
pub struct Cuts<'a> {
    pub items: &'a [Item],
    pub branches: &'a [Branch],
}

impl Tree for Cuts<'_> {
    type Part = u32;

    #[inline]
    fn span(&self, part: u32) -> (usize, usize, bool) {
        let b = &self.branches[part as usize];
        (b.first as usize, b.count as usize, b.cut.is_leaf())
    }
    #[inline]
    fn front(&self, part: u32) -> Front<u32> {
        let branch = &self.branches[part as usize];
        let (left, right) = branch.cut.below();
        let mut front = Front::new([part; WIDTH], 0);
        self.take(part + 1, left, &mut front);
        self.take(branch.right, right, &mut front);
        front
    }
    #[inline]
    fn face(&self, at: usize) -> usize {
        self.items[at].face()
    }
}

impl Cuts<'_> {
    /// A branch in at most `slots` slots.
    fn take(&self, at: u32, slots: usize, front: &mut Front<u32>) {
        let branch = &self.branches[at as usize];
        match branch.cut.across(slots) {
            Some((left, right)) => {
                self.take(at + 1, left, front);
                self.take(branch.right, right, front);
            }
            None => {
                front.parts[front.len] = at;
                front.len += 1;
            }
        }
    }
}

/// A child as a plan numbers it: a node, or a leaf with the highest bit set; each counted through its plan.
#[derive(Clone, Copy, Default)]
pub struct Planned(u32);

impl Planned {
    const LEAF: u32 = 1 << 31;

    #[inline]
    pub fn leaf(self) -> Option<usize> {
        if self.0 & Self::LEAF != 0 { Some((self.0 & !Self::LEAF) as usize) } else { None }
    }
    #[inline]
    pub fn node(self) -> usize {
        self.0 as usize
    }
}

/// What a part becomes. That of many triangles is one node, whose children are planned by other tasks; else the nodes and
/// the leaves are listed, both in the order of depth.
pub struct Plan {
    /// The place of its first triangle in the tree's order.
    pub first: usize,
    /// How many nodes and blocks it writes in all.
    pub nodes: usize,
    pub blocks: usize,
    pub below: Vec<Plan>,
    /// The children of each node.
    pub children: Vec<Front<Planned>>,
    /// The triangles of each leaf.
    pub leaves: Vec<u8>,
}

impl Plan {
    fn new<B: Tree>(tree: &B, part: B::Part, stop: &AtomicBool) -> Self {
        let (first, count, leaf) = tree.span(part);
        let mut plan = Plan { first, nodes: 0, blocks: 0, below: vec![], children: vec![], leaves: vec![] };
        if stop.load(Ordering::Relaxed) {
            return plan;
        }
        if leaf || count <= TASK {
            plan.children.reserve(count / (4 * BLOCK));
            plan.leaves.reserve(count / 2);
            plan.measure(tree, part);
            plan.nodes = plan.children.len();
            return plan;
        }
        plan.below = tree.front(part).parts().par_iter().map(|&p| Plan::new(tree, p, stop)).collect();
        plan.nodes = 1 + plan.below.iter().map(|p| p.nodes).sum::<usize>();
        plan.blocks = plan.below.iter().map(|p| p.blocks).sum();
        plan
    }

    fn measure<B: Tree>(&mut self, tree: &B, part: B::Part) -> Planned {
        let (_, count, leaf) = tree.span(part);
        if leaf {
            self.blocks += count.div_ceil(BLOCK);
            self.leaves.push(count as u8);
            return Planned(Planned::LEAF | (self.leaves.len() - 1) as u32);
        }
        let me = self.children.len();
        let front = tree.front(part);
        self.children.push(Front::new([Planned(0); WIDTH], front.len));
        for (slot, &part) in front.parts().iter().enumerate() {
            self.children[me].parts[slot] = self.measure(tree, part);
        }
        Planned(me as u32)
    }
}

/// The wide tree below `root`; an empty one once `stop` is set.
pub fn collapse<T: Real, B: Tree>(
    tree: &B,
    root: B::Part,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    stop: &AtomicBool,
) -> Wide<T> {
    let stopped = || stop.load(Ordering::Relaxed);
    let empty = || Wide { nodes: vec![Node::empty()], blocks: vec![] };
    // What was cut short is no tree.
    if faces.is_empty() || stopped() {
        return empty();
    }
    let plan = Plan::new(tree, root, stop);
    if stopped() {
        return empty();
    }
    // A leaf at the root is the only child of a node.
    let nodes_len = plan.nodes.max(1);
    let mut nodes = memory::list(nodes_len);
    let mut blocks = memory::list(plan.blocks);
    let out = Stretch::new(nodes.spare_capacity_mut(), &mut blocks.spare_capacity_mut()[..plan.blocks]);
    Mesh { tree, positions, faces, stop }.emit_root(&plan, out);
    if stopped() {
        return empty();
    }
    // Sound: every node and block that was planned has been written, since nobody was told to stop.
    unsafe {
        nodes.set_len(nodes_len);
        blocks.set_len(plan.blocks);
    }
    Wide { nodes, blocks }
}
