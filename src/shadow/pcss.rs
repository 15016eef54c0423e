//! Percentage-closer soft shadows: a penumbra as wide as similar triangles between light, blocker and receiver make it.
//!
//! 1. Blocker search: the mean depth of the texels that block, over the region of the map through which the receiver
//!    could see the light past something at the map's least depth; of these, with a frustum search, the ones that
//!    lie between the receiver and the light.
//! 2. Penumbra: w = (d_receiver − d_blocker) / d_blocker · light size, depths being linear along the light's axis.
//! 3. Percentage-closer filtering over w, brought back into the map.
//!
//! Exact for one flat blocker parallel to the light; blockers at several depths are taken as one at their mean.
//!
//! R. Fernando, *Percentage-Closer Soft Shadows*, SIGGRAPH 2005 Sketches.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::shadow::anchor::{Anchor, Bias, Mask, all, light_image, mask, or_answer, put};
use crate::shadow::lookup::{LOT, Map};
use crate::shadow::pattern::{Pattern, Turn};
use crate::shadow::pcf::lit_fraction;
use crate::simd::*;

/// The knobs; `light` is the light's sides along the map's right and up: in world units for a perspective map, as
/// twice the tangent of half the angle that they span for an orthographic one.
pub struct Knobs<'a, T> {
    pub light: [T; 2],
    pub search: &'a Pattern<T>,
    /// Whether only what lies in the frustum from the receiver to the light counts as a blocker.
    pub frustum: bool,
    pub filter: &'a Pattern<T>,
    pub bias: Bias<T>,
}

/// What else the caller may want, each as long as the receivers.
pub type Intermediates<'a, T> = (&'a mut [T], &'a mut [T], &'a mut [T]);

/// What a lot of receivers found.
struct Found<V> {
    lit: V,
    /// Mean depth of the blockers; NaN without any.
    blocker: V,
    /// Width in world units along the larger side of the light; 0 without blockers.
    penumbra: V,
    /// Half the larger side of the search region, in texels.
    search: V,
}

/// The lit fraction of every receiver; blocker depth, penumbra width and search radius beside it if wanted.
pub fn pcss<T: Real, const PERSPECTIVE: bool>(
    watch: &mut dyn Watch,
    map: &Map<'_, T>,
    receivers: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    knobs: &Knobs<'_, T>,
    out: &mut [T],
    more: Option<Intermediates<'_, T>>,
) -> Result<(), Interrupted> {
    let piece = ((1 << 18) / (knobs.search.samples + knobs.filter.samples)).clamp(1, 1 << 13);
    let piece = piece.next_multiple_of(LOT);
    parallel::for_each(
        watch,
        (receivers, normals, out, more),
        piece,
        |first, (p, n, out, more)| dispatch!(s => body::<T, _, PERSPECTIVE>(s, map, first, p, n, knobs, out, more)),
    )
}

#[inline(always)]
fn body<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    first: usize,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    knobs: &Knobs<'_, T>,
    out: &mut [T],
    mut more: Option<Intermediates<'_, T>>,
) {
    let (zero, nan) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::NAN));
    let mut i = 0;
    while i < out.len() {
        let asked = map.asks(first + i, LOT.min(out.len() - i));
        if asked != 0 {
            let a = map.anchor::<S, PERSPECTIVE>(s, points, normals, i, &knobs.bias);
            let found = receivers::<T, S, PERSPECTIVE>(s, map, &a, knobs, (first + i) as u64);
            put::<T, S>(out, i, asked, or_answer::<T, S>(s, &a, found.lit));
            if let Some((blocker, penumbra, search)) = &mut more {
                // NaN of NaN, nothing behind the light.
                let live = mask::<T, S>(s, a.live);
                let nothing = a.answer.simd_eq(a.answer).select(zero, nan);
                put::<T, S>(blocker, i, asked, live.select(found.blocker, nan));
                put::<T, S>(penumbra, i, asked, live.select(found.penumbra, nothing));
                put::<T, S>(search, i, asked, live.select(found.search, nothing));
            }
        }
        i += LOT;
    }
}

