//! From the binary tree to nodes of eight children and blocks of four triangles, with exact boxes.

use super::build::{Branch, Item};
use super::node::{BLOCK, Block, Child, Node, WIDTH};
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
    for (slot, &child) in gather(source.branches, branch).iter().enumerate() {
        let (reference, corners) = if source.branches[child].right == 0 {
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

/// Up to eight descendants of a branch that cover it: the largest is opened until they are eight.
fn gather(branches: &[Branch], branch: usize) -> Vec<usize> {
    let mut front = Vec::with_capacity(WIDTH);
    if branches[branch].count > 0 {
        front.push(branch);
    }
    while front.len() < WIDTH {
        let open = |&i: &usize| branches[front[i]].right != 0;
        let area = |i: usize| branches[front[i]].bounds.area();
        let Some(i) = (0..front.len()).filter(open).max_by(|&i, &j| area(i).total_cmp(&area(j))) else {
            break;
        };
        let at = front[i];
        front[i] = at + 1;
        front.push(branches[at].right as usize);
    }
    front
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
