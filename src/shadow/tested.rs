//! Lookups by a bound: the moments about a receiver, and what they say of the share of the light that it sees.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::shadow::anchor::{Feet, all, double, mask, put, single};
use crate::shadow::exponential_variance::exponential_bound;
use crate::shadow::filtered::Filtered;
use crate::shadow::lookup::{LOT, Map};
use crate::shadow::moment::{Support, before, biased, noise};
use crate::shadow::moment_map::Stored;
use crate::shadow::variance::{chebyshev_bound, without_bleeding};
use crate::simd::*;

/// The bound, and its knobs.
#[derive(Clone, Copy, Debug)]
pub enum Test<T> {
    Variance { least: T },
    Exponential { a: T, b: Option<T>, least: T },
    Moment { support: Support, alpha: f64, target: f64 },
}

/// What is granted to a receiver.
#[derive(Clone, Copy)]
pub struct Granted<T> {
    /// World units along the axis.
    pub constant: T,
    /// Half sides of the filter: as much depth as the receiver's plane gains over them.
    pub slope: T,
    /// Texels, times the sine of the light's angle.
    pub normal_offset: T,
    /// The lit fraction that counts as none.
    pub bleeding: T,
}

impl<T: Real> Test<T> {
    /// The most of the light that receivers at `t` may see, and the mean of the blockers' depths (t without any).
    /// Enters the level anew: this is compiled once for all formats of moments.
    #[inline(never)]
    pub fn blockers<S: Simd>(&self, s: S, m: [T::V8<S>; 4], t: T::V8<S>) -> (T::V8<S>, T::V8<S>) {
        s.vectorize(
            #[inline(always)]
            || self.blockers_here(s, m, t),
        )
    }

    #[inline(always)]
    fn blockers_here<S: Simd>(&self, s: S, m: [T::V8<S>; 4], t: T::V8<S>) -> (T::V8<S>, T::V8<S>) {
        let one = all::<T, S>(s, T::one());
        let lit = match *self {
            Test::Variance { least } => chebyshev_bound(m[0], m[1], t, all::<T, S>(s, least)),
            Test::Exponential { a, b, least } => {
                #[allow(clippy::manual_map)] // A closure would not be compiled for the level unless inlined.
                let b = match b {
                    Some(b) => Some(all::<T, S>(s, b)),
                    None => None,
                };
                exponential_bound(m, t, all::<T, S>(s, a), b, all::<T, S>(s, least))
            }
            Test::Moment { support, alpha, target } => {
                return of_moments::<T, S>(s, m, t, support, alpha, target);
            }
        };
        // What is not nearer is taken to lie at the receiver's depth.
        let blocked = lit.simd_lt(one);
        (lit, blocked.select((m[0] - lit * t) / (one - lit), t))
    }
}

/// The bound of four moments, in double whatever theirs: see [`crate::shadow::moment::moment_bound`].
#[inline(always)]
fn of_moments<T: Real, S: Simd>(
    s: S,
    m: [T::V8<S>; 4],
    t: T::V8<S>,
    support: Support,
    alpha: f64,
    target: f64,
) -> (T::V8<S>, T::V8<S>) {
    let [m0, m1, m2, m3] = m;
    let check = m0 + m1 + m2 + m3 + t;
    let wide = [double::<T, S>(s, m0), double::<T, S>(s, m1), double::<T, S>(s, m2), double::<T, S>(s, m3)];
    let (b, z) = (biased(wide, all::<f64, S>(s, alpha), all::<f64, S>(s, target)), double::<T, S>(s, t));
    let blocked = before(b, z, support, all::<f64, S>(s, noise::<T>(alpha)));
    let lit = all::<f64, S>(s, 1.0) - blocked.share;
    let (numbers, nan) = (check.simd_eq(check), all::<T, S>(s, T::NAN));
    (numbers.select(single::<T, S>(s, lit), nan), numbers.select(single::<T, S>(s, blocked.depth), nan))
}

/// What a lot of lookups found.
#[derive(Clone, Copy)]
pub struct Found<V> {
    pub lit: V,
    /// The mean of the blockers' depths, on the scale of the moments.
    pub blocker: V,
    /// The filtered moments, and the depth on their scale that they were asked about.
    pub moments: [V; 4],
    pub t: V,
}

