//! Exponential variance shadow maps: Chebyshev's bound on e^(az), and on −e^(−bz), of which the lesser holds.
//!
//! The first stretches the depths behind the blocker that is farthest, so that those in front of it count as one: less
//! light bleeds through two blockers. The second does the same for what lies behind the receiver.
//!
//! A. Lauritzen, M. McCool, *Layered Variance Shadow Maps*, GI 2008.

use crate::math;
use crate::real::Lanes;
use crate::shadow::variance::chebyshev_bound;

/// The bound from the moments of e^(az), and from those of −e^(−bz) where `b` is given. `least` is the least variance
/// of depth that counts, which each exponential stretches by its slope at `t`.
#[inline(always)]
pub fn exponential_bound<V: Lanes>(m: [V; 4], t: V, a: V, b: Option<V>, least: V) -> V {
    let e = math::exp(a * t);
    let upper = chebyshev_bound(m[0], m[1], e, least * (a * e) * (a * e));
    match b {
        None => upper,
        Some(b) => {
            let f = math::exp(-b * t);
            let lower = chebyshev_bound(m[2], m[3], -f, least * (b * f) * (b * f));
            // NaN of either stays: `min` returns the second of its two.
            V::select(upper.equal(upper), upper.min(lower), upper)
        }
    }
}
