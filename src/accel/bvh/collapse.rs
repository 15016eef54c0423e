//! From a binary tree to nodes of eight children and blocks of four triangles, with exact boxes, in parallel.
//!
//! Parts of the tree are measured first, so that each task writes into its own stretch of the final arrays; nodes and
//! blocks stand in the order of depth, whatever the number of threads.

use super::boxes::Item;
use super::build::Branch;
use super::node::{Child, Node, WIDTH};
use crate::accel::block::{BLOCK, Block};
use crate::memory;
use crate::real::Real;
use rayon::prelude::*;
use std::mem::MaybeUninit;

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
    parts: [Option<P>; WIDTH],
    len: usize,
}

impl<P: Copy> Front<P> {
    pub fn new() -> Self {
        Front { parts: [None; WIDTH], len: 0 }
    }
    #[inline]
    pub fn push(&mut self, part: P) {
        self.parts[self.len] = Some(part);
        self.len += 1;
    }
    #[inline]
    pub fn parts(&self) -> impl Iterator<Item = P> {
        self.parts.iter().flatten().copied()
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
        let mut front = Front::new();
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
            None => front.push(at),
        }
    }
}

/// How much a part writes, and the same of its children where they are spread over threads.
struct Plan<P> {
    part: P,
    nodes: usize,
    blocks: usize,
    below: Vec<Plan<P>>,
    /// The children of each node that one thread writes, in the order of depth: to find them costs more than to keep them.
    fronts: Vec<Front<P>>,
}

type Fronts<'a, P> = std::slice::Iter<'a, Front<P>>;

/// The wide tree below `root`.
pub fn collapse<T: Real, B: Tree>(
    tree: &B,
    root: B::Part,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
) -> Wide<T> {
    if faces.is_empty() {
        return Wide { nodes: vec![Node::empty()], blocks: vec![] };
    }
    let mesh = Mesh { tree, positions, faces };
    // A leaf at the root is the only child of a node.
    let lone = tree.span(root).2;
    let plan = mesh.plan(root);
    let mut nodes = memory::list(plan.nodes + lone as usize);
    let mut blocks = memory::list(plan.blocks);
    let out = Stretch {
        nodes: nodes.spare_capacity_mut(),
        node: 0,
        blocks: &mut blocks.spare_capacity_mut()[..plan.blocks],
        block: 0,
    };
    if lone {
        let (first, out) = out.node();
        let (child, corners) = mesh.emit(&plan, out);
        let mut node = Node::empty();
        node.set(0, child, corners);
        first.write(node);
    } else {
        mesh.emit(&plan, out);
    }
    // Sound: `emit` has written every node and block that was planned.
    unsafe {
        nodes.set_len(plan.nodes + lone as usize);
        blocks.set_len(plan.blocks);
    }
    Wide { nodes, blocks }
}

type Corners<T> = [[T; 3]; 2];

impl<T: Real> Node<T> {
    #[inline]
    fn set(&mut self, slot: usize, child: Child, corners: Corners<T>) {
        self.set_child(slot, child);
        for side in 0..2 {
            for k in 0..3 {
                self.planes[side][k][slot] = corners[side][k];
            }
        }
    }
}

#[inline(always)]
fn grow<T: Real>(all: &mut Corners<T>, other: &Corners<T>) {
    for k in 0..3 {
        all[0][k] = all[0][k].min(other[0][k]);
        all[1][k] = all[1][k].max(other[1][k]);
    }
}

fn nothing<T: Real>() -> Corners<T> {
    [[T::INFINITY; 3], [-T::INFINITY; 3]]
}

/// Where a part is written: the rest of its stretch, and the indices at which that begins.
struct Stretch<'a, T> {
    nodes: &'a mut [MaybeUninit<Node<T>>],
    node: usize,
    blocks: &'a mut [MaybeUninit<Block<T>>],
    block: usize,
}

