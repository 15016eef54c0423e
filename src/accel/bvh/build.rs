//! The binary tree from the top down, in parallel: binned surface area heuristic, or halves by the order of centres.
//!
//! Splits are decided on boxes in single precision, relative to the scene's bounds; they shape the tree and nothing
//! else. Below a depth that the scene would have to be contrived for, and where centroids coincide, the list is cut in
//! the middle. The tree does not depend on the number of threads.
//!
//! I. Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, 2007.

use super::boxes::{Bounds, Item, area, centre};
use super::cut::{Costs, Cut};
use super::node::{Child, MAX_DEPTH};
use crate::accel::block::BLOCK;
use crate::accel::bounds::LARGE;
use crate::dispatch;
use crate::memory;
use crate::real;
use crate::simd::{Simd, SimdBase, f32x4, f32x8};
use bytemuck::Zeroable;
use fearless_simd::{SimdCvtTruncate, SimdSplit, i32x4};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

const BINS: usize = 16;
/// Shorter lists are not worth a task of their own.
const SMALL: usize = 1 << 10;
/// Cost of a node, where a block of four triangles costs one.
const NODE_COST: f32 = 0.5;

/// How lists are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// At the plane of least cost among those between bins.
    Sah,
    /// In the middle of the order along the axis on which centres spread most.
    Median,
}

/// A node of the binary tree over the items `first .. first + count`. Its left child follows it; `right` is 0 at leaves.
#[derive(Clone, Copy, Zeroable)]
pub struct Branch {
    pub first: u32,
    pub count: u32,
    pub right: u32,
    pub cut: Cut,
}

/// The binary tree over `items`, which it orders. Cut short, and of no use, once `stop` is set.
pub fn binary_tree(items: &mut [Item], split: Split, stop: &AtomicBool) -> Vec<Branch> {
    let mut branches = memory::zeros::<Branch>((2 * items.len()).max(1), stop);
    let mut scratch = memory::zeros::<Item>(items.len(), stop);
    dispatch!(s => {
        let centres = reduce(items, |items| centres_of(s, items), merged);
        let list = List { items, scratch: &mut scratch, first: 0, out: &mut branches, at: 0, centres };
        list.split(Way { s, split, stop }, &mut Filled::new(), 0)
    });
    branches
}

/// A part of the items, as much scratch, and where its branches go: the first has the index `at`.
struct List<'a> {
    items: &'a mut [Item],
    scratch: &'a mut [Item],
    first: usize,
    out: &'a mut [Branch],
    at: usize,
    /// The bounds of the centres.
    centres: Bounds,
}

/// What all lists of a tree share.
#[derive(Clone, Copy)]
struct Way<'a, S> {
    s: S,
    split: Split,
    stop: &'a AtomicBool,
}

impl List<'_> {
    /// Builds the tree over the list, and returns its costs and its box.
    fn split<S: Simd>(mut self, way: Way<S>, bins: &mut Filled, depth: usize) -> (Costs, Bounds) {
        let n = self.items.len();
        self.out[0] = Branch { first: self.first as u32, count: n as u32, right: 0, cut: Cut::LEAF };
        if n <= BLOCK || (n > SMALL && way.stop.load(Ordering::Relaxed)) {
            return leaf(way.s, self.items);
        }
        // Halving needs this many levels more; keep them in reserve.
        let halving = depth + n.ilog2() as usize + 1 >= MAX_DEPTH;
        let (middle, centres) = self.choose(way.s, way.split, bins, halving);
        let (first, at, right) = (self.first, self.at, 2 * middle);
        self.out[0].right = (at + right) as u32;
        let (me, out) = self.out.split_first_mut().expect("a list has a branch");
        let (a, b) = self.items.split_at_mut(middle);
        let (sa, sb) = self.scratch.split_at_mut(middle);
        let (out_a, out_b) = out.split_at_mut(right - 1);
        let left = List { items: a, scratch: sa, first, out: out_a, at: at + 1, centres: centres[0] };
        let (first, at) = (first + middle, at + right);
        let rest = List { items: b, scratch: sb, first, out: out_b, at, centres: centres[1] };
        let (left, rest) = if n > SMALL {
            rayon::join(
                || left.split(way, &mut Filled::new(), depth + 1),
                || rest.split(way, &mut Filled::new(), depth + 1),
            )
        } else {
            (left.split(way, bins, depth + 1), rest.split(way, bins, depth + 1))
        };
        let (costs, cut, all) = inner(way.s, n, &left, &rest);
        me.cut = cut;
        (costs, all)
    }

    /// Where to cut, with the items in that order, and the bounds of the centres on either side.
    fn choose<S: Simd>(
        &mut self,
        s: S,
        by: Split,
        filled: &mut Filled,
        halving: bool,
    ) -> (usize, [Bounds; 2]) {
        let n = self.items.len();
        if by == Split::Sah && !halving {
            let bins = Bins::new(&self.centres, n);
            if n > LARGE {
                let fill = |items: &[Item]| {
                    let mut part = Box::new(Filled::new());
                    part.fill(s, items, &bins);
                    part
                };
                *filled = *reduce(self.items, fill, merge_bins);
            } else {
                filled.fill(s, self.items, &bins);
            }
            if let Some(plane) = filled.best_plane(s, &bins) {
                return partition(s, self.items, self.scratch, plane);
            }
        }
        let spread = |k: &usize| self.centres.extent(*k);
        let axis = (0..3).max_by(|a, b| spread(a).total_cmp(&spread(b))).unwrap_or(0);
        if spread(&axis) > 0.0 {
            // Centres are not negative, so their bits are in order; the face decides where they are equal.
            self.items.select_nth_unstable_by_key(n / 2, |i| (i.centre(axis).to_bits(), i.face()));
        }
        let (a, b) = self.items.split_at(n / 2);
        (n / 2, [centres_of(s, a), centres_of(s, b)])
    }
}

