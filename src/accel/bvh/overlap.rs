//! Which faces overlap a box: the tree's boxes by comparison, triangles by all thirteen axes (exact, see
//! [`crate::geometry::triangle_aabb`]). Touching counts.

use super::Bvh;
use super::node::{Child, Entry, Stack};
use super::single::{next, planes, splat8};
use crate::accel::block::{BLOCK, Block};
use crate::accel::lists::{OutOfMemory, lists, zeros};
use crate::dispatch;
use crate::geometry::triangle_aabb::triangle_aabb;
use crate::parallel::{Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use std::sync::atomic::{AtomicBool, Ordering};

/// Boxes a task.
const PIECE: usize = 16;
/// So many faces may take long for a single box.
const LARGE: usize = 1 << 16;

impl<T: Real> Bvh<T> {
    /// Appends the faces that overlap the box from `low` to `high`, in rising order.
    #[inline(always)]
    fn overlap<S: Simd>(
        &self,
        s: S,
        [low, high]: [[T; 3]; 2],
        found: &mut Vec<i32>,
        stop: &AtomicBool,
    ) -> Result<(), OutOfMemory> {
        let before = found.len();
        let mut stack = Stack::new();
        stack.push(Entry::new(T::zero(), Child::ROOT));
        while let Some(entry) = stack.pop() {
            let child = entry.child();
            if child.is_leaf() {
                let blocks = self.run(child);
                found.try_reserve(blocks.len() * BLOCK)?;
                blocks.iter().for_each(|block| faces(block, [low, high], found));
                if stop.load(Ordering::Relaxed) {
                    return Ok(());
                }
                continue;
            }
            let node = self.node(child);
            let mut meets = Lanes::less_eq(planes(s, node, 0, 0), splat8::<T, S>(s, high[0]))
                & Lanes::less_eq(splat8::<T, S>(s, low[0]), planes(s, node, 1, 0));
            for k in 1..3 {
                meets = meets
                    & Lanes::less_eq(planes(s, node, 0, k), splat8::<T, S>(s, high[k]))
                    & Lanes::less_eq(splat8::<T, S>(s, low[k]), planes(s, node, 1, k));
            }
            let mut bits = T::V8::<S>::bits(meets);
            while let Some(entry) = next(&mut bits, node, &[T::zero(); 8]) {
                stack.push(entry);
            }
        }
        found[before..].sort_unstable();
        Ok(())
    }
}

/// Appends the faces of a block that overlap a box.
fn faces<T: Real>(block: &Block<T>, [low, high]: [[T; 3]; 2], found: &mut Vec<i32>) {
    for l in (0..BLOCK).filter(|&l| block.faces[l] >= 0) {
        let corners = block.vertices.map(|v| v.map(|x| x[l]));
        let beyond =
            |k: usize| corners.iter().all(|p| p[k] < low[k]) || corners.iter().all(|p| p[k] > high[k]);
        let within = |p: &[T; 3]| (0..3).all(|k| low[k] <= p[k] && p[k] <= high[k]);
        let meets = !(0..3).any(beyond) && (corners.iter().any(within) || exactly(corners, [low, high]));
        if meets {
            found.push(block.faces[l]);
        }
    }
}

#[inline(never)]
fn exactly<T: Real>(corners: [[T; 3]; 3], bounds: [[T; 3]; 2]) -> bool {
    triangle_aabb(corners.map(|p| p.map(|x| x.to_f64())), bounds.map(|p| p.map(|x| x.to_f64())))
}

/// The faces that overlap each box: those of box `i` stand from `offsets[i]` to `offsets[i + 1]`, in rising order.
pub fn overlaps<T: Real>(
    watch: &mut dyn Watch,
    tree: &Bvh<T>,
    low: &[[T; 3]],
    high: &[[T; 3]],
) -> Result<Result<(Vec<i64>, Vec<i32>), OutOfMemory>, Interrupted> {
    let all = lists(watch, low.len(), PIECE, tree.faces > LARGE, |i, found, stop| {
        let (low, high) = (low[i], high[i]);
        // What is no box, by its order or by NaN, overlaps nothing.
        if !(0..3).all(|k| low[k] <= high[k]) {
            return Ok(());
        }
        dispatch!(s => tree.overlap(s, [low, high], found, stop))
    })?;
    let Ok(all) = all else { return Ok(Err(OutOfMemory)) };
    let Ok(mut faces) = zeros::<i32>(all.total()) else { return Ok(Err(OutOfMemory)) };
    let offsets = all.bring(watch, &mut faces[..], |into: &mut &mut [i32], i, face| into[i] = face)?;
    Ok(Ok((offsets, faces)))
}
