//! Triangles four at a time, and one ray against a run of them: what every structure's leaves hold, and the test by which
//! all of them decide (see [`super::ray`]).

use super::Hit;
use super::ray::{Heading, Ready, slabs};
use crate::geometry::ray_triangle::watertight;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};

/// Triangles in a block.
pub const BLOCK: usize = 4;

/// Four triangles. Empty lanes hold NaN, which no comparison accepts, and face -1.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Block<T> {
    /// `[vertex][axis][triangle]`.
    pub vertices: [[[T; BLOCK]; 3]; 3],
    pub faces: [i32; BLOCK],
}

impl<T: Real> Block<T> {
    pub const EMPTY: Block<T> = Block { vertices: [[[T::NAN; BLOCK]; 3]; 3], faces: [-1; BLOCK] };

    /// From at most four faces and their corners.
    pub fn new(triangles: impl Iterator<Item = (i32, [[T; 3]; 3])>) -> Self {
        let mut block = Block::EMPTY;
        for (lane, (face, corners)) in triangles.enumerate() {
            block.faces[lane] = face;
            for (vertex, p) in corners.iter().enumerate() {
                for k in 0..3 {
                    block.vertices[vertex][k][lane] = p[k];
                }
            }
        }
        block
    }

    /// Empties a lane.
    #[inline(always)]
    pub fn clear(&mut self, lane: usize) {
        self.faces[lane] = -1;
        for vertex in 0..3 {
            for k in 0..3 {
                self.vertices[vertex][k][lane] = T::NAN;
            }
        }
    }
}

/// Tests the triangles of a leaf, and keeps the nearest hit. With `ANY`, returns true at the first.
#[inline(always)]
pub fn leaf<const ANY: bool, T: Real, S: Simd>(
    s: S,
    blocks: &[Block<T>],
    ray: &Ready<T>,
    heading: &Heading,
    ignore: i32,
    hit: &mut Hit<T>,
) -> bool {
    for block in blocks {
        let Some(Hits { mut bits, t, u, v }) = test(s, block, ray, heading, hit.t) else { continue };
        while bits != 0 {
            let l = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let face = block.faces[l];
            if face != ignore && (t[l] < hit.t || (t[l] == hit.t && face < hit.face)) {
                *hit = Hit { t: t[l], u: u[l], v: v[l], face };
                if ANY {
                    return true;
                }
            }
        }
    }
    false
}

/// Tests the triangles of a leaf, and hands on every hit.
#[inline(always)]
pub fn all<T: Real, S: Simd>(
    s: S,
    blocks: &[Block<T>],
    ray: &Ready<T>,
    heading: &Heading,
    ignore: i32,
    mut each: impl FnMut(Hit<T>),
) {
    for block in blocks {
        let Some(Hits { mut bits, t, u, v }) = test(s, block, ray, heading, ray.t_max) else { continue };
        while bits != 0 {
            let l = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let face = block.faces[l];
            if face != ignore && t[l] < ray.t_max {
                each(Hit { t: t[l], u: u[l], v: v[l], face });
            }
        }
    }
}

/// The triangles of a block that a ray hits after `t_min` and not after an end, as bits.
struct Hits<T> {
    bits: u32,
    t: [T; BLOCK],
    u: [T; BLOCK],
    v: [T; BLOCK],
}

/// The rule by which all structures decide.
#[inline(always)]
fn test<T: Real, S: Simd>(
    s: S,
    block: &Block<T>,
    ray: &Ready<T>,
    heading: &Heading,
    end: T,
) -> Option<Hits<T>> {
    let order = heading.order;
    let origin = splat4x3::<T, S>(s, ray.origin.to_array());
    let shear = splat4x3::<T, S>(s, ray.shear.to_array());
    let (a, b, c) = (corner(s, block, 0, order), corner(s, block, 1, order), corner(s, block, 2, order));
    let (mask, x) = watertight(origin.into(), shear.into(), a.into(), b.into(), c.into())?;
    let end = splat4::<T, S>(s, end);
    let mask = mask & Lanes::less(splat4::<T, S>(s, ray.t_min), x.t) & Lanes::less_eq(x.t, end);
    if T::V4::<S>::bits(mask) == 0 {
        return None;
    }
    // The hit must pass its triangle's own box, by the arithmetic of the nodes.
    let (near, far) = own_box(heading, a, b, c);
    let (entry, exit) = slabs(
        near,
        far,
        splat4x3::<T, S>(s, in_order(order, ray.near)),
        splat4x3::<T, S>(s, in_order(order, ray.far)),
        splat4x3::<T, S>(s, in_order(order, ray.inverse)),
    );
    let passed = Lanes::less_eq(entry, exit) & Lanes::less_eq(splat4::<T, S>(s, ray.t_min), exit);
    let t = Lanes::max(x.t, entry);
    let bits = T::V4::<S>::bits(mask & passed & Lanes::less_eq(t, end));
    Some(Hits { bits, t: t.to_array(), u: x.u.to_array(), v: x.v.to_array() })
}

#[inline(always)]
pub fn splat4<T: Real, S: Simd>(s: S, x: T) -> T::V4<S> {
    SimdBase::splat(s, x)
}

#[inline(always)]
pub fn in_order<X: Copy>(order: [usize; 3], v: [X; 3]) -> [X; 3] {
    [v[order[0]], v[order[1]], v[order[2]]]
}

#[inline(always)]
fn splat4x3<T: Real, S: Simd>(s: S, v: [T; 3]) -> [T::V4<S>; 3] {
    [splat4::<T, S>(s, v[0]), splat4::<T, S>(s, v[1]), splat4::<T, S>(s, v[2])]
}

/// One vertex of each of four triangles.
#[inline(always)]
pub fn corner<T: Real, S: Simd>(s: S, block: &Block<T>, vertex: usize, order: [usize; 3]) -> [T::V4<S>; 3] {
    let v = &block.vertices[vertex];
    debug_assert!(order[0] < 3 && order[1] < 3 && order[2] < 3);
    // Sound: a heading's order is one of the three axes. Checked, the compiler reads it anew at every vertex.
    unsafe {
        [
            SimdBase::load_array_ref(s, v.get_unchecked(order[0])),
            SimdBase::load_array_ref(s, v.get_unchecked(order[1])),
            SimdBase::load_array_ref(s, v.get_unchecked(order[2])),
        ]
    }
}

/// The planes of triangles' own boxes that rays of a heading enter and leave through, like the corners in its order.
#[inline(always)]
pub fn own_box<V: Lanes>(heading: &Heading, a: [V; 3], b: [V; 3], c: [V; 3]) -> ([V; 3], [V; 3]) {
    let (mut near, mut far) = (a, a);
    for i in 0..3 {
        let (low, high) = (a[i].min(b[i]).min(c[i]), a[i].max(b[i]).max(c[i]));
        let ahead = heading.negative[heading.order[i]] == 0;
        (near[i], far[i]) = if ahead { (low, high) } else { (high, low) };
    }
    (near, far)
}
