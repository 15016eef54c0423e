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
use crate::shadow::filtered::Filtered;
use crate::shadow::lookup::{Map, at, light_image};
use crate::shadow::moment_map::Stored;
use crate::shadow::tested::{Granted, Test, tested};
use crate::shadow::variance::without_bleeding;

/// What one receiver found: see [`crate::shadow::pcss`].
#[derive(Clone, Copy)]
struct Soft<T> {
    lit: T,
    blocker: T,
    penumbra: T,
    search: T,
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
    parallel::for_each(watch, (receivers, normals, out, more), 1 << 13, |_, (p, n, out, mut more)| {
        dispatch!(_s => for i in 0..out.len() {
            let found = if perspective {
                one::<T, E, C, true>(map, filtered, p[i], at(n, i), test, granted, light, search_slope)
            } else {
                one::<T, E, C, false>(map, filtered, p[i], at(n, i), test, granted, light, search_slope)
            };
            out[i] = found.lit;
            if let Some((blocker, penumbra, search)) = &mut more {
                (blocker[i], penumbra[i], search[i]) = (found.blocker, found.penumbra, found.search);
            }
        })
    })
}

#[inline(always)]
fn one<T: Real, E: Stored, const C: usize, const PERSPECTIVE: bool>(
    map: &Map<'_, T>,
    filtered: &Filtered<'_, T, E, C>,
    point: [T; 3],
    normal: Option<[T; 3]>,
    test: &Test<T>,
    granted: &Granted<T>,
    light: [T; 2],
    search_slope: T,
) -> Soft<T> {
    let (zero, one) = (T::zero(), T::one());
    let foot = match map.foot::<PERSPECTIVE>(point, normal, granted.normal_offset) {
        Ok(foot) if map.holds(foot.x, foot.y) => foot,
        Ok(_) => return Soft { lit: one, blocker: T::NAN, penumbra: zero, search: zero },
        Err(answer) => {
            let nothing = if answer.is_nan() { answer } else { zero };
            return Soft { lit: answer, blocker: T::NAN, penumbra: nothing, search: nothing };
        }
    };
    let gain = foot.gain::<PERSPECTIVE>();
    let limit = map.extent() + map.extent();
    let half = light_image::<T, PERSPECTIVE>(map, foot.depth, light, map.near);
    let half = [Lanes::min(half[0], limit), Lanes::min(half[1], limit)];
    let search = Lanes::max(half[0], half[1]);

    let searched = Granted { slope: search_slope, ..*granted };
    let first = tested(filtered, test, &searched, &foot, gain, half);
    if first.lit > T::of(1.0 - NONE) {
        return Soft { lit: one, blocker: T::NAN, penumbra: zero, search };
    }
    let (_, z) = test.blockers(first.moments, first.t);
    let blocker = Lanes::min(Lanes::max(filtered.warp.back(z), map.near), foot.depth);
    let ratio = if PERSPECTIVE { (foot.depth - blocker) / blocker } else { foot.depth - blocker };
    let penumbra = Lanes::max(ratio, zero) * Lanes::max(light[0], light[1]);

    let half = light_image::<T, PERSPECTIVE>(map, foot.depth, light, blocker);
    let second = tested(filtered, test, granted, &foot, gain, half);
    Soft { lit: without_bleeding(second.lit, granted.bleeding), blocker, penumbra, search }
}
