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
use crate::shadow::tested::{Granted, PAIR, Placed, Test, pair, tested};
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
                let lots = pair(s, map, perspective, p, n, first, i, granted.normal_offset);
                let found = both(s, map, perspective, filtered, &lots, test, granted, &light);
                for j in 0..PAIR {
                    let (asked, i) = (lots[j].asked, i + j * LOT);
                    put::<T, _>(out, i, asked, found[j].lit);
                    if let Some((blocker, penumbra, search)) = &mut more {
                        put::<T, _>(blocker, i, asked, found[j].blocker);
                        put::<T, _>(penumbra, i, asked, found[j].penumbra);
                        put::<T, _>(search, i, asked, found[j].search);
                    }
                }
                i += PAIR * LOT;
            }
        })
    })
}

struct Light<T> {
    sides: [T; 2],
    search_slope: T,
}

/// Half the region, in texels, over which blockers at a depth hide the light.
#[inline(always)]
fn seen<T: Real, S: Simd>(
    s: S,
    map: &Map<'_, T>,
    perspective: bool,
    light: &Light<T>,
    depth: T::V8<S>,
    blocker: T::V8<S>,
) -> [T::V8<S>; 2] {
    if perspective {
        light_image::<T, S, true>(s, map, depth, light.sides, blocker)
    } else {
        light_image::<T, S, false>(s, map, depth, light.sides, blocker)
    }
}

/// Two lots, at each step together: see [`Test::blockers`].
#[inline(always)]
fn both<T: Real, E: Stored, S: Simd, const C: usize>(
    s: S,
    map: &Map<'_, T>,
    perspective: bool,
    filtered: &Filtered<'_, T, E, C>,
    lots: &[Placed<T::V8<S>>; PAIR],
    test: &Test<T>,
    granted: &Granted<T>,
    light: &Light<T>,
) -> [Soft<T::V8<S>>; PAIR] {
    let (zero, one, nan) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()), all::<T, S>(s, T::NAN));
    let near = all::<T, S>(s, map.near);
    let half = [
        seen(s, map, perspective, light, lots[0].feet.depth, near),
        seen(s, map, perspective, light, lots[1].feet.depth, near),
    ];
    let searched = Granted { slope: light.search_slope, ..*granted };
    let first = tested(s, filtered, test, &searched, lots, half);

    let mut found = [Soft { lit: one, blocker: nan, penumbra: nan, search: nan }; PAIR];
    let (mut shaded, mut half) = (*lots, half);
    for j in 0..PAIR {
        let (feet, here) = (&lots[j].feet, mask::<T, S>(s, lots[j].live));
        let nothing = feet.answer.simd_eq(feet.answer).select(zero, nan);
        // NaN goes on.
        let lit = first[j].lit.simd_gt(all::<T, S>(s, T::of(1.0 - NONE)));
        shaded[j].live &= !lit.to_bitmask();
        let blocker = Lanes::min(Lanes::max(filtered.warp.back(first[j].blocker), near), feet.depth);
        let ratio = if perspective { (feet.depth - blocker) / blocker } else { feet.depth - blocker };
        let penumbra = Lanes::max(ratio, zero) * all::<T, S>(s, light.sides[0].max(light.sides[1]));
        let shade = mask::<T, S>(s, shaded[j].live);
        found[j] = Soft {
            lit: here.select(one, feet.answer),
            blocker: shade.select(blocker, nan),
            penumbra: shade.select(penumbra, nothing),
            search: here.select(Lanes::max(half[j][0], half[j][1]), nothing),
        };
        half[j] = seen(s, map, perspective, light, feet.depth, blocker);
    }
    if shaded[0].live | shaded[1].live == 0 {
        return found;
    }
    let second = tested(s, filtered, test, granted, &shaded, half);
    for j in 0..PAIR {
        let lit = without_bleeding(second[j].lit, all::<T, S>(s, granted.bleeding));
        found[j].lit = mask::<T, S>(s, shaded[j].live).select(lit, found[j].lit);
    }
    found
}
