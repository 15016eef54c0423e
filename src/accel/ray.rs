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
use crate::geometry::ray_triangle::{along, direction_scale, dominant_axis, finite, permutation};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crate::vec::Vec3;

/// Which way rays go: uniform over a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heading {
    /// Axes in cyclic order, the dominant one last.
    pub order: [usize; 3],
    /// 1 where the direction is negative: the index of the plane that is met first.
    pub negative: [usize; 3],
}

#[inline(always)]
fn signs<T: Real>(d: [T; 3]) -> [usize; 3] {
    [(d[0] < T::zero()) as usize, (d[1] < T::zero()) as usize, (d[2] < T::zero()) as usize]
}

impl Heading {
    #[inline(always)]
    pub fn of<T: Real>(d: [T; 3]) -> Self {
        Heading { order: permutation(dominant_axis(d)), negative: signs(d) }
    }

    /// Whether a direction has the same signs: quicker than the whole of its heading.
    #[inline(always)]
    pub fn agrees<T: Real>(self, d: [T; 3]) -> bool {
        let s = signs(d);
        (s[0] ^ self.negative[0]) | (s[1] ^ self.negative[1]) | (s[2] ^ self.negative[2]) == 0
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

/// A ray, or lanes of rays of any headings, before its axes are put in order: what costs most, and alike for all.
#[derive(Clone, Copy)]
pub struct Prepared<V> {
    near: [V; 3],
    far: [V; 3],
    inverse: [V; 3],
    origin: [V; 3],
    /// The direction over its dominant component.
    slope: [V; 3],
    /// One over the dominant component.
    steepest: V,
    t_min: V,
    t_max: V,
    scale: V,
}

/// `bounds` are the scene's. The rays should be [`proper`].
#[inline(always)]
pub fn prepare<V: Lanes>(
    bounds: &[[V::Elem; 3]; 2],
    o: [V; 3],
    d: [V; 3],
    t_min: V,
    t_max: V,
) -> Prepared<V> {
    let (one, eps) = (o[0].num(1.0), o[0].like(<V::Elem as Real>::EPSILON));
    let (zero, smallest) = (one.num(0.0), one.like(<V::Elem as Real>::MIN_POSITIVE));
    let (x, y) = (along(0, d), along(1, d));
    let (scale, unscale) = direction_scale(pick(x, y, d).abs());

    let mut reach = o;
    for k in 0..3 {
        let (low, high) = (one.like(bounds[0][k]) - o[k], one.like(bounds[1][k]) - o[k]);
        reach[k] = low.abs().max(high.abs());
    }
    let furthest = pick(x, y, reach);
    let (mut near, mut far, mut inverse) = (o, o, o);
    for k in 0..3 {
        // The heading's sign, which -0 and what underflows share.
        let negative = d[k].less(zero);
        let pad = one.num(4.0) * eps * (reach[k] + furthest) + eps * o[k].abs() + smallest;
        let pad = V::select(negative, -pad, pad);
        (near[k], far[k]) = (o[k] + pad, o[k] - pad);
        let steep = one / (d[k] * scale).abs().max(smallest);
        inverse[k] = V::select(negative, -steep, steep);
    }
    let steepest = pick(x, y, inverse);
    let slope = [d[0] * scale * steepest, d[1] * scale * steepest, d[2] * scale * steepest];
    // Hits beyond the largest number are misses, so that a hit's `t` is always finite.
    let t_max = t_max.min(one.like(<V::Elem as Real>::MAX)) * unscale;
    Prepared { near, far, inverse, origin: o, slope, steepest, t_min: t_min * unscale, t_max, scale }
}

/// The first where `x` holds, the second where `y` does, else the third.
#[inline(always)]
fn pick<V: Lanes>(x: V::Mask, y: V::Mask, v: [V; 3]) -> V {
    V::select(x, v[0], V::select(y, v[1], v[2]))
}

impl<V> Prepared<V> {
    /// With the axes in the order of a heading, which must be that of every lane.
    #[inline(always)]
    pub fn ready(&self, heading: Heading) -> Ready<V>
    where
        V: Copy,
    {
        self.map(
            heading,
            #[inline(always)]
            |v| *v,
        )
    }

    /// The same of a part, as one of several lanes.
    #[inline(always)]
    pub fn map<W>(&self, heading: Heading, of: impl Fn(&V) -> W) -> Ready<W> {
        let [x, y, z] = heading.order;
        Ready {
            near: three(&self.near, &of),
            far: three(&self.far, &of),
            inverse: three(&self.inverse, &of),
            origin: Vec3::new(of(&self.origin[x]), of(&self.origin[y]), of(&self.origin[z])),
            shear: Vec3::new(of(&self.slope[x]), of(&self.slope[y]), of(&self.steepest)),
            t_min: of(&self.t_min),
            t_max: of(&self.t_max),
            scale: of(&self.scale),
        }
    }

    /// The same number everywhere.
    pub fn all(v: V) -> Self
    where
        V: Copy,
    {
        let three = [v; 3];
        let (near, far, inverse, origin, slope) = (three, three, three, three, three);
        Prepared { near, far, inverse, origin, slope, steepest: v, t_min: v, t_max: v, scale: v }
    }

    /// Every number through `f`.
    #[inline(always)]
    pub fn each<W>(&self, f: impl Fn(&V) -> W) -> Prepared<W> {
        Prepared {
            near: three(&self.near, &f),
            far: three(&self.far, &f),
            inverse: three(&self.inverse, &f),
            origin: three(&self.origin, &f),
            slope: three(&self.slope, &f),
            steepest: f(&self.steepest),
            t_min: f(&self.t_min),
            t_max: f(&self.t_max),
            scale: f(&self.scale),
        }
    }
}

#[inline(always)]
fn three<V, W>(v: &[V; 3], f: &impl Fn(&V) -> W) -> [W; 3] {
    [f(&v[0]), f(&v[1]), f(&v[2])]
}

/// Eight rays in lanes: their origins, directions and intervals.
#[derive(Clone, Copy)]
pub struct Eight<V> {
    pub origin: [V; 3],
    pub direction: [V; 3],
    pub t_min: V,
    pub t_max: V,
}

impl<V> Eight<V> {
    #[inline(always)]
    pub fn load<T: Real<V8<S> = V>, S: Simd>(s: S, rays: impl Fn(usize) -> Ray<T>) -> Self {
        let r = [rays(0), rays(1), rays(2), rays(3), rays(4), rays(5), rays(6), rays(7)];
        let runs = [[r[0], r[1], r[2], r[3]], [r[4], r[5], r[6], r[7]]];
        macro_rules! of_all {
            ($field:ident) => {
                [
                    [runs[0][0].$field, runs[0][1].$field, runs[0][2].$field, runs[0][3].$field],
                    [runs[1][0].$field, runs[1][1].$field, runs[1][2].$field, runs[1][3].$field],
                ]
            };
        }
        Eight::of_runs(s, of_all!(origin), of_all!(direction), of_all!(t_min), of_all!(t_max))
    }

    /// From two runs of four rays.
    #[inline(always)]
    pub fn of_runs<T: Real<V8<S> = V>, S: Simd>(
        s: S,
        o: [[[T; 3]; 4]; 2],
        d: [[[T; 3]; 4]; 2],
        low: [[T; 4]; 2],
        high: [[T; 4]; 2],
    ) -> Self {
        Eight {
            origin: [axis(s, &o, 0), axis(s, &o, 1), axis(s, &o, 2)],
            direction: [axis(s, &d, 0), axis(s, &d, 1), axis(s, &d, 2)],
            t_min: of_eight(s, low),
            t_max: of_eight(s, high),
        }
    }
}

#[inline(always)]
fn of_eight<T: Real, S: Simd>(s: S, [a, b]: [[T; 4]; 2]) -> T::V8<S> {
    // By value: by way of memory the register would wait for eight separate stores.
    SimdBase::load_array(s, [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]])
}

#[inline(always)]
fn axis<T: Real, S: Simd>(s: S, [a, b]: &[[[T; 3]; 4]; 2], k: usize) -> T::V8<S> {
    of_eight(s, [[a[0][k], a[1][k], a[2][k], a[3][k]], [b[0][k], b[1][k], b[2][k], b[3][k]]])
}

#[inline(always)]
pub fn load8<T: Real, S: Simd>(s: S, x: &[T; 8]) -> T::V8<S> {
    SimdBase::load_array_ref(s, x)
}

/// One ray and its heading; None if it is no ray (see [`proper`]).
#[inline(always)]
pub fn ready<T: Real>(bounds: &[[T; 3]; 2], ray: &Ray<T>) -> Option<(Ready<T>, Heading)> {
    if !proper(ray.origin, ray.direction, ray.t_min, ray.t_max) {
        return None;
    }
    let heading = Heading::of(ray.direction);
    Some((prepare(bounds, ray.origin, ray.direction, ray.t_min, ray.t_max).ready(heading), heading))
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