#[inline(always)]
fn receivers<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    a: &Anchor<T::V8<S>>,
    knobs: &Knobs<'_, T>,
    index: u64,
) -> Found<T::V8<S>> {
    let (zero, one) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()));
    let nan = all::<T, S>(s, T::NAN);
    // Blocker search.
    let half = light_image::<T, S, PERSPECTIVE>(s, map, a.depth, knobs.light, all::<T, S>(s, map.near));
    let search = Lanes::max(half[0], half[1]);
    let turn = knobs.search.turn(s, index, 0, half);
    let (count, sum) = blockers::<T, S, PERSPECTIVE>(s, map, a, knobs, &turn);
    let mut blocker = sum / count;
    let none = count.simd_eq(zero);
    if none.to_bitmask() & a.live != 0 {
        // Few samples of a wide region may all miss what hides the light's centre: then that alone counts.
        let (depth, blocked) = map.tap::<S, PERSPECTIVE, false>(s, a, (zero, zero));
        blocker = none.select(blocked.select(depth, nan), blocker);
    }
    let found = blocker.simd_eq(blocker);
    if found.to_bitmask() & a.live == 0 {
        return Found { lit: one, blocker: nan, penumbra: zero, search };
    }

    // Penumbra by similar triangles, and the filter.
    let ratio = if PERSPECTIVE { (a.depth - blocker) / blocker } else { a.depth - blocker };
    let penumbra = Lanes::max(ratio, zero) * all::<T, S>(s, knobs.light[0].max(knobs.light[1]));
    let half = light_image::<T, S, PERSPECTIVE>(s, map, a.depth, knobs.light, blocker);
    let turn = knobs.filter.turn(s, index, 1, half);
    let lit = lit_fraction::<T, S, PERSPECTIVE, true>(s, map, a, knobs.filter, &turn);
    Found { lit: found.select(lit, one), blocker, penumbra: found.select(penumbra, zero), search }
}

/// How many taps block, and the sum of their depths.
#[inline(always)]
fn blockers<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    a: &Anchor<T::V8<S>>,
    knobs: &Knobs<'_, T>,
    turn: &Turn<T::V8<S>>,
) -> (T::V8<S>, T::V8<S>) {
    let (zero, one) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()));
    let sides = frustum::<T, S, PERSPECTIVE>(s, map, a, knobs.light);
    let (mut count, mut sum) = (zero, zero);
    for point in 0..knobs.search.samples {
        let offsets = knobs.search.offsets(s, point, turn);
        let (depth, blocked) = map.tap::<S, PERSPECTIVE, true>(s, a, offsets);
        let blocked = if knobs.frustum {
            blocked & in_frustum::<T, S, PERSPECTIVE>(sides, offsets, depth)
        } else {
            blocked
        };
        count += blocked.select(one, zero);
        sum += blocked.select(depth, zero);
    }
    (count, sum)
}

/// What tells whether texels at offsets and depths lie between receivers and the light's sides, by half a texel at
/// least: |o| <= (1/z − 1/d) c + 1/2, or (d − z) c + 1/2, without a division. z is positive, and infinite only where
/// nothing blocks.
#[inline(always)]
fn frustum<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    a: &Anchor<T::V8<S>>,
    light: [T; 2],
) -> [[T::V8<S>; 2]; 2] {
    let half = T::of(0.5);
    let (cx, cy) = (light[0] * map.scale[0] * half, light[1] * map.scale[1] * half);
    let (cx, cy, half) = (all::<T, S>(s, cx), all::<T, S>(s, cy), all::<T, S>(s, half));
    if PERSPECTIVE {
        [[cx, cx / a.depth - half], [cy, cy / a.depth - half]]
    } else {
        [[cx, cx * a.depth + half], [cy, cy * a.depth + half]]
    }
}

#[inline(always)]
fn in_frustum<T: Real, S: Simd, const PERSPECTIVE: bool>(
    [[cx, kx], [cy, ky]]: [[T::V8<S>; 2]; 2],
    (ox, oy): (T::V8<S>, T::V8<S>),
    depth: T::V8<S>,
) -> Mask<T, S> {
    let (ox, oy) = (Lanes::abs(ox), Lanes::abs(oy));
    if PERSPECTIVE {
        ((ox + kx) * depth).simd_le(cx) & ((oy + ky) * depth).simd_le(cy)
    } else {
        (ox + depth * cx).simd_le(kx) & (oy + depth * cy).simd_le(ky)
    }
}
