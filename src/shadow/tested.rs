//! Lookups by a bound: the moments about a receiver, and what they say of the share of the light that it sees.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::shadow::exponential_variance::exponential_bound;
use crate::shadow::filtered::Filtered;
use crate::shadow::lookup::{Foot, Map, at};
use crate::shadow::moment::{Support, biased, extremal};
use crate::shadow::moment_map::Stored;
use crate::shadow::variance::{chebyshev_bound, without_bleeding};

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
    /// The most of the light that a receiver at `t` may see.
    #[inline(always)]
    pub fn lit(&self, m: [T; 4], t: T) -> T {
        self.blockers(m, t).0
    }

    /// That, and the mean of the blockers' depths (t without any).
    #[inline(always)]
    pub fn blockers(&self, m: [T; 4], t: T) -> (T, T) {
        let one = T::one();
        let lit = match *self {
            Test::Variance { least } => chebyshev_bound(m[0], m[1], t, least),
            Test::Exponential { a, b, least } => exponential_bound(m, t, a, b, least),
            Test::Moment { support, alpha, target } => {
                let wide = [m[0].to_f64(), m[1].to_f64(), m[2].to_f64(), m[3].to_f64()];
                let (b, z) = (biased(wide, alpha, target), t.to_f64());
                let of_moments = b[0] + b[1] + b[2] + b[3] + z;
                if of_moments.is_nan() {
                    return (T::NAN, T::NAN);
                }
                let (share, depth) = extremal(b, z, support).before(z);
                let share = Lanes::min(share, 1.0);
                return (T::of(1.0 - share), if share > 0.0 { T::of(depth / share) } else { t });
            }
        };
        // What is not nearer is taken to lie at the receiver's depth.
        (lit, if lit < one { (m[0] - lit * t) / (one - lit) } else { t })
    }
}

/// What one lookup found.
#[derive(Clone, Copy)]
pub struct Found<T> {
    pub lit: T,
    /// The filtered moments, and the depth on their scale that they were asked about.
    pub moments: [T; 4],
    pub t: T,
}

/// The lookup at a place of the map, over a box of half sides in texels.
#[inline(always)]
pub fn tested<T: Real, E: Stored, const C: usize>(
    filtered: &Filtered<'_, T, E, C>,
    test: &Test<T>,
    granted: &Granted<T>,
    foot: &Foot<T>,
    gain: [T; 2],
    half: [T; 2],
) -> Found<T> {
    let moments = filtered.mean_powers(foot.x, foot.y, half);
    let slope = granted.slope * (gain[0] * half[0] + gain[1] * half[1]);
    let t = filtered.warp.of(foot.depth - (foot.rounding + granted.constant + slope));
    Found { lit: test.lit(moments, t), moments, t }
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
    parallel::for_each(watch, (receivers, normals, out, more), 1 << 13, |_, (p, n, out, mut more)| {
        dispatch!(_s => for i in 0..out.len() {
            let found = if perspective {
                one::<T, E, C, true>(map, filtered, p[i], at(n, i), test, granted, half)
            } else {
                one::<T, E, C, false>(map, filtered, p[i], at(n, i), test, granted, half)
            };
            out[i] = found.lit;
            if let Some((moments, t)) = &mut more {
                for c in 0..C {
                    moments[i][c] = found.moments[c];
                }
                t[i] = found.t;
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
    half: T,
) -> Found<T> {
    let foot = match map.foot::<PERSPECTIVE>(point, normal, granted.normal_offset) {
        Ok(foot) if map.holds(foot.x, foot.y) => foot,
        Ok(_) => return Found { lit: T::one(), moments: [T::NAN; 4], t: T::NAN },
        Err(answer) => return Found { lit: answer, moments: [T::NAN; 4], t: T::NAN },
    };
    let gain = foot.gain::<PERSPECTIVE>();
    let mut found = tested(filtered, test, granted, &foot, gain, [half; 2]);
    found.lit = without_bleeding(found.lit, granted.bleeding);
    found
}
