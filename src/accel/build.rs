//! The binary tree: binned surface area heuristic from the top down, in parallel.
//!
//! Splits are decided on boxes in single precision, relative to the scene's bounds; they shape the tree and nothing
//! else. Below a depth that the scene would have to be contrived for, and where centroids coincide, the list is cut in
//! the middle. The tree does not depend on the number of threads.
//!
//! I. Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, 2007.

use super::cut::{Costs, Cut};
use super::node::{BLOCK, Child, MAX_DEPTH};
use crate::real::Real;
use std::sync::atomic::{AtomicBool, Ordering};

const BINS: usize = 16;
/// Lists longer than this are bounded and binned by several threads, and their halves built side by side.
const LARGE: usize = 1 << 14;
const SMALL: usize = 1 << 10;
/// Cost of a node, where a block of four triangles costs one.
const NODE_COST: f32 = 0.5;

/// A box in single precision; the fourth component makes it a SIMD register.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub low: [f32; 4],
    pub high: [f32; 4],
}

impl Bounds {
    pub const EMPTY: Bounds = Bounds { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    fn grow(&mut self, o: &Bounds) {
        for k in 0..4 {
            self.low[k] = if o.low[k] < self.low[k] { o.low[k] } else { self.low[k] };
            self.high[k] = if o.high[k] > self.high[k] { o.high[k] } else { self.high[k] };
        }
    }
    /// Half the surface.
    #[inline(always)]
    fn area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|k| (self.high[k] - self.low[k]).max(0.0));
        x * y + y * z + z * x
    }
}

/// A triangle's box. The face's number stands in the fourth component of `high`, as the bits of a normal number.
#[derive(Clone, Copy)]
pub struct Item(Bounds);

impl Item {
    const NORMAL: u32 = 1 << 23;

    fn new(low: [f32; 3], high: [f32; 3], face: usize) -> Self {
        let ([a, b, c], [x, y, z]) = (low, high);
        Item(Bounds { low: [a, b, c, 0.0], high: [x, y, z, f32::from_bits(face as u32 + Self::NORMAL)] })
    }
    #[inline(always)]
    pub fn face(&self) -> usize {
        (self.0.high[3].to_bits() - Self::NORMAL) as usize
    }
    /// Twice the centre.
    #[inline(always)]
    fn centre(&self) -> [f32; 4] {
        std::array::from_fn(|k| self.0.low[k] + self.0.high[k])
    }
}

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

/// The exact bounds of all triangles; zeros if there are none.
pub fn scene_bounds<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]]) -> [[T; 3]; 2] {
    if faces.is_empty() {
        return [[T::zero(); 3]; 2];
    }
    let merge = |a: [[T; 3]; 2], b: [[T; 3]; 2]| {
        let low = std::array::from_fn(|k| a[0][k].min(b[0][k]));
        [low, std::array::from_fn(|k| a[1][k].max(b[1][k]))]
    };
    let of = |faces: &[[i32; 3]]| {
        let corners = faces.iter().flatten().map(|&i| positions[i as usize]);
        corners.fold([[T::INFINITY; 3], [-T::INFINITY; 3]], |b, p| merge(b, [p, p]))
    };
    reduce(faces, &of, &merge)
}

/// Items in single precision, the longest side of the scene being one.
pub fn items<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]], bounds: &[[T; 3]; 2]) -> Vec<Item> {
    let low = bounds[0].map(|x| x.to_f64());
    let extent = (0..3).map(|k| bounds[1][k].to_f64() - low[k]).fold(0.0, f64::max);
    let scale = if extent > 0.0 { 1.0 / extent } else { 0.0 };
    let item = |face: usize| {
        let corner = |j: usize| {
            let p = positions[faces[face][j] as usize];
            std::array::from_fn::<f32, 3, _>(|k| ((p[k].to_f64() - low[k]) * scale) as f32)
        };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let low = std::array::from_fn(|k| a[k].min(b[k]).min(c[k]));
        Item::new(low, std::array::from_fn(|k| a[k].max(b[k]).max(c[k])), face)
    };
    use rayon::prelude::*;
    (0..faces.len()).into_par_iter().with_min_len(LARGE).map(item).collect()
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

/// Folds a long list in halves, side by side; `merge` must not care for order.
fn reduce<I: Sync, R: Send>(
    list: &[I],
    of: &(impl Fn(&[I]) -> R + Sync),
    merge: &(impl Fn(R, R) -> R + Sync),
) -> R {
    if list.len() <= LARGE {
        return of(list);
    }
    let (a, b) = list.split_at(list.len() / 2);
    let (a, b) = rayon::join(|| reduce(a, of, merge), || reduce(b, of, merge));
    merge(a, b)
}
