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
use crate::shadow::lookup::{Anchor, Bias, Map, all, at, light_image};
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

/// What one receiver found.
struct Found<T> {
    lit: T,
    /// Mean depth of the blockers; NaN without any.
    blocker: T,
    /// Width in world units along the larger side of the light; 0 without blockers.
    penumbra: T,
    /// Half the larger side of the search region, in texels.
    search: T,
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
    for i in 0..out.len() {
        if map.skips(first + i) {
            continue;
        }
        let found = match map.anchor::<PERSPECTIVE>(points[i], at(normals, i), &knobs.bias) {
            Ok(a) => receiver::<T, S, PERSPECTIVE>(s, map, &a, knobs, (first + i) as u64),
            Err(answer) if answer.is_nan() => {
                Found { lit: answer, blocker: answer, penumbra: answer, search: answer }
            }
            Err(answer) => Found { lit: answer, blocker: T::NAN, penumbra: T::zero(), search: T::zero() },
        };
        out[i] = found.lit;
        if let Some((blocker, penumbra, search)) = &mut more {
            (blocker[i], penumbra[i], search[i]) = (found.blocker, found.penumbra, found.search);
        }
    }
}

#[inline(always)]
fn receiver<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    a: &Anchor<T>,
    knobs: &Knobs<'_, T>,
    index: u64,
) -> Found<T> {
    // Blocker search.
    let limit = map.extent() + map.extent();
    let half = light_image::<T, PERSPECTIVE>(map, a.depth, knobs.light, map.near);
    let half = [half[0].min(limit), half[1].min(limit)];
    let search = half[0].max(half[1]);
    let turn = knobs.search.turn(index, 0);
    let (count, mut blocker) = mean_blocker::<T, S, PERSPECTIVE>(s, map, a, knobs, turn, half);
    if count == 0 {
        // Few samples of a wide region may all miss what hides the light's centre: then that alone counts.
        blocker = match map.blocker_here::<PERSPECTIVE>(a) {
            Some(depth) => depth,
            None => return Found { lit: T::one(), blocker: T::NAN, penumbra: T::zero(), search },
        };
    }

    // Penumbra by similar triangles, and the filter.
    let ratio = if PERSPECTIVE { (a.depth - blocker) / blocker } else { a.depth - blocker };
    let penumbra = ratio.max(T::zero()) * knobs.light[0].max(knobs.light[1]);
    let turn = knobs.filter.turn(index, 1);
    let half = light_image::<T, PERSPECTIVE>(map, a.depth, knobs.light, blocker);
    let lit = lit_fraction::<T, S, PERSPECTIVE, true>(s, map, a, knobs.filter, turn, half);
    Found { lit, blocker, penumbra, search }
}

/// How many taps block, and their mean depth.
#[inline(always)]
fn mean_blocker<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    a: &Anchor<T>,
    knobs: &Knobs<'_, T>,
    turn: Turn<T>,
    half: [T; 2],
) -> (u32, T) {
    let pattern = knobs.search;
    let mut count = 0;
    // One sum a lane, so that its order is the same at every SIMD level.
    let mut sums = all::<T, S>(s, T::zero());
    for block in 0..pattern.blocks() {
        let offsets = pattern.offsets(s, block, turn, half);
        let (depth, blocked) = map.taps::<S, PERSPECTIVE, true>(s, a, offsets);
        let active = pattern.active(block);
        let blocked = if knobs.frustum {
            blocked & in_frustum::<T, S, PERSPECTIVE>(s, map, a, knobs.light, offsets, depth)
        } else {
            blocked
        };
        let blocked = blocked & <<T::V8<S> as SimdBase<S>>::Mask as SimdMask<S>>::from_bitmask(s, active);
        count += blocked.to_bitmask().count_ones();
        sums += blocked.select(depth, all::<T, S>(s, T::zero()));
    }
    let mut sum = T::zero();
    for &lane in sums.as_slice() {
        sum += lane;
    }
    (count, sum / T::of(f64::from(count)))
}

/// Whether texels at offsets and depths lie between the receiver and the light's sides, by half a texel at least.
#[inline(always)]
fn in_frustum<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    a: &Anchor<T>,
    light: [T; 2],
    (ox, oy): (T::V8<S>, T::V8<S>),
    depth: T::V8<S>,
) -> <T::V8<S> as SimdBase<S>>::Mask {
    // |o| <= (1/z - 1/d) c + 1/2, or (d - z) c + 1/2, without a division: z is positive, and infinite only where nothing
    // blocks.
    let half = T::of(0.5);
    let (cx, cy) = (light[0] * map.scale[0] * half, light[1] * map.scale[1] * half);
    let (ox, oy) = (Lanes::abs(ox), Lanes::abs(oy));
    if PERSPECTIVE {
        let (kx, ky) = (cx / a.depth - half, cy / a.depth - half);
        ((ox + all::<T, S>(s, kx)) * depth).simd_le(all::<T, S>(s, cx))
            & ((oy + all::<T, S>(s, ky)) * depth).simd_le(all::<T, S>(s, cy))
    } else {
        let (kx, ky) = (cx * a.depth + half, cy * a.depth + half);
        (ox + depth * all::<T, S>(s, cx)).simd_le(all::<T, S>(s, kx))
            & (oy + depth * all::<T, S>(s, cy)).simd_le(all::<T, S>(s, ky))
    }
}
