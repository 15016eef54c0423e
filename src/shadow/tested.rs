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
    /// Enters the level anew: this is compiled once for all formats of moments. Two lots at a time: a bound is a chain of
    /// divisions and a root, each of which waits for the one before, and the other lot's fill the wait.
    #[inline(never)]
    pub fn blockers<S: Simd>(
        &self,
        s: S,
        m: &[[T::V8<S>; 4]; PAIR],
        t: &[T::V8<S>; PAIR],
    ) -> [(T::V8<S>, T::V8<S>); PAIR] {
        s.vectorize(
            #[inline(always)]
            || [self.blockers_here(s, m[0], t[0]), self.blockers_here(s, m[1], t[1])],
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

/// Lots that are looked up together.
pub const PAIR: usize = 2;

/// Where a lot of receivers falls.
#[derive(Clone, Copy)]
pub struct Placed<V> {
    pub feet: Feet<V>,
    /// How much depth the receivers' planes gain over a texel across and one down.
    pub gain: [V; 2],
    /// A bit for each that looks into this map, and for each of these that lies on it.
    pub asked: u64,
    pub live: u64,
}

/// The lookups at places of the map, over boxes of half sides in texels; of receivers whose bit is set.
#[inline(always)]
pub fn tested<T: Real, E: Stored, S: Simd, const C: usize>(
    s: S,
    filtered: &Filtered<'_, T, E, C>,
    test: &Test<T>,
    granted: &Granted<T>,
    lots: &[Placed<T::V8<S>>; PAIR],
    half: [[T::V8<S>; 2]; PAIR],
) -> [Found<T::V8<S>>; PAIR] {
    let none = all::<T, S>(s, T::zero());
    let (mut moments, mut t) = ([[none; 4]; PAIR], [none; PAIR]);
    for j in 0..PAIR {
        let Placed { feet, gain, live, .. } = &lots[j];
        if *live == 0 {
            continue;
        }
        moments[j] = filtered.means(s, *live, (feet.x, feet.y), half[j]);
        // A filter wider than numbers reach grants all there is, and none of it if none is granted.
        let (reach, most) =
            (gain[0] * half[j][0] + gain[1] * half[j][1], all::<T, S>(s, T::MAX * T::of(1e-6)));
        let slope = all::<T, S>(s, granted.slope) * most.simd_lt(reach).select(most, reach);
        t[j] = filtered.warp.of(feet.depth - (feet.rounding + all::<T, S>(s, granted.constant) + slope));
    }
    let [first, second] = test.blockers(s, &moments, &t);
    [
        Found { lit: first.0, blocker: first.1, moments: moments[0], t: t[0] },
        Found { lit: second.0, blocker: second.1, moments: moments[1], t: t[1] },
    ]
}

/// The lots from the `i`th receiver of a chunk on, whose own first is the `first` of all. Beyond the last nobody asks.
#[inline(always)]
pub fn pair<T: Real, S: Simd>(
    s: S,
    map: &Map<'_, T>,
    perspective: bool,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    first: usize,
    i: usize,
    normal_offset: T,
) -> [Placed<T::V8<S>>; PAIR] {
    let (next, n) = (i + LOT, points.len());
    let asked =
        [map.asks(first + i, LOT.min(n - i)), map.asks(first + next, LOT.min(n.saturating_sub(next)))];
    [
        placed(s, map, perspective, points, normals, i, asked[0], normal_offset),
        placed(s, map, perspective, points, normals, next.min(n - 1), asked[1], normal_offset),
    ]
}

/// A lot of receivers from `i` on, of which those `asked` look into this map. Enters the level anew, as
/// [`Test::blockers`].
#[inline(never)]
fn placed<T: Real, S: Simd>(
    s: S,
    map: &Map<'_, T>,
    perspective: bool,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    i: usize,
    asked: u64,
    normal_offset: T,
) -> Placed<T::V8<S>> {
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
) -> Placed<T::V8<S>> {
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
    Placed { feet, gain, asked, live }
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
                let lots = pair(s, map, perspective, p, n, first, i, granted.normal_offset);
                let found = tested(s, filtered, test, granted, &lots, [[half; 2]; PAIR]);
                for j in 0..PAIR {
                    let (asked, i) = (lots[j].asked, i + j * LOT);
                    let here = mask::<T, _>(s, lots[j].live);
                    let lit = without_bleeding(found[j].lit, all::<T, _>(s, granted.bleeding));
                    put::<T, _>(out, i, asked, here.select(lit, lots[j].feet.answer));
                    if let Some((moments, t)) = &mut more {
                        for c in 0..C {
                            let m = here.select(found[j].moments[c], nan);
                            for k in 0..LOT {
                                if asked >> k & 1 == 1 {
                                    moments[i + k][c] = m.as_slice()[k];
                                }
                            }
                        }
                        put::<T, _>(t, i, asked, here.select(found[j].t, nan));
                    }
                }
                i += PAIR * LOT;
            }
        })
    })
}
