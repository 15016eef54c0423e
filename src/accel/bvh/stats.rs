//! The size and make of a tree, read off its nodes.

use super::Bvh;
use super::node::{Child, Node};
use crate::accel::block::Block;
use crate::accel::structure::{Chances, Stats};
use crate::real::Real;

/// Nodes stand before their children, so one pass forward suffices.
pub fn stats<T: Real>(tree: &Bvh<T>) -> Stats {
    let (nodes, blocks) = (tree.nodes.len(), tree.blocks.len());
    let chances = Chances::new(tree.bounds);
    let mut depths = vec![0usize; nodes];
    let mut stats = Stats { faces: tree.faces, nodes, sah_cost: 1.0, ..Stats::default() };
    let mut children = 0;
    for (i, node) in tree.nodes.iter().enumerate() {
        for (slot, &child) in node.children.iter().enumerate().filter(|(_, c)| **c != Child::EMPTY) {
            children += 1;
            let corner = |side: usize| std::array::from_fn(|k| node.planes[side][k][slot]);
            let chance = chances.of([corner(0), corner(1)]);
            if child.is_leaf() {
                let faces = tree.run(child).iter().flat_map(|b| b.faces).filter(|&f| f >= 0).count();
                stats.leaves += 1;
                stats.references += faces;
                stats.depth = stats.depth.max(depths[i] + 1);
                stats.sah_cost += chance * faces as f64;
            } else {
                depths[child.index()] = depths[i] + 1;
                stats.sah_cost += chance;
            }
        }
    }
    stats.bytes = nodes * size_of::<Node<T>>() + blocks * size_of::<Block<T>>() + tree.few.bytes();
    stats.children_per_node = children as f64 / nodes as f64;
    stats.triangles_per_block = tree.faces as f64 / (blocks as f64).max(1.0);
    stats
}
