//! Percentage-closer filtering: the share of texels around a receiver that do not block it.
//!
//! W. Reeves, D. Salesin, R. Cook, *Rendering Antialiased Shadows with Depth Maps*, 1987.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::shadow::lookup::{Anchor, Bias, Map, all, at};
use crate::shadow::pattern::{Pattern, Turn};
use crate::simd::*;

/// Half the filter's side, along the light plane at the receiver.
#[derive(Clone, Copy)]
pub enum Radius<T> {
    World(T),
    Texels(T),
}

/// The lit fraction of every receiver. With `bilinear` each tap compares the four texels about it and weights them by
/// their nearness, as hardware does. `normals` is empty or as long as `receivers`.
pub fn pcf<T: Real, const PERSPECTIVE: bool>(
    watch: &mut dyn Watch,
    map: &Map<'_, T>,
    receivers: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    pattern: &Pattern<T>,
    radius: Radius<T>,
    bilinear: bool,
    bias: &Bias<T>,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let piece = ((1 << 18) / pattern.samples).clamp(1, 1 << 13);
    parallel::for_each(
        watch,
        (receivers, normals, out),
        piece,
        |first, (p, n, out)| dispatch!(s => body::<T, _, PERSPECTIVE>(s, map, first, p, n, pattern, radius, bilinear, bias, out)),
    )
}

#[inline(always)]
fn body<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    first: usize,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    pattern: &Pattern<T>,
    radius: Radius<T>,
    bilinear: bool,
    bias: &Bias<T>,
    out: &mut [T],
) {
    for i in 0..out.len() {
        if map.skips(first + i) {
            continue;
        }
        let a = match map.anchor::<PERSPECTIVE>(points[i], at(normals, i), bias) {
            Ok(a) => a,
            Err(answer) => {
                out[i] = answer;
                continue;
            }
        };
        let half = match radius {
            Radius::Texels(r) => [r; 2],
            Radius::World(r) => {
                let r = if PERSPECTIVE { r / a.depth } else { r };
                [r * map.scale[0], r * map.scale[1]]
            }
        };
        let turn = pattern.turn((first + i) as u64, 0);
        out[i] = if bilinear {
            between::<T, S, PERSPECTIVE>(s, map, &a, pattern, turn, half)
        } else {
            lit_fraction::<T, S, PERSPECTIVE, false>(s, map, &a, pattern, turn, half)
        };
    }
}

/// The share of taps that do not block, over a filter of half sides `half` in texels.
#[inline(always)]
pub fn lit_fraction<T: Real, S: Simd, const PERSPECTIVE: bool, const NEARER: bool>(
    s: S,
    map: &Map<'_, T>,
    anchor: &Anchor<T>,
    pattern: &Pattern<T>,
    turn: Turn<T>,
    half: [T; 2],
) -> T {
    // Filters beyond twice the map's extent see nothing more.
    let limit = map.extent() + map.extent();
    let half = [half[0].min(limit), half[1].min(limit)];
    let mut count = 0;
    for block in 0..pattern.blocks() {
        let offsets = pattern.offsets(s, block, turn, half);
        let (_, blocked) = map.taps::<S, PERSPECTIVE, NEARER>(s, anchor, offsets);
        count += (blocked.to_bitmask() & pattern.active(block)).count_ones();
    }
    T::one() - T::of(f64::from(count)) / T::of(pattern.samples as f64)
}

/// The same with taps between texels: a mean of comparisons that moves smoothly with the receiver.
#[inline(always)]
fn between<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    anchor: &Anchor<T>,
    pattern: &Pattern<T>,
    turn: Turn<T>,
    half: [T; 2],
) -> T {
    let limit = map.extent() + map.extent();
    let half = [half[0].min(limit), half[1].min(limit)];
    let (zero, one, middle) =
        (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()), all::<T, S>(s, T::of(0.5)));
    let (x, y) = (all::<T, S>(s, anchor.x), all::<T, S>(s, anchor.y));
    let mut sums = zero;
    for block in 0..pattern.blocks() {
        let (ox, oy) = pattern.offsets(s, block, turn, half);
        let (px, py) = (x + ox - middle, y + oy - middle);
        let (ix, iy) = (SimdFloat::floor(px), SimdFloat::floor(py));
        let (fx, fy) = (px - ix, py - iy);
        // To the centres of the four texels.
        let (cx, cy) = (ix + middle - x, iy + middle - y);
        let padding =
            <<T::V8<S> as SimdBase<S>>::Mask as SimdMask<S>>::from_bitmask(s, pattern.active(block));
        for corner in 0..4 {
            let (right, down) = (corner & 1 == 1, corner & 2 == 2);
            let (dx, wx) = if right { (cx + one, fx) } else { (cx, one - fx) };
            let (dy, wy) = if down { (cy + one, fy) } else { (cy, one - fy) };
            let (_, blocked) = map.taps::<S, PERSPECTIVE, false>(s, anchor, (dx, dy));
            sums += (blocked & padding).select(wx * wy, zero);
        }
    }
    let mut sum = T::zero();
    for &lane in sums.as_slice() {
        sum += lane;
    }
    // Rounding of the weights must not make more than all of it dark.
    (T::one() - sum / T::of(pattern.samples as f64)).max(T::zero())
}
