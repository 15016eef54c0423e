//! Soft shadows of constant cost: two means over boxes in place of a search and a filter by many taps.
//!
//! 1. The moments over the region in which the light could be hidden bound the share of it that blocks. The blockers'
//!    mean depth follows from the mean of all, if what does not block lies at the receiver's depth; four moments tell it
//!    themselves.
//! 2. Penumbra by similar triangles, as in [`crate::shadow::pcss`].
//! 3. The bound once more, over the penumbra.
//!
//! B. Yang et al., *Variance Soft Shadow Mapping*, Pacific Graphics 2010. A. Lauritzen, *Summed-Area Variance Shadow
//! Maps*, GPU Gems 3, 2007. C. Peters et al., *Improved Moment Shadow Maps …*, JCGT 2017 (blockers from four moments).

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::shadow::anchor::{all, light_image, mask, put};
use crate::shadow::filtered::Filtered;
use crate::shadow::lookup::{LOT, Map};
use crate::shadow::moment_map::Stored;
use crate::shadow::tested::{Granted, Test, placed, tested};
use crate::shadow::variance::without_bleeding;
use crate::simd::*;

/// What a lot of receivers found: see [`crate::shadow::pcss`].
#[derive(Clone, Copy)]
struct Soft<V> {
    lit: V,
    blocker: V,
    penumbra: V,
    search: V,
}

/// Blocker depth, penumbra width, half the search region in texels.
pub type Intermediates<'a, T> = (&'a mut [T], &'a mut [T], &'a mut [T]);

/// A share of blockers below this is none: bounds are seldom exactly 1.
const NONE: f64 = 1e-3;

/// The lit fraction of every receiver. `light` is as in [`crate::shadow::pcss`]; `search_slope` is the bias by slope of
/// the search, where that of `granted` is the filter's.
pub fn variance_soft<T: Real, E: Stored, const C: usize>(
    watch: &mut dyn Watch,
    map: &Map<'_, T>,
    perspective: bool,
    filtered: &Filtered<'_, T, E, C>,
    receivers: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    test: &Test<T>,
    granted: &Granted<T>,
    light: [T; 2],
    search_slope: T,
    out: &mut [T],
    more: Option<Intermediates<'_, T>>,
) -> Result<(), Interrupted> {
    let light = Light { sides: light, search_slope };
    parallel::for_each(watch, (receivers, normals, out, more), 1 << 13, |first, (p, n, out, mut more)| {
        dispatch!(s => {
            let mut i = 0;
            while i < out.len() {
                let asked = map.asks(first + i, LOT.min(out.len() - i));
                let found = lot(s, map, perspective, filtered, p, n, i, asked, test, granted, &light);
                put::<T, _>(out, i, asked, found.lit);
                if let Some((blocker, penumbra, search)) = &mut more {
                    put::<T, _>(blocker, i, asked, found.blocker);
                    put::<T, _>(penumbra, i, asked, found.penumbra);
                    put::<T, _>(search, i, asked, found.search);
                }
                i += LOT;
            }
        })
    })
}

struct Light<T> {
    sides: [T; 2],
    search_slope: T,
}

#[inline(always)]
fn lot<T: Real, E: Stored, S: Simd, const C: usize>(
    s: S,
    map: &Map<'_, T>,
    perspective: bool,
    filtered: &Filtered<'_, T, E, C>,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    i: usize,
    asked: u64,
    test: &Test<T>,
    granted: &Granted<T>,
    light: &Light<T>,
) -> Soft<T::V8<S>> {
    let (zero, one, nan) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()), all::<T, S>(s, T::NAN));
    let (feet, gain, live) = placed(s, map, perspective, points, normals, i, asked, granted.normal_offset);
    let near = all::<T, S>(s, map.near);
    let half = if perspective {
        light_image::<T, S, true>(s, map, feet.depth, light.sides, near)
    } else {
        light_image::<T, S, false>(s, map, feet.depth, light.sides, near)
    };
    let here = mask::<T, S>(s, live);
    let nothing = feet.answer.simd_eq(feet.answer).select(zero, nan);
    let search = here.select(Lanes::max(half[0], half[1]), nothing);

    let searched = Granted { slope: light.search_slope, ..*granted };
    let first = tested(s, live, filtered, test, &searched, &feet, gain, half);
    // NaN goes on.
    let lit = first.lit.simd_gt(all::<T, S>(s, T::of(1.0 - NONE)));
    let live = live & !lit.to_bitmask();
    if live == 0 {
        return Soft { lit: here.select(one, feet.answer), blocker: nan, penumbra: nothing, search };
    }
    let blocker = Lanes::min(Lanes::max(filtered.warp.back(first.blocker), near), feet.depth);
    let ratio = if perspective { (feet.depth - blocker) / blocker } else { feet.depth - blocker };
    let penumbra = Lanes::max(ratio, zero) * all::<T, S>(s, light.sides[0].max(light.sides[1]));
    let half = if perspective {
        light_image::<T, S, true>(s, map, feet.depth, light.sides, blocker)
    } else {
        light_image::<T, S, false>(s, map, feet.depth, light.sides, blocker)
    };
    let second = tested(s, live, filtered, test, granted, &feet, gain, half);
    let shaded = mask::<T, S>(s, live);
    let second = without_bleeding(second.lit, all::<T, S>(s, granted.bleeding));
    Soft {
        lit: shaded.select(second, here.select(one, feet.answer)),
        blocker: shaded.select(blocker, nan),
        penumbra: shaded.select(penumbra, nothing),
        search,
    }
}
