//! Which parts of the binary tree become nodes of eight children, and which leaves: the choice of least expected cost, by
//! dynamic programming from the leaves up.
//!
//! H. Ylitie, T. Karras, S. Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*, 2017, section 3.

use super::node::WIDTH;
use bytemuck::Zeroable;

/// The least cost of a subtree as at most `i + 1` children of the node above it.
#[derive(Clone, Copy)]
pub struct Costs([f32; WIDTH - 1]);

/// How the least costs come about: how many child slots the left half takes.
#[derive(Clone, Copy, Zeroable)]
pub struct Cut {
    /// As a node of its own; 0 where a leaf is cheaper.
    node: u8,
    /// As at most `i + 1` children of the node above; 0 where one less costs the same.
    children: [u8; WIDTH - 1],
}

impl Costs {
    #[inline]
    pub fn leaf(cost: f32) -> Self {
        Costs([cost; WIDTH - 1])
    }

    /// Of a branch, from its halves. `node` is the cost of a node there, `leaf` that of all triangles in one leaf.
    #[inline(always)]
    pub fn inner(left: &Costs, right: &Costs, node: f32, leaf: f32) -> (Self, Cut) {
        let best = |slots: usize| {
            let split = |k: usize| (left.0[k - 1] + right.0[slots - k - 1], k as u8);
            (2..slots).map(split).fold(split(1), |a, b| if b.0 < a.0 { b } else { a })
        };
        let (mut costs, mut cut) = (Costs([0.0; WIDTH - 1]), Cut::LEAF);
        let (below, k) = best(WIDTH);
        (costs.0[0], cut.node) = if node + below < leaf { (node + below, k) } else { (leaf, 0) };
        for slots in 2..WIDTH {
            let (cost, k) = best(slots);
            let one_less = costs.0[slots - 2];
            (costs.0[slots - 1], cut.children[slots - 1]) =
                if cost < one_less { (cost, k) } else { (one_less, 0) };
        }
        (costs, cut)
    }
}

impl Cut {
    pub const LEAF: Cut = Cut { node: 0, children: [0; WIDTH - 1] };

    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.node == 0
    }
    /// Slots of the left and the right half below a node of its own.
    #[inline]
    pub fn below(&self) -> (usize, usize) {
        (self.node as usize, WIDTH - self.node as usize)
    }
    /// Slots of the halves as at most `slots` children of the node above; None where it is one child.
    #[inline]
    pub fn across(&self, slots: usize) -> Option<(usize, usize)> {
        let cheapest = (2..=slots).rev().find(|&i| self.children[i - 1] != 0)?;
        let left = self.children[cheapest - 1] as usize;
        Some((left, cheapest - left))
    }
}
