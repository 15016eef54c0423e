//! The comparison of receivers with a map's depths, a lot of them at a time: a lane for each.
//!
//! A texel's depth is compared with that of the receiver's own tangent plane *at the texel's centre*, so that a
//! lit plane does not shadow itself however wide the filter (receiver plane bias in closed form; J. Isidoro, *Shadow
//! Mapping: GPU-based Tips and Techniques*, GDC 2006). Over a perspective map the reciprocal of the plane's depth is
//! affine in texels, over an orthographic one the depth itself: one comparison without a division in both.
//!
//! Slope-scaled and constant bias: W. Reeves, D. Salesin, R. Cook, *Rendering Antialiased Shadows with Depth Maps*,
//! 1987; normal offset: D. Holbert, *Saying "Goodbye" to Shadow Acne*, GDC 2011.

use crate::real::{Lanes, Real};
use crate::shadow::lookup::{LOT, Map};
use crate::simd::*;
use crate::vec::Vec3;

/// Units in the last place of depths that are granted always.
const ROUNDINGS: f64 = 16.0;

/// What is granted to a receiver before it counts as shadowed.
#[derive(Clone, Copy)]
pub struct Bias<T> {
    /// World units along the axis.
    pub constant: T,
    /// Texels: as much depth as the receiver's plane gains over them.
    pub slope: T,
    /// Texels: the receiver moves along its normal by them times the sine of the light's angle to it.
    pub normal_offset: T,
    /// Whether depths are compared with the receiver's plane, or with its one depth.
    pub plane: bool,
}

/// Where receivers fall in a map, and how their tangent planes lie there.
#[derive(Clone, Copy)]
pub struct Feet<V> {
    /// Texel coordinates.
    pub x: V,
    pub y: V,
    pub depth: V,
    /// One by it.
    inverse: V,
    /// Change of the plane per texel: of its reciprocal depth (perspective) or of its depth.
    gx: V,
    gy: V,
    /// Depth that may be nothing but rounding: a few units in the last place of the receiver's coordinates and of the
    /// depth itself.
    pub rounding: V,
    /// A bit for each receiver that there is something to look up for.
    pub live: u64,
    /// What the others get: NaN for NaN, 1 behind the light.
    pub answer: V,
}

impl<V: Lanes> Feet<V> {
    /// How much depth the receivers' planes gain over a texel across and one down.
    #[inline(always)]
    pub fn gain<const PERSPECTIVE: bool>(&self) -> [V; 2] {
        let per = if PERSPECTIVE { self.depth * self.depth } else { self.depth.num(1.0) };
        [self.gx.abs() * per, self.gy.abs() * per]
    }
}

/// Receivers as depths are compared with them.
#[derive(Clone, Copy)]
pub struct Anchor<V> {
    pub x: V,
    pub y: V,
    pub depth: V,
    /// The plane at (x, y): its reciprocal depth (perspective) or its depth less the bias (orthographic).
    key: V,
    /// The plane at the centre of texel (0, 0).
    base: V,
    /// Change of the plane per texel.
    gx: V,
    gy: V,
    /// Perspective: depth times reciprocal plane depth below which a texel blocks.
    limit: V,
    /// As of [`Feet`].
    pub live: u64,
    pub answer: V,
}

/// A truth value a lane.
pub type Mask<T, S> = <<T as Real>::V8<S> as SimdBase<S>>::Mask;

/// The same number in all lanes. (Not a closure: those are not compiled for the level unless inlined.)
#[inline(always)]
pub fn all<T: Real, S: Simd>(s: S, v: T) -> T::V8<S> {
    <T::V8<S> as SimdBase<S>>::splat(s, v)
}

/// Numbers as lanes.
#[inline(always)]
pub fn lanes<T: Real, S: Simd>(s: S, v: [T; LOT]) -> T::V8<S> {
    <T::V8<S> as SimdBase<S>>::load_array(s, v)
}

/// Lanes in double.
#[inline(always)]
pub fn double<T: Real, S: Simd>(s: S, v: T::V8<S>) -> <f64 as Real>::V8<S> {
    let v = v.as_slice();
    let mut wide = [0.0; LOT];
    for k in 0..LOT {
        wide[k] = v[k].to_f64();
    }
    lanes::<f64, S>(s, wide)
}

/// Lanes from double.
#[inline(always)]
pub fn single<T: Real, S: Simd>(s: S, v: <f64 as Real>::V8<S>) -> T::V8<S> {
    let v = v.as_slice();
    let mut narrow = [T::zero(); LOT];
    for k in 0..LOT {
        narrow[k] = T::of(v[k]);
    }
    lanes::<T, S>(s, narrow)
}

/// Lanes of set bits.
#[inline(always)]
pub fn mask<T: Real, S: Simd>(s: S, bits: u64) -> Mask<T, S> {
    <Mask<T, S> as SimdMask<S>>::from_bitmask(s, bits)
}

