//! The kd-tree: cells parted by planes across axes, put where they pay most.
//!
//! - [`Method::Sah`]: the plane of least expected cost by the surface area heuristic, with a bonus for cutting off empty
//!   space; among all edges of boxes in small cells, among equally spaced planes in large ones.
//! - [`Method::Median`]: the median of centres, across the axis along which they spread most.
//!
//! J. L. Bentley, *Multidimensional Binary Search Trees Used for Associative Searching*, 1975. V. Havran, *Heuristic Ray
//! Shooting Algorithms*, 2000. M. Shevtsov, A. Soupikov, A. Kapustin, *Highly Parallel Fast KD-tree Construction*, 2007.

use super::cells::Corners;
use super::halving::{Halving, Rule, parted};
use super::structure::half_surface;
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Sah,
    Median,
}

/// Cells of fewer triangles try every edge of a box.
const SMALL: usize = 64;
const BINS: usize = 32;
/// What a plane costs, where a triangle costs one: four are tested together.
const PLANE_COST: f64 = 0.5;
/// Cells that hold nothing cost nothing, not even their borders.
const EMPTY_BONUS: f64 = 0.8;

struct Choice {
    method: Method,
    leaf_size: usize,
}

/// A tree over triangles whose leaves hold at most `leaf_size`, unless it is `max_depth` deep or parting does not pay.
pub fn build<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    method: Method,
    leaf_size: usize,
    max_depth: usize,
) -> Result<Halving<T>, Interrupted> {
    Halving::build(watch, positions, faces, &Choice { method, leaf_size }, max_depth)
}

impl<T: Real> Rule<T> for Choice {
    fn plane(&self, faces: &[u32], boxes: &[Corners<T>], cell: &Corners<T>, _: usize) -> Option<(usize, T)> {
        if faces.len() <= self.leaf_size {
            return None;
        }
        match self.method {
            Method::Median => median(faces, boxes, cell),
            Method::Sah => sah(faces, boxes, cell),
        }
    }
}

fn median<T: Real>(faces: &[u32], boxes: &[Corners<T>], cell: &Corners<T>) -> Option<(usize, T)> {
    let half = T::of(0.5);
    let centre = |face: u32, k: usize| (boxes[face as usize][0][k] + boxes[face as usize][1][k]) * half;
    let spread: [T; 3] = std::array::from_fn(|k| {
        let all = faces.iter().map(|&f| centre(f, k));
        let (low, high) = all.fold((T::INFINITY, -T::INFINITY), |(l, h), c| {
            (if c < l { c } else { l }, if c > h { c } else { h })
        });
        high - low
    });
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| spread[b].partial_cmp(&spread[a]).unwrap_or(std::cmp::Ordering::Equal));
    axes.into_iter().find_map(|k| {
        let mut centres: Vec<T> = faces.iter().map(|&f| centre(f, k)).collect();
        let middle = centres.len() / 2;
        let (_, &mut at, _) = centres
            .select_nth_unstable_by(middle, |a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        // It must lie inside, and leave something out on either side.
        let inside = cell[0][k] < at && at < cell[1][k];
        let below = faces.iter().any(|&f| boxes[f as usize][1][k] <= at);
        let above = faces.iter().any(|&f| boxes[f as usize][0][k] >= at && boxes[f as usize][1][k] > at);
        (inside && below && above).then_some((k, at))
    })
}

fn sah<T: Real>(faces: &[u32], boxes: &[Corners<T>], cell: &Corners<T>) -> Option<(usize, T)> {
    let n = faces.len();
    let whole = half_surface(*cell);
    // A cell without surface is passed by as many lines as any other.
    let chance = |part: &Corners<T>| if whole > 0.0 { half_surface(*part) / whole } else { 1.0 };
    let mut best: Option<(f64, usize, T)> = None;
    let mut offer = |axis: usize, at: T, below: usize, above: usize| {
        if !(cell[0][axis] < at && at < cell[1][axis]) {
            return;
        }
        let halves = parted(cell, axis, at);
        let bonus = if below == 0 || above == 0 { EMPTY_BONUS } else { 1.0 };
        let cost = chance(&halves[0]) * below as f64 + chance(&halves[1]) * above as f64;
        let cost = PLANE_COST + bonus * cost;
        if cost < n as f64 && best.is_none_or(|(least, _, _)| cost < least) {
            best = Some((cost, axis, at));
        }
    };
    for axis in 0..3 {
        if n <= SMALL {
            edges(faces, boxes, axis, &mut offer);
        } else {
            bins(faces, boxes, cell, axis, &mut offer);
        }
    }
    best.map(|(_, axis, at)| (axis, at))
}

/// Offers every lower and upper edge of a box.
fn edges<T: Real>(
    faces: &[u32],
    boxes: &[Corners<T>],
    axis: usize,
    offer: &mut impl FnMut(usize, T, usize, usize),
) {
    let range = |&f: &u32| [boxes[f as usize][0][axis], boxes[f as usize][1][axis]];
    let sorted = |list: &mut dyn Iterator<Item = T>| {
        let mut list: Vec<T> = list.collect();
        list.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        list
    };
    let low = sorted(&mut faces.iter().map(|f| range(f)[0]));
    let high = sorted(&mut faces.iter().map(|f| range(f)[1]));
    // Boxes that lie in a plane stand below it.
    let flat = sorted(&mut faces.iter().map(range).filter(|r| r[0] == r[1]).map(|r| r[0]));
    for &at in low.iter().chain(&high) {
        let in_plane = flat.partition_point(|&x| x <= at) - flat.partition_point(|&x| x < at);
        let above = high.len() - high.partition_point(|&x| x <= at);
        offer(axis, at, low.partition_point(|&x| x < at) + in_plane, above);
    }
}

/// Offers equally spaced planes.
fn bins<T: Real>(
    faces: &[u32],
    boxes: &[Corners<T>],
    cell: &Corners<T>,
    axis: usize,
    offer: &mut impl FnMut(usize, T, usize, usize),
) {
    let (low, extent) = (cell[0][axis], cell[1][axis] - cell[0][axis]);
    if !(extent > T::zero()) {
        return;
    }
    let scale = BINS as f64 / extent.to_f64();
    let bin = |x: T| (((x - low).to_f64() * scale).max(0.0) as usize).min(BINS - 1);
    let (mut begin, mut end) = ([0usize; BINS], [0usize; BINS]);
    for &face in faces {
        begin[bin(boxes[face as usize][0][axis])] += 1;
        end[bin(boxes[face as usize][1][axis])] += 1;
    }
    let (mut below, mut above) = (0, faces.len());
    for i in 1..BINS {
        below += begin[i - 1];
        above -= end[i - 1];
        offer(axis, low + extent * T::of(i as f64 / BINS as f64), below, above);
    }
}
