//! The binary tree: binned surface area heuristic from the top down, in parallel.
//!
//! Splits are decided on boxes in single precision, relative to the scene's bounds; they shape the tree and nothing
//! else. Below a depth that the scene would have to be contrived for, and where centroids coincide, the list is cut in
//! the middle. The tree does not depend on the number of threads.
//!
//! I. Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, 2007.

use super::cut::{Costs, Cut};
use super::node::{Child, MAX_DEPTH};
use crate::accel::block::BLOCK;
use crate::accel::bounds::{Bounds, Item, reduce};
use std::sync::atomic::{AtomicBool, Ordering};

const BINS: usize = 16;
const SMALL: usize = 1 << 10;
/// Cost of a node, where a block of four triangles costs one.
const NODE_COST: f32 = 0.5;

/// A node of the binary tree over the items `first .. first + count`. Its left child follows it; `right` is 0 at leaves.
#[derive(Clone, Copy)]
pub struct Branch {
    pub first: u32,
    pub count: u32,
    pub right: u32,
    pub cut: Cut,
}

impl Branch {
    pub const EMPTY: Branch = Branch { first: 0, count: 0, right: 0, cut: Cut::LEAF };
}

/// The binary tree over `items`, which it orders. Cut short, and of no use, once `stop` is set.
pub fn binary_tree(items: &mut [Item], stop: &AtomicBool) -> Vec<Branch> {
    let mut branches = vec![Branch::EMPTY; (2 * items.len()).max(1)];
    split(items, 0, &mut branches, 0, 0, stop);
    branches
}

/// Builds the tree over `items` into `out`, whose first entry has the index `at`, and returns its costs.
fn split(
    items: &mut [Item],
    first: usize,
    out: &mut [Branch],
    at: usize,
    depth: usize,
    stop: &AtomicBool,
) -> Costs {
    let n = items.len();
    let (bounds, centres) = reduce(items, &bounds_of, &|a: (Bounds, Bounds), b: (Bounds, Bounds)| {
        let mut merged = a;
        merged.0.grow(&b.0);
        merged.1.grow(&b.1);
        merged
    });
    let (area, blocks) = (bounds.area(), n.div_ceil(BLOCK) as f32);
    out[0] = Branch { first: first as u32, count: n as u32, right: 0, cut: Cut::LEAF };
    if n <= 1 || (n > SMALL && stop.load(Ordering::Relaxed)) {
        return Costs::leaf(area * blocks);
    }
    // Halving needs this many levels more; keep them in reserve.
    let halving = depth + n.ilog2() as usize + 1 >= MAX_DEPTH;
    let best = if halving { None } else { best_plane(items, &centres) };
    let middle = match best {
        Some(p) => {
            if n <= BLOCK && p.cost + NODE_COST * area >= area * blocks {
                return Costs::leaf(area * blocks);
            }
            partition(items, |item| p.bins.of(item, p.axis) < p.bin)
        }
        None if n <= BLOCK => return Costs::leaf(area * blocks),
        None => n / 2,
    };
    let right = 2 * middle;
    out[0].right = (at + right) as u32;
    let (a, b) = items.split_at_mut(middle);
    let (left_out, right_out) = out[1..].split_at_mut(right - 1);
    let mut left = |stop: &AtomicBool| split(a, first, left_out, at + 1, depth + 1, stop);
    let mut rest = |stop: &AtomicBool| split(b, first + middle, right_out, at + right, depth + 1, stop);
    let (left, rest) =
        if n > SMALL { rayon::join(|| left(stop), || rest(stop)) } else { (left(stop), rest(stop)) };
    let leaf = if n <= BLOCK * Child::MAX_RUN { area * blocks } else { f32::INFINITY };
    let (costs, cut) = Costs::inner(&left, &rest, NODE_COST * area, leaf);
    out[0].cut = cut;
    costs
}

fn bounds_of(items: &[Item]) -> (Bounds, Bounds) {
    let (mut all, mut centres) = (Bounds::EMPTY, Bounds::EMPTY);
    for item in items {
        let c = item.centre();
        all.grow(&item.0);
        centres.grow(&Bounds { low: c, high: c });
    }
    (all, centres)
}

/// How centres fall into bins.
#[derive(Clone, Copy)]
struct Bins {
    low: [f32; 4],
    scale: [f32; 4],
    count: usize,
}

impl Bins {
    fn new(centres: &Bounds, n: usize) -> Self {
        let count = BINS.min(4 + n / 2);
        let scale = std::array::from_fn(|k| {
            let extent = centres.high[k] - centres.low[k];
            // A hair less than the count, so that the last centre falls into the last bin.
            if extent > 0.0 { count as f32 * 0.9999 / extent } else { 0.0 }
        });
        Bins { low: centres.low, scale, count }
    }
    #[inline(always)]
    fn of(&self, item: &Item, axis: usize) -> usize {
        (((item.0.low[axis] + item.0.high[axis] - self.low[axis]) * self.scale[axis]) as usize)
            .min(self.count - 1)
    }
}

struct Plane {
    bins: Bins,
    axis: usize,
    bin: usize,
    cost: f32,
}

type Filled = [[(Bounds, u32); BINS]; 3];

/// The plane of least cost; None if all centres coincide.
fn best_plane(items: &[Item], centres: &Bounds) -> Option<Plane> {
    let bins = Bins::new(centres, items.len());
    let fill = |items: &[Item]| {
        let mut filled: Filled = [[(Bounds::EMPTY, 0); BINS]; 3];
        for item in items {
            for axis in 0..3 {
                let bin = &mut filled[axis][bins.of(item, axis)];
                bin.0.grow(&item.0);
                bin.1 += 1;
            }
        }
        filled
    };
    let filled = reduce(items, &fill, &|mut a: Filled, b: Filled| {
        for (x, y) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
            x.0.grow(&y.0);
            x.1 += y.1;
        }
        a
    });
    let cost = |b: &Bounds, count: u32| b.area() * count.div_ceil(BLOCK as u32) as f32;
    let mut best: Option<Plane> = None;
    for axis in (0..3).filter(|&k| bins.scale[k] > 0.0) {
        // Costs of all that lies right of each plane, then a sweep from the left.
        let mut right = [0f32; BINS];
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for i in (1..bins.count).rev() {
            bounds.grow(&filled[axis][i].0);
            count += filled[axis][i].1;
            right[i] = cost(&bounds, count);
        }
        (bounds, count) = (Bounds::EMPTY, 0);
        for bin in 1..bins.count {
            bounds.grow(&filled[axis][bin - 1].0);
            count += filled[axis][bin - 1].1;
            let cost = cost(&bounds, count) + right[bin];
            let splits = count > 0 && (count as usize) < items.len();
            if splits && best.as_ref().is_none_or(|b| cost < b.cost) {
                best = Some(Plane { bins, axis, bin, cost });
            }
        }
    }
    best
}

/// Brings the items that `left` accepts to the front, and counts them.
fn partition(items: &mut [Item], left: impl Fn(&Item) -> bool) -> usize {
    let (mut i, mut j) = (0, items.len());
    while i < j {
        if left(&items[i]) {
            i += 1;
        } else {
            j -= 1;
            items.swap(i, j);
        }
    }
    i
}