fn leaf<S: Simd>(s: S, items: &[Item]) -> (Costs, Bounds) {
    s.vectorize(
        #[inline(always)]
        || {
            let mut all = Bounds::EMPTY.load(s);
            for item in items {
                all = all.min(item.0.load(s));
            }
            let cost = if items.is_empty() { 0.0 } else { area(all) };
            (Costs::leaf(cost), Bounds(all.to_array()))
        },
    )
}

/// Costs, cut and box of a branch over `n` items, from its halves.
fn inner<S: Simd>(s: S, n: usize, left: &(Costs, Bounds), right: &(Costs, Bounds)) -> (Costs, Cut, Bounds) {
    s.vectorize(
        #[inline(always)]
        || {
            let all = left.1.load(s).min(right.1.load(s));
            let area = area(all);
            let leaf = if n <= BLOCK * Child::MAX_RUN { area * blocks(n as u32) } else { f32::INFINITY };
            let (costs, cut) = Costs::inner(&left.0, &right.0, NODE_COST * area, leaf);
            (costs, cut, Bounds(all.to_array()))
        },
    )
}

#[inline(always)]
fn blocks(n: u32) -> f32 {
    n.div_ceil(BLOCK as u32) as i32 as f32
}

fn centres_of<S: Simd>(s: S, items: &[Item]) -> Bounds {
    s.vectorize(
        #[inline(always)]
        || {
            let mut all = Bounds::EMPTY.load(s);
            for item in items {
                all = all.min(centre(item.0.load(s)));
            }
            Bounds(all.to_array())
        },
    )
}

fn merged(a: Bounds, b: Bounds) -> Bounds {
    let mut all = a;
    for (x, y) in all.0.iter_mut().zip(b.0) {
        *x = x.min(y);
    }
    all
}

/// How centres fall into bins: the bin is the whole part of `(centre - low) scale`.
#[derive(Clone, Copy)]
struct Bins {
    low: [f32; 4],
    scale: [f32; 4],
    count: usize,
}

impl Bins {
    fn new(centres: &Bounds, n: usize) -> Self {
        let count = BINS.min(4 + n / 2);
        let scale = |k: usize| {
            let extent = centres.extent(k);
            // A hair less than the count, so that the last centre falls into the last bin.
            if extent > 1e-30 { count as f32 * 0.9999 / extent } else { 0.0 }
        };
        let [x, y, z, ..] = centres.0;
        Bins { low: [x, y, z, 0.0], scale: [scale(0), scale(1), scale(2), 0.0], count }
    }
}

/// A plane between two bins.
#[derive(Clone, Copy)]
struct Plane {
    axis: usize,
    low: f32,
    scale: f32,
    bin: f32,
}

/// What fell into each bin of each axis: its box and how many.
struct Filled {
    bounds: [[Bounds; BINS]; 3],
    count: [[u32; BINS]; 3],
}

impl Filled {
    fn new() -> Self {
        Filled { bounds: [[Bounds::EMPTY; BINS]; 3], count: [[0; BINS]; 3] }
    }

