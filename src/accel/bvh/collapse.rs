//! From the binary tree to nodes of eight children and blocks of four triangles, with exact boxes.

use super::build::Branch;
use super::node::{Child, Node, WIDTH};
use crate::accel::block::{BLOCK, Block};
use crate::accel::bounds::Item;
use crate::real::Real;

/// Nodes and blocks in the order of depth.
pub struct Wide<T> {
    pub nodes: Vec<Node<T>>,
    pub blocks: Vec<Block<T>>,
}

/// What the tree is made from.
pub struct Source<'a, T> {
    pub positions: &'a [[T; 3]],
    pub faces: &'a [[i32; 3]],
    pub items: &'a [Item],
    pub branches: &'a [Branch],
}

type Corners<T> = [[T; 3]; 2];

/// The wide tree; always has a root, without children if there is no triangle.
pub fn collapse<T: Real>(source: &Source<T>) -> Wide<T> {
    let mut wide = Wide { nodes: vec![], blocks: vec![] };
    emit_node(&mut wide, source, 0);
    wide
}

fn emit_node<T: Real>(wide: &mut Wide<T>, source: &Source<T>, branch: usize) -> (Child, Corners<T>) {
    let me = wide.nodes.len();
    wide.nodes.push(Node::empty());
    let mut all = [[T::INFINITY; 3], [-T::INFINITY; 3]];
    let mut front = Front::default();
    if source.branches[branch].count > 0 {
        front.node(source.branches, branch);
    }
    for (slot, &child) in front.branches[..front.len].iter().enumerate() {
        let (reference, corners) = if source.branches[child].cut.is_leaf() {
            emit_leaf(wide, source, &source.branches[child])
        } else {
            emit_node(wide, source, child)
        };
        let node = &mut wide.nodes[me];
        node.children[slot] = reference;
        for k in 0..3 {
            node.planes[0][k][slot] = corners[0][k];
            node.planes[1][k][slot] = corners[1][k];
            all[0][k] = all[0][k].min(corners[0][k]);
            all[1][k] = all[1][k].max(corners[1][k]);
        }
    }
    (Child::node(me), all)
}

/// The branches that become a node's children.
#[derive(Default)]
struct Front {
    branches: [usize; WIDTH],
    len: usize,
}

impl Front {
    /// Those below a branch that becomes a node, or itself if it is the root and a leaf.
    fn node(&mut self, branches: &[Branch], at: usize) {
        if branches[at].cut.is_leaf() {
            return self.take(branches, at, 1);
        }
        let (left, right) = branches[at].cut.below();
        self.take(branches, at + 1, left);
        self.take(branches, branches[at].right as usize, right);
    }
    /// A branch in at most `slots` slots.
    fn take(&mut self, branches: &[Branch], at: usize, slots: usize) {
        match branches[at].cut.across(slots) {
            Some((left, right)) => {
                self.take(branches, at + 1, left);
                self.take(branches, branches[at].right as usize, right);
            }
            None => {
                self.branches[self.len] = at;
                self.len += 1;
            }
        }
    }
}

fn emit_leaf<T: Real>(wide: &mut Wide<T>, source: &Source<T>, leaf: &Branch) -> (Child, Corners<T>) {
    let first = wide.blocks.len();
    let mut all = [[T::INFINITY; 3], [-T::INFINITY; 3]];
    let items = &source.items[leaf.first as usize..][..leaf.count as usize];
    for four in items.chunks(BLOCK) {
        wide.blocks.push(Block::new(four.iter().map(|item| {
            let corners = source.faces[item.face()].map(|v| source.positions[v as usize]);
            for (p, k) in corners.iter().flat_map(|p| (0..3).map(move |k| (p, k))) {
                all[0][k] = all[0][k].min(p[k]);
                all[1][k] = all[1][k].max(p[k]);
            }
            (item.face() as i32, corners)
        })));
    }
    (Child::leaf(first, wide.blocks.len() - first), all)
}
