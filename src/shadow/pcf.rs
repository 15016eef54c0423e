//! Percentage-closer filtering: the share of texels around a receiver that do not block it.
//!
//! W. Reeves, D. Salesin, R. Cook, *Rendering Antialiased Shadows with Depth Maps*, 1987.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::shadow::anchor::{Anchor, Bias, all, limited, or_answer, put};
use crate::shadow::lookup::{LOT, Map};
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
    let piece = ((1 << 18) / pattern.samples).clamp(1, 1 << 13).next_multiple_of(LOT);
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
    let mut i = 0;
    while i < out.len() {
        let asked = map.asks(first + i, LOT.min(out.len() - i));
        if asked != 0 {
            let a = map.anchor::<S, PERSPECTIVE>(s, points, normals, i, bias);
            let [x, y] = [all::<T, S>(s, map.scale[0]), all::<T, S>(s, map.scale[1])];
            let half = match radius {
                Radius::Texels(r) => [all::<T, S>(s, r); 2],
                Radius::World(r) => {
                    let r = all::<T, S>(s, r);
                    let r = if PERSPECTIVE { r / a.depth } else { r };
                    [r * x, r * y]
                }
            };
            let half = limited::<T, S>(s, map, half);
            let turn = pattern.turn(s, (first + i) as u64, 0, half);
            let lit = if bilinear {
                between::<T, S, PERSPECTIVE>(s, map, &a, pattern, &turn)
            } else {
                lit_fraction::<T, S, PERSPECTIVE, false>(s, map, &a, pattern, &turn)
            };
            put::<T, S>(out, i, asked, or_answer::<T, S>(s, &a, lit));
        }
        i += LOT;
    }
}

/// The share of taps that do not block.
#[inline(always)]
pub fn lit_fraction<T: Real, S: Simd, const PERSPECTIVE: bool, const NEARER: bool>(
    s: S,
    map: &Map<'_, T>,
    anchor: &Anchor<T::V8<S>>,
    pattern: &Pattern<T>,
    turn: &Turn<T::V8<S>>,
) -> T::V8<S> {
    let (zero, one) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()));
    let mut count = zero;
    for point in 0..pattern.samples {
        let offsets = pattern.offsets(s, point, turn);
        let (_, blocked) = map.tap::<S, PERSPECTIVE, NEARER>(s, anchor, offsets);
        count += blocked.select(one, zero);
    }
    one - count / all::<T, S>(s, T::of(pattern.samples as f64))
}

/// The same with taps between texels: a mean of comparisons that moves smoothly with the receiver.
#[inline(always)]
fn between<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    anchor: &Anchor<T::V8<S>>,
    pattern: &Pattern<T>,
    turn: &Turn<T::V8<S>>,
) -> T::V8<S> {
    let (zero, one) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()));
    let middle = all::<T, S>(s, T::of(0.5));
    let (x, y) = (anchor.x, anchor.y);
    let mut sums = zero;
    for point in 0..pattern.samples {
        let (ox, oy) = pattern.offsets(s, point, turn);
        let (px, py) = (x + ox - middle, y + oy - middle);
        let (ix, iy) = (SimdFloat::floor(px), SimdFloat::floor(py));
        let (fx, fy) = (px - ix, py - iy);
        // To the centres of the four texels.
        let (cx, cy) = (ix + middle - x, iy + middle - y);
        for corner in 0..4 {
            let (right, down) = (corner & 1 == 1, corner & 2 == 2);
            let (dx, wx) = if right { (cx + one, fx) } else { (cx, one - fx) };
            let (dy, wy) = if down { (cy + one, fy) } else { (cy, one - fy) };
            let (_, blocked) = map.tap::<S, PERSPECTIVE, false>(s, anchor, (dx, dy));
            sums += blocked.select(wx * wy, zero);
        }
    }
    // Rounding of the weights must not make more than all of it dark.
    Lanes::max(one - sums / all::<T, S>(s, T::of(pattern.samples as f64)), zero)
}
