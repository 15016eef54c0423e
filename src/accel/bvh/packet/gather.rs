//! Packets of rays that go alike, or none.

use super::{GROUPS, Packet, SIZE};
use crate::accel::batch::Source;
use crate::accel::bvh::Bvh;
use crate::accel::bvh::single::splat8;
use crate::accel::ray::{Eight, Heading, Ready, prepare, proper};
use crate::geometry::ray_triangle::along;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};

/// Rays run alike if they stay this close to the first, as a part of the scene's size, from one side of it to the other.
const SPREAD: f64 = 0.07;

/// A packet of rays that share their heading and stay close together; None if they do not.
#[inline(always)]
pub fn gather<T: Real, S: Simd>(
    s: S,
    tree: &Bvh<T>,
    rays: &impl Source<T>,
    first: usize,
) -> Option<Packet<T, S>> {
    let heading = Heading::of(rays.direction(first));
    // Most batches without coherence are told apart here.
    if !heading.agrees(rays.direction(first + SIZE - 1)) || !heading.agrees(rays.direction(first + SIZE / 2))
    {
        return None;
    }
    let rays_ready = [
        gather_group(tree, heading, rays.eight(s, first))?,
        gather_group(tree, heading, rays.eight(s, first + 8))?,
    ];
    if !close(tree, heading, &rays_ready) {
        return None;
    }
    let [a, b] = &rays_ready;
    let zero = splat8::<T, S>(s, T::zero());
    let (mut near, mut far, mut inverse) = ([zero; 3], [zero; 3], [[zero; 3]; 2]);
    for k in 0..3 {
        let (near_side, far_side) = ([a.near[k], b.near[k]], [a.far[k], b.far[k]]);
        let (n, f) = if heading.negative[k] == 0 {
            (greatest::<T, _, S>(near_side), least::<T, _, S>(far_side))
        } else {
            (least::<T, _, S>(near_side), greatest::<T, _, S>(far_side))
        };
        let slopes = [a.inverse[k], b.inverse[k]];
        (near[k], far[k]) = (splat8(s, n), splat8(s, f));
        inverse[0][k] = splat8(s, least::<T, _, S>(slopes));
        inverse[1][k] = splat8(s, greatest::<T, _, S>(slopes));
    }
    let mut ignore = None;
    if rays.ignoring() {
        let (mut faces, mut greatest) = ([-1; SIZE], -1);
        for i in 0..SIZE {
            faces[i] = rays.ray(first + i).ignore_face;
            greatest = greatest.max(faces[i]);
        }
        if greatest >= 0 {
            ignore = Some(faces);
        }
    }
    Some(Packet {
        heading,
        ignore,
        t: [a.t_max, b.t_max],
        u: [zero; GROUPS],
        v: [zero; GROUPS],
        face: [splat8(s, T::of_low_bits(-1)); GROUPS],
        near,
        far,
        inverse,
        t_min: splat8(s, least::<T, _, S>([a.t_min, b.t_min])),
        rays: rays_ready,
    })
}

/// Eight rays made ready; None if one is no ray or goes another way.
#[inline(always)]
fn gather_group<T: Real, S: Simd>(
    tree: &Bvh<T>,
    heading: Heading,
    Eight { origin: o, direction: d, t_min: low, t_max: high }: Eight<T::V8<S>>,
) -> Option<Ready<T::V8<S>>> {
    let mut same = proper(o, d, low, high) & along(heading.order[2], d);
    for k in 0..3 {
        let negative = d[k].less(d[k].num(0.0));
        same = same & if heading.negative[k] == 1 { negative } else { !negative };
    }
    if T::V8::<S>::bits(same) != 0xff {
        return None;
    }
    Some(prepare(&tree.bounds, o, d, low, high).ready(heading))
}

/// The least of sixteen lanes.
#[inline(always)]
fn least<T: Real, V: SimdBase<S, Element = T> + Lanes<Elem = T>, S: Simd>([a, b]: [V; GROUPS]) -> T {
    SimdBase::min(a, b).reduce_min()
}

/// The greatest of sixteen lanes.
#[inline(always)]
fn greatest<T: Real, V: SimdBase<S, Element = T> + Lanes<Elem = T>, S: Simd>([a, b]: [V; GROUPS]) -> T {
    SimdBase::max(a, b).reduce_max()
}

/// Whether the rays pass the first and the last plane of the scene, across the heading, close together.
#[inline(always)]
fn close<T: Real, S: Simd>(tree: &Bvh<T>, heading: Heading, [a, b]: &[Ready<T::V8<S>>; GROUPS]) -> bool {
    let [low, high] = &tree.bounds;
    let size = (high[0] - low[0]).max(high[1] - low[1]).max(high[2] - low[2]);
    let limit = a.scale.like(size * T::of(SPREAD));
    // Whatever lane: NaN is far from everything.
    let mut close = Lanes::less_eq(limit, limit);
    for corner in [low, high] {
        let z = a.scale.like(corner[heading.order[2]]);
        let (az, bz) = (z - a.origin.z, z - b.origin.z);
        let (ax, bx) = (a.origin.x + a.shear.x * az, b.origin.x + b.shear.x * bz);
        let (ay, by) = (a.origin.y + a.shear.y * az, b.origin.y + b.shear.y * bz);
        let (x, y) = (ax.like(ax.as_array()[0]), ay.like(ay.as_array()[0]));
        close = close & Lanes::abs(ax - x).less_eq(limit) & Lanes::abs(bx - x).less_eq(limit);
        close = close & Lanes::abs(ay - y).less_eq(limit) & Lanes::abs(by - y).less_eq(limit);
    }
    T::V8::<S>::bits(close) == 0xff
}