/// A lot of vectors from `first` on; beyond the end the last one again.
#[inline(always)]
fn lot<T: Real, S: Simd>(s: S, vectors: &[[T; 3]], first: usize) -> Vec3<T::V8<S>> {
    let mut c = [[T::zero(); LOT]; 3];
    for k in 0..LOT {
        let v = vectors[(first + k).min(vectors.len() - 1)];
        (c[0][k], c[1][k], c[2][k]) = (v[0], v[1], v[2]);
    }
    Vec3::new(lanes::<T, S>(s, c[0]), lanes::<T, S>(s, c[1]), lanes::<T, S>(s, c[2]))
}

#[inline(always)]
fn wide<T: Real, S: Simd>(s: S, v: Vec3<T>) -> Vec3<T::V8<S>> {
    Vec3::new(all::<T, S>(s, v.x), all::<T, S>(s, v.y), all::<T, S>(s, v.z))
}

/// Writes those of a lot's lanes whose bit is set.
#[inline(always)]
pub fn put<T: Real, S: Simd>(out: &mut [T], first: usize, bits: u64, values: T::V8<S>) {
    let values = values.as_slice();
    for k in 0..LOT {
        if bits >> k & 1 == 1 {
            out[first + k] = values[k];
        }
    }
}

/// Filters beyond twice the map's extent see nothing more.
#[inline(always)]
pub fn limited<T: Real, S: Simd>(s: S, map: &Map<'_, T>, [x, y]: [T::V8<S>; 2]) -> [T::V8<S>; 2] {
    let limit = all::<T, S>(s, map.extent() + map.extent());
    [Lanes::min(x, limit), Lanes::min(y, limit)]
}

/// The light's image on planes at `blocker`, seen from receivers at `depth` and projected into the map: its half
/// sides in texels. At the receiver and behind it there is none.
#[inline(always)]
pub fn light_image<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    depth: T::V8<S>,
    light: [T; 2],
    blocker: T::V8<S>,
) -> [T::V8<S>; 2] {
    let one = all::<T, S>(s, T::one());
    let reach = if PERSPECTIVE { one / blocker - one / depth } else { depth - blocker };
    let reach = Lanes::max(reach, all::<T, S>(s, T::zero())) * all::<T, S>(s, T::of(0.5));
    let (x, y) = (light[0] * map.scale[0], light[1] * map.scale[1]);
    limited::<T, S>(s, map, [reach * all::<T, S>(s, x), reach * all::<T, S>(s, y)])
}

/// `found` where there was something to look up.
#[inline(always)]
pub fn or_answer<T: Real, S: Simd>(s: S, a: &Anchor<T::V8<S>>, found: T::V8<S>) -> T::V8<S> {
    mask::<T, S>(s, a.live).select(found, a.answer)
}