/// The lookups at places of the map, over boxes of half sides in texels; of receivers whose bit is set.
#[inline(always)]
pub fn tested<T: Real, E: Stored, S: Simd, const C: usize>(
    s: S,
    live: u64,
    filtered: &Filtered<'_, T, E, C>,
    test: &Test<T>,
    granted: &Granted<T>,
    feet: &Feet<T::V8<S>>,
    gain: [T::V8<S>; 2],
    half: [T::V8<S>; 2],
) -> Found<T::V8<S>> {
    let moments = filtered.means(s, live, (feet.x, feet.y), half);
    let slope = all::<T, S>(s, granted.slope) * (gain[0] * half[0] + gain[1] * half[1]);
    let t = filtered.warp.of(feet.depth - (feet.rounding + all::<T, S>(s, granted.constant) + slope));
    let (lit, blocker) = test.blockers(s, moments, t);
    Found { lit, blocker, moments, t }
}

/// Of a lot of receivers from `i` on, of which those `asked` look into this map: where they fall, how much depth they
/// gain over a texel, and a bit for each that lies on the map. Enters the level anew, as [`Test::blockers`].
#[inline(never)]
pub fn placed<T: Real, S: Simd>(
    s: S,
    map: &Map<'_, T>,
    perspective: bool,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    i: usize,
    asked: u64,
    normal_offset: T,
) -> (Feet<T::V8<S>>, [T::V8<S>; 2], u64) {
    s.vectorize(
        #[inline(always)]
        || placed_here(s, map, perspective, points, normals, i, asked, normal_offset),
    )
}

#[inline(always)]
fn placed_here<T: Real, S: Simd>(
    s: S,
    map: &Map<'_, T>,
    perspective: bool,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    i: usize,
    asked: u64,
    normal_offset: T,
) -> (Feet<T::V8<S>>, [T::V8<S>; 2], u64) {
    let (feet, gain) = if perspective {
        let feet = map.feet::<S, true>(s, points, normals, i, normal_offset);
        (feet, feet.gain::<true>())
    } else {
        let feet = map.feet::<S, false>(s, points, normals, i, normal_offset);
        (feet, feet.gain::<false>())
    };
    let mut live = feet.live & asked;
    for k in 0..LOT {
        if !map.holds(feet.x.as_slice()[k], feet.y.as_slice()[k]) {
            live &= !(1 << k);
        }
    }
    (feet, gain, live)
}

/// The lit fraction of every receiver; with `more`, the moments (as many as `C`) and the depth asked about. `half` is
/// half the filter's side in texels.
pub fn lookup<T: Real, E: Stored, const C: usize>(
    watch: &mut dyn Watch,
    map: &Map<'_, T>,
    perspective: bool,
    filtered: &Filtered<'_, T, E, C>,
    receivers: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    test: &Test<T>,
    granted: &Granted<T>,
    half: T,
    out: &mut [T],
    more: Option<(&mut [[T; C]], &mut [T])>,
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (receivers, normals, out, more), 1 << 13, |first, (p, n, out, mut more)| {
        dispatch!(s => {
            let (half, nan) = (all::<T, _>(s, half), all::<T, _>(s, T::NAN));
            let mut i = 0;
            while i < out.len() {
                let asked = map.asks(first + i, LOT.min(out.len() - i));
                let (feet, gain, live) = placed(s, map, perspective, p, n, i, asked, granted.normal_offset);
                let found = tested(s, live, filtered, test, granted, &feet, gain, [half; 2]);
                let here = mask::<T, _>(s, live);
                let lit = without_bleeding(found.lit, all::<T, _>(s, granted.bleeding));
                put::<T, _>(out, i, asked, here.select(lit, feet.answer));
                if let Some((moments, t)) = &mut more {
                    for c in 0..C {
                        let m = here.select(found.moments[c], nan);
                        for k in 0..LOT {
                            if asked >> k & 1 == 1 {
                                moments[i + k][c] = m.as_slice()[k];
                            }
                        }
                    }
                    put::<T, _>(t, i, asked, here.select(found.t, nan));
                }
                i += LOT;
            }
        })
    })
}
