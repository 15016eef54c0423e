//! The normals of Beckmann's surfaces that a direction sees.
//!
//! Where the surface is stretched to a width of one, slopes are distributed as the bell, along the direction and across
//! it; a facet of slope x along is seen in proportion to cos θ − x sin θ. Across nothing changes; along, the share of what
//! is seen up to x is cos θ (1 + erf x) + sin θ e^(−x²) / √π over its value at cot θ, which [`math::inverse_bell`] turns
//! round.
//!
//! E. Heitz, E. d'Eon, *Importance sampling microfacet-based BSDFs using the distribution of visible normals*, 2014;
//! W. Jakob, *An improved visible normal sampling routine for the Beckmann distribution*, 2014.

use crate::math;
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

const PER_ROOT_PI: f64 = 0.564_189_583_547_756_3;

/// (1 + Λ) cos of a direction with a cosine `z` and, stretched, a sine `s`: Smith's, exact but for rounding.
#[inline(always)]
pub fn smith<V: Lanes>(z: V, s: V) -> V {
    let (area, height) = math::bell(z / s);
    z.num(0.5) * (z * area + s * height * z.num(PER_ROOT_PI))
}

/// The slopes of a facet that a stretched direction above the horizon sees.
#[inline(always)]
pub fn visible_slopes<V: Lanes>(wo: Vec3<V>, u: [V; 2]) -> [V; 2] {
    let (zero, one) = (wo.z.num(0.0), wo.z.num(1.0));
    let s = (wo.x * wo.x + wo.y * wo.y).sqrt();
    let upright = s.equal(zero);
    let (cos, sin) = (V::select(upright, one, wo.x / s), V::select(upright, zero, wo.y / s));
    let (a, b) = (wo.z / (wo.z + s), s / (wo.z + s));
    let (end, never) = (wo.z / s, wo.z.like(V::Elem::INFINITY));
    let (area, height) = math::bell(end);
    let all = a * area + b * height * wo.z.num(PER_ROOT_PI);
    let along = math::inverse_bell(a, b, V::select(upright, never, end), all, u[1]);
    let across = math::inverse_bell(one, zero, never, wo.z.num(2.0), u[0]);
    [cos * along - sin * across, sin * along + cos * across]
}