impl<T: Real> Map<'_, T> {
    /// Where receivers from `first` of the lists on fall.
    #[inline(always)]
    pub fn feet<S: Simd, const PERSPECTIVE: bool>(
        &self,
        s: S,
        points: &[[T; 3]],
        normals: Option<&[[T; 3]]>,
        first: usize,
        normal_offset: T,
    ) -> Feet<T::V8<S>> {
        let (zero, one) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()));
        let point = lot::<T, S>(s, points, first);
        let away = point - wide::<T, S>(s, self.origin);
        let frame =
            [wide::<T, S>(s, self.frame[0]), wide::<T, S>(s, self.frame[1]), wide::<T, S>(s, self.frame[2])];
        let mut q = Vec3::new(frame[0].dot(away), frame[1].dot(away), frame[2].dot(away));
        let (texel_x, texel_y) = (all::<T, S>(s, self.texel[0]), all::<T, S>(s, self.texel[1]));
        let mut check = zero;

        // The tangent plane's change per texel, where it faces the light.
        let (mut gx, mut gy) = (zero, zero);
        if let Some(normals) = normals {
            let n = lot::<T, S>(s, normals, first);
            let n = Vec3::new(frame[0].dot(n), frame[1].dot(n), frame[2].dot(n));
            // Move along the normal by texels of the size that they have at the receiver's depth.
            if normal_offset > T::zero() {
                let texel = Lanes::max(texel_x, texel_y);
                let (texel, cosine) = if PERSPECTIVE {
                    (texel * q.z, -n.dot(q) / Lanes::sqrt(q.dot(q)))
                } else {
                    (texel, -n.z)
                };
                let sine = Lanes::sqrt(Lanes::max(one - cosine * cosine, zero));
                q = q + n * (all::<T, S>(s, normal_offset) * texel * sine);
            }
            check = n.x + n.y + n.z;
            // Below zero where the plane looks at the light.
            let facing = if PERSPECTIVE { n.dot(q) } else { n.z };
            let per = facing.simd_lt(zero).select(one / facing, zero);
            let per = if PERSPECTIVE { per } else { -per };
            (gx, gy) = (n.x * per * texel_x, -n.y * per * texel_y);
        }
        check = check + q.x + q.y + q.z;
        let numbers = check.simd_eq(check);
        let before = if PERSPECTIVE { q.z.simd_gt(zero) } else { numbers };

        let inverse = one / q.z;
        let (u, v) = if PERSPECTIVE { (q.x * inverse, q.y * inverse) } else { (q.x, q.y) };
        let x = (u - all::<T, S>(s, self.corner[0])) * all::<T, S>(s, self.scale[0]);
        let y = (all::<T, S>(s, self.corner[1]) - v) * all::<T, S>(s, self.scale[1]);

        let of_point = Lanes::max(Lanes::max(Lanes::abs(point.x), Lanes::abs(point.y)), Lanes::abs(point.z));
        // Coordinates were rounded once, by half a unit each; the light's are the map's own.
        let sizes = Lanes::abs(q.z) + of_point * all::<T, S>(s, T::of(0.125));
        let rounding = all::<T, S>(s, T::of(ROUNDINGS) * T::EPSILON) * sizes;
        let live = (numbers & before).to_bitmask();
        let answer = numbers.select(one, all::<T, S>(s, T::NAN));
        Feet { x, y, depth: q.z, inverse, gx, gy, rounding, live, answer }
    }

    /// Receivers from `first` of the lists on, as depths are compared with them.
    #[inline(always)]
    pub fn anchor<S: Simd, const PERSPECTIVE: bool>(
        &self,
        s: S,
        points: &[[T; 3]],
        normals: Option<&[[T; 3]]>,
        first: usize,
        bias: &Bias<T>,
    ) -> Anchor<T::V8<S>> {
        let (zero, one) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()));
        let Feet { x, y, depth, inverse, mut gx, mut gy, rounding, live, answer } =
            self.feet::<S, PERSPECTIVE>(s, points, normals, first, bias.normal_offset);
        let steep = Lanes::abs(gx) + Lanes::abs(gy);
        if !bias.plane {
            (gx, gy) = (zero, zero);
        }
        // Rounding is granted always.
        let constant = all::<T, S>(s, bias.constant) + rounding;
        let slope = all::<T, S>(s, bias.slope) * steep;
        let (key, limit) = if PERSPECTIVE {
            (inverse, one - constant * inverse - slope * depth)
        } else {
            (depth - (constant + slope), one)
        };
        let half = all::<T, S>(s, T::of(0.5));
        let base = key + gx * (half - x) + gy * (half - y);
        Anchor { x, y, depth, key, base, gx, gy, limit, live, answer }
    }

    /// Depths of the texels at offsets (in texels) from receivers, and whether each blocks its own.
    ///
    /// With `NEARER`, only what is also nearer to the light than the receiver blocks: right for blockers between a
    /// receiver and an area light, where the plane may recede.
    #[inline(always)]
    pub fn tap<S: Simd, const PERSPECTIVE: bool, const NEARER: bool>(
        &self,
        s: S,
        a: &Anchor<T::V8<S>>,
        (ox, oy): (T::V8<S>, T::V8<S>),
    ) -> (T::V8<S>, Mask<T, S>) {
        let zero = all::<T, S>(s, T::zero());
        // The receiver's plane at the texel's centre, where its depth was taken.
        let (fx, fy) = (SimdFloat::floor(a.x + ox), SimdFloat::floor(a.y + oy));
        let plane = a.base + a.gx * fx + a.gy * fy;
        // Where the plane's horizon is passed, it counts as far away.
        let plane = match (PERSPECTIVE, NEARER) {
            (true, true) => Lanes::max(plane, a.key),
            (true, false) => Lanes::max(plane, a.key * all::<T, S>(s, T::of(1e-3))),
            (false, true) => Lanes::min(plane, a.key),
            (false, false) => plane,
        };

        // Texels, clamped to the map; NaN goes to 0.
        let cx = Lanes::min(Lanes::max(fx, zero), all::<T, S>(s, self.last[0]));
        let cy = Lanes::min(Lanes::max(fy, zero), all::<T, S>(s, self.last[1]));
        let inside = cx.simd_eq(fx) & cy.simd_eq(fy);
        // SAFETY: both coordinates were clamped to the map, whose size `new` checked.
        let depth = unsafe { self.depth.lot(s, self.width, cx, cy) };
        let depth = inside.select(depth, all::<T, S>(s, T::INFINITY));
        let blocked = if PERSPECTIVE { (depth * plane).simd_lt(a.limit) } else { depth.simd_lt(plane) };
        (depth, blocked)
    }
}
