//! Rays made ready for traversal, one at a time or many in lanes, and the slab arithmetic that decides.
//!
//! The direction is scaled by a power of two so that its largest component is near one; `t` is scaled along.
//!
//! **Slabs.** A box is entered at `max (near - o_near) / d` and left at `min (far - o_far) / d` over the axes, with the
//! reciprocal of `d` rounded once. A component below the smallest normal number counts as that number, so that
//! nothing is infinite and no NaN arises. The origin is moved back by a pad for near planes and ahead for far ones.
//! The watertight test accepts a ray that passes its triangle within `δ_k ≤ u (2 R_k + 5 R_z)` on axis `k`, where `u` is the
//! unit round-off, `R` the largest distance of the scene's bounds from the origin, and `z` the dominant axis: the
//! roundings of one shear. The slab's own three roundings are worth `3 u R_k`. The pad, `8 u (R_k + R_z)` and `2 u |o_k|`
//! for the rounding of the moved origin, exceeds the sum: **who crosses a triangle passes its box**.
//!
//! **Exactness.** Subtraction, multiplication, minimum and maximum round monotonically, so who passes a box passes every
//! box around it, at no later entry. A hit must pass its triangle's own box, and its `t` is raised to that entry;
//! equal `t` goes to the lowest face. Hence no box can cull a hit, and every structure returns what brute force does.
//!
//! S. Woop, C. Benthin, I. Wald, *Watertight Ray/Triangle Intersection*, 2013, section 3.3, pads with the same idea.

use super::{Hit, Ray};
use crate::geometry::ray_triangle::{direction_scale, dominant_axis, finite, permutation};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// Which way rays go: uniform over a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heading {
    /// Axes in cyclic order, the dominant one last.
    pub order: [usize; 3],
    /// 1 where the direction is negative: the index of the plane that is met first.
    pub negative: [usize; 3],
}

impl Heading {
    #[inline(always)]
    pub fn of<T: Real>(d: [T; 3]) -> Self {
        Heading {
            order: permutation(dominant_axis(d)),
            negative: [(d[0] < T::zero()) as usize, (d[1] < T::zero()) as usize, (d[2] < T::zero()) as usize],
        }
    }
}

/// A ray, or lanes of rays of one [`Heading`], ready for traversal.
#[derive(Clone, Copy, Debug)]
pub struct Ready<V> {
    /// Subtracted from planes that are entered and left through.
    pub near: [V; 3],
    pub far: [V; 3],
    pub inverse: [V; 3],
    /// The origin in the heading's order, and Woop's shear.
    pub origin: Vec3<V>,
    pub shear: Vec3<V>,
    /// The interval in scaled `t`.
    pub t_min: V,
    pub t_max: V,
    /// Scaled `t` times this is the user's.
    pub scale: V,
}

/// Lanes that hold a ray: all finite, some direction, an interval without NaN.
#[inline(always)]
pub fn proper<V: Lanes>(o: [V; 3], d: [V; 3], t_min: V, t_max: V) -> V::Mask {
    let longest = d[0].abs().max(d[1].abs()).max(d[2].abs());
    let (origin, direction) =
        (finite(o[0]) & finite(o[1]) & finite(o[2]), finite(d[0]) & finite(d[1]) & finite(d[2]));
    let smallest = longest.like(<V::Elem as Real>::MIN_POSITIVE);
    origin & direction & smallest.less_eq(longest) & t_min.equal(t_min) & t_max.equal(t_max)
}

/// `bounds` are the scene's. The rays must be [`proper`] and of this heading.
#[inline(always)]
pub fn prepare<V: Lanes>(
    bounds: &[[V::Elem; 3]; 2],
    heading: Heading,
    o: [V; 3],
    d: [V; 3],
    t_min: V,
    t_max: V,
) -> Ready<V> {
    let order = heading.order;
    let (one, eps) = (o[0].num(1.0), o[0].like(<V::Elem as Real>::EPSILON));
    let smallest = one.like(<V::Elem as Real>::MIN_POSITIVE);
    let (scale, unscale) = direction_scale(d[order[2]].abs());
    let d = [d[0] * scale, d[1] * scale, d[2] * scale];

    let mut reach = o;
    for k in 0..3 {
        let (low, high) = (one.like(bounds[0][k]) - o[k], one.like(bounds[1][k]) - o[k]);
        reach[k] = low.abs().max(high.abs());
    }
    let (mut near, mut far, mut inverse) = (o, o, o);
    for k in 0..3 {
        let pad = one.num(4.0) * eps * (reach[k] + reach[order[2]]) + eps * o[k].abs() + smallest;
        let pad = if heading.negative[k] == 1 { -pad } else { pad };
        (near[k], far[k]) = (o[k] + pad, o[k] - pad);
        // The heading's sign, which -0 and what underflows share.
        let steep = one / d[k].abs().max(smallest);
        inverse[k] = if heading.negative[k] == 1 { -steep } else { steep };
    }

    let q = inverse[order[2]];
    // Hits beyond the largest number are misses, so that a hit's `t` is always finite.
    let t_max = t_max.min(one.like(<V::Elem as Real>::MAX)) * unscale;
    Ready {
        near,
        far,
        inverse,
        origin: Vec3::new(o[order[0]], o[order[1]], o[order[2]]),
        shear: Vec3::new(d[order[0]] * q, d[order[1]] * q, q),
        t_min: t_min * unscale,
        t_max,
        scale,
    }
}

/// One ray and its heading; None if it is no ray (see [`proper`]).
#[inline(always)]
pub fn ready<T: Real>(bounds: &[[T; 3]; 2], ray: &Ray<T>) -> Option<(Ready<T>, Heading)> {
    if !proper(ray.origin, ray.direction, ray.t_min, ray.t_max) {
        return None;
    }
    let heading = Heading::of(ray.direction);
    Some((prepare(bounds, heading, ray.origin, ray.direction, ray.t_min, ray.t_max), heading))
}

impl<T: Real> Ready<T> {
    /// Nothing hit yet: a hit must come before the end, and `-1` loses every tie, so the end itself is excluded.
    #[inline(always)]
    pub fn unhit(&self) -> Hit<T> {
        Hit { t: self.t_max, u: T::zero(), v: T::zero(), face: -1 }
    }
    /// The hit in the user's `t`.
    #[inline(always)]
    pub fn finish(&self, hit: Hit<T>) -> Hit<T> {
        // Adding zero turns -0 into +0, whose sign would otherwise depend on the order of a maximum.
        if hit.face < 0 { Hit::miss() } else { Hit { t: hit.t * self.scale + T::zero(), ..hit } }
    }
}

/// Entry and exit of boxes by [`Ready`]'s slabs: `near` and `far` planes, and the ray, in one order of axes.
#[inline(always)]
pub fn slabs<V: Lanes>(
    near: [V; 3],
    far: [V; 3],
    ray_near: [V; 3],
    ray_far: [V; 3],
    inverse: [V; 3],
) -> (V, V) {
    let (mut entry, mut exit) = ((near[0] - ray_near[0]) * inverse[0], (far[0] - ray_far[0]) * inverse[0]);
    for k in 1..3 {
        entry = entry.max((near[k] - ray_near[k]) * inverse[k]);
        exit = exit.min((far[k] - ray_far[k]) * inverse[k]);
    }
    (entry, exit)
}