    fn fill<S: Simd>(&mut self, s: S, items: &[Item], bins: &Bins) {
        s.vectorize(
            #[inline(always)]
            || {
                for axis in 0..3 {
                    self.bounds[axis][..bins.count].fill(Bounds::EMPTY);
                    self.count[axis][..bins.count].fill(0);
                }
                let (low, scale) = (f32x4::load_array(s, bins.low), f32x4::load_array(s, bins.scale));
                for item in items {
                    let bounds = item.0.load(s);
                    let (lower, upper) = bounds.split();
                    let place = (lower - upper - low) * scale;
                    let bin = i32x4::truncate_from(place).to_array();
                    for axis in 0..3 {
                        let bin = bin[axis] as usize % BINS;
                        let slot = &mut self.bounds[axis][bin];
                        *slot = Bounds(slot.load(s).min(bounds).to_array());
                        self.count[axis][bin] += 1;
                    }
                }
            },
        )
    }

    /// The plane of least cost; None if all centres coincide.
    fn best_plane<S: Simd>(&self, s: S, bins: &Bins) -> Option<Plane> {
        s.vectorize(
            #[inline(always)]
            || {
                let (mut least, mut best) = (f32::INFINITY, (0, 0));
                for axis in 0..3 {
                    if bins.scale[axis] == 0.0 {
                        continue;
                    }
                    // Costs of all that lies right of each plane, then a sweep from the left. Where nothing does, the
                    // cost is NaN, which is never least.
                    let mut right = [f32::NAN; BINS];
                    let (mut bounds, mut count) = (Bounds::EMPTY.load(s), 0);
                    for i in (1..bins.count.min(BINS)).rev() {
                        bounds = bounds.min(self.bounds[axis][i].load(s));
                        count += self.count[axis][i];
                        right[i] = area(bounds) * blocks(count);
                    }
                    (bounds, count) = (Bounds::EMPTY.load(s), 0);
                    for bin in 1..bins.count.min(BINS) {
                        bounds = bounds.min(self.bounds[axis][bin - 1].load(s));
                        count += self.count[axis][bin - 1];
                        let cost = area(bounds) * blocks(count) + right[bin];
                        if cost < least {
                            (least, best) = (cost, (axis, bin));
                        }
                    }
                }
                let (axis, bin) = best;
                let (low, scale) = (bins.low[axis], bins.scale[axis]);
                (bin > 0).then_some(Plane { axis, low, scale, bin: bin as f32 })
            },
        )
    }
}

fn merge_bins(mut a: Box<Filled>, b: Box<Filled>) -> Box<Filled> {
    for (x, y) in a.bounds.as_flattened_mut().iter_mut().zip(b.bounds.as_flattened()) {
        *x = merged(*x, *y);
    }
    for (x, y) in a.count.as_flattened_mut().iter_mut().zip(b.count.as_flattened()) {
        *x += y;
    }
    a
}

/// Brings the items left of the plane to the front, in their order; their number, and the bounds of centres on either side.
fn partition<S: Simd>(s: S, items: &mut [Item], scratch: &mut [Item], plane: Plane) -> (usize, [Bounds; 2]) {
    assert!(scratch.len() >= items.len());
    s.vectorize(
        #[inline(always)]
        || {
            let (mut i, mut j) = (0, 0);
            let empty = Bounds::EMPTY.load(s);
            let (mut left, mut right) = (empty, empty);
            let (axis, mirrored) = (plane.axis & 3, (plane.axis & 3) + 4);
            let (low, scale, bin) =
                (f32x8::splat(s, plane.low), f32x8::splat(s, plane.scale), f32x8::splat(s, plane.bin));
            for k in 0..items.len() {
                // The comparison in lanes, so that no branch is left to guess.
                let place =
                    f32x8::splat(s, items[k].0.0[axis]) - f32x8::splat(s, items[k].0.0[mirrored]) - low;
                let before = real::Lanes::less(place * scale, bin);
                let one = <f32x8<S> as real::Lanes>::bits(before) as usize & 1;
                let item = items[k].0.load(s);
                // Written to both, kept in one.
                // Sound: i and j are at most k.
                unsafe {
                    item.store_array(&mut items.get_unchecked_mut(i).0.0);
                    item.store_array(&mut scratch.get_unchecked_mut(j).0.0);
                }
                i += one;
                j += 1 - one;
                let c = centre(item);
                left = left.min(real::Lanes::select(before, c, empty));
                right = right.min(real::Lanes::select(before, empty, c));
            }
            items[i..].copy_from_slice(&scratch[..j]);
            (i, [Bounds(left.to_array()), Bounds(right.to_array())])
        },
    )
}

/// Folds a list, a long one in parts; `merge` must not care for order.
fn reduce<R: Send>(
    list: &[Item],
    of: impl Fn(&[Item]) -> R + Sync,
    merge: impl Fn(R, R) -> R + Sync + Send,
) -> R {
    if list.len() <= LARGE {
        return of(list);
    }
    list.par_chunks(LARGE).map(&of).reduce_with(merge).expect("the list is long")
}
