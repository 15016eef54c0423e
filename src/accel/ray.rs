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
        Heading { order: permutation(dominant_axis(d)), negative: d.map(|c| (c < T::zero()) as usize) }
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
    let all = |v: [V; 3]| finite(v[0]) & finite(v[1]) & finite(v[2]);
    let smallest = d[0].like(<V::Elem as Real>::MIN_POSITIVE);
    all(o) & all(d) & smallest.less_eq(longest) & t_min.equal(t_min) & t_max.equal(t_max)
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
    let one = o[0].num(1.0);
    let smallest = one.like(<V::Elem as Real>::MIN_POSITIVE);
    let (scale, unscale) = direction_scale(d[order[2]].abs());
    let d = d.map(|c| c * scale);
    let inverse = d.map(|c| one / c.abs().max(smallest).copysign(c));

    let reach = |k: usize| {
        let (low, high) = (one.like(bounds[0][k]) - o[k], one.like(bounds[1][k]) - o[k]);
        low.abs().max(high.abs())
    };
    let eps = one.like(<V::Elem as Real>::EPSILON);
    let depth = reach(order[2]);
    let pad = |k: usize| {
        let p = eps.num(4.0) * eps * (reach(k) + depth) + eps * o[k].abs() + smallest;
        if heading.negative[k] == 1 { -p } else { p }
    };
    let pad = [pad(0), pad(1), pad(2)];

    let in_order = |v: [V; 3]| Vec3::new(v[order[0]], v[order[1]], v[order[2]]);
    let (p, q) = (in_order(d), inverse[order[2]]);
    // Hits beyond the largest number are misses, so that a hit's `t` is always finite.
    let t_max = t_max.min(one.like(<V::Elem as Real>::MAX)) * unscale;
    Ready {
        near: [o[0] + pad[0], o[1] + pad[1], o[2] + pad[2]],
        far: [o[0] - pad[0], o[1] - pad[1], o[2] - pad[2]],
        inverse,
        origin: in_order(o),
        shear: Vec3::new(p.x * q, p.y * q, q),
        t_min: t_min * unscale,
        t_max,
        scale,
    }
}

/// One ray and its heading; None if it is not a ray (see [`proper`]).
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

/// Entry and exit of boxes by [`Ready`]'s slabs: `near` and `far` planes in axis order, a ray in the same lanes.
#[inline(always)]
pub fn slabs<V: Lanes>(
    near: [V; 3],
    far: [V; 3],
    ray_near: [V; 3],
    ray_far: [V; 3],
    inverse: [V; 3],
) -> (V, V) {
    let enter = |k: usize| (near[k] - ray_near[k]) * inverse[k];
    let leave = |k: usize| (far[k] - ray_far[k]) * inverse[k];
    (enter(0).max(enter(1)).max(enter(2)), leave(0).min(leave(1)).min(leave(2)))
}