impl<'a, T> Stretch<'a, T> {
    /// The first node apart.
    fn node(self) -> (&'a mut MaybeUninit<Node<T>>, Self) {
        let (first, nodes) = self.nodes.split_first_mut().expect("a stretch is as long as planned");
        (first, Stretch { nodes, node: self.node + 1, ..self })
    }
    /// A stretch of its own for each plan.
    fn cut<P>(mut self, plans: &[Plan<P>]) -> Vec<Self> {
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

struct Mesh<'a, T, B> {
    tree: &'a B,
    positions: &'a [[T; 3]],
    faces: &'a [[i32; 3]],
}

impl<T: Real, B: Tree> Mesh<'_, T, B> {
    fn plan(&self, part: B::Part) -> Plan<B::Part> {
        let (_, count, leaf) = self.tree.span(part);
        if leaf || count <= TASK {
            let mut fronts = Vec::with_capacity(count / (2 * BLOCK));
            let blocks = self.measure(part, &mut fronts);
            return Plan { part, nodes: fronts.len(), blocks, below: vec![], fronts };
        }
        let parts: Vec<_> = self.tree.front(part).parts().collect();
        let below: Vec<_> = parts.into_par_iter().map(|p| self.plan(p)).collect();
        let nodes = 1 + below.iter().map(|p| p.nodes).sum::<usize>();
        Plan { part, nodes, blocks: below.iter().map(|p| p.blocks).sum(), below, fronts: vec![] }
    }

    /// Blocks of a part; its nodes' children go into a list.
    fn measure(&self, part: B::Part, fronts: &mut Vec<Front<B::Part>>) -> usize {
        let (_, count, leaf) = self.tree.span(part);
        if leaf {
            return count.div_ceil(BLOCK);
        }
        let front = self.tree.front(part);
        fronts.push(front);
        front.parts().map(|p| self.measure(p, fronts)).sum()
    }

    /// Writes a part as planned; what refers to it, and its box.
    fn emit(&self, plan: &Plan<B::Part>, out: Stretch<T>) -> (Child, Corners<T>) {
        if plan.below.is_empty() {
            let mut out = out;
            return self.emit_part(plan.part, &mut plan.fronts.iter(), &mut out);
        }
        let me = out.node;
        let (place, out) = out.node();
        let stretches = out.cut(&plan.below);
        let below: Vec<_> =
            plan.below.par_iter().zip(stretches).map(|(plan, out)| self.emit(plan, out)).collect();
        let (mut node, mut all) = (Node::empty(), nothing());
        for (slot, (child, corners)) in below.into_iter().enumerate() {
            node.set(slot, child, corners);
            grow(&mut all, &corners);
        }
        place.write(node);
        (Child::node(me), all)
    }

    /// The same by one thread, which takes from the stretch what it needs.
    fn emit_part(
        &self,
        part: B::Part,
        fronts: &mut Fronts<B::Part>,
        out: &mut Stretch<T>,
    ) -> (Child, Corners<T>) {
        let (first, count, leaf) = self.tree.span(part);
        if leaf {
            return self.emit_leaf(first, count, out);
        }
        let me = out.node;
        let (place, rest) = std::mem::take(&mut out.nodes).split_first_mut().expect("as long as planned");
        (out.nodes, out.node) = (rest, me + 1);
        let (mut node, mut all) = (Node::empty(), nothing());
        let front = fronts.next().expect("as many as planned");
        for (slot, part) in front.parts().enumerate() {
            let (child, corners) = self.emit_part(part, fronts, out);
            node.set(slot, child, corners);
            grow(&mut all, &corners);
        }
        place.write(node);
        (Child::node(me), all)
    }

    fn emit_leaf(&self, first: usize, count: usize, out: &mut Stretch<T>) -> (Child, Corners<T>) {
        let mut all: Corners<T> = nothing();
        let blocks = count.div_ceil(BLOCK);
        let (mine, rest) = std::mem::take(&mut out.blocks).split_at_mut(blocks);
        for (b, place) in mine.iter_mut().enumerate() {
            let mut block = Block::EMPTY;
            for lane in 0..BLOCK.min(count - BLOCK * b) {
                let face = self.tree.face(first + BLOCK * b + lane);
                block.faces[lane] = face as i32;
                for (vertex, &index) in self.faces[face].iter().enumerate() {
                    let p = self.positions[index as usize];
                    for k in 0..3 {
                        block.vertices[vertex][k][lane] = p[k];
                        all[0][k] = all[0][k].min(p[k]);
                        all[1][k] = all[1][k].max(p[k]);
                    }
                }
            }
            place.write(block);
        }
        let child = Child::leaf(out.block, blocks);
        (out.blocks, out.block) = (rest, out.block + blocks);
        (child, all)
    }
}
