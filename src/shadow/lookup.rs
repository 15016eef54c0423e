//! What every lookup into a shadow map shares: the map, where a receiver falls in it, and the comparison.
//!
//! The light's frame has rows right, up, axis (the way in which light travels); depth is the distance along the axis.
//! A texel's depth is compared with that of the receiver's own tangent plane *at the texel's centre*, so that a
//! lit plane does not shadow itself however wide the filter (receiver plane bias in closed form; J. Isidoro, *Shadow
//! Mapping: GPU-based Tips and Techniques*, GDC 2006). Over a perspective map the reciprocal of the plane's depth is
//! affine in texels, over an orthographic one the depth itself: one comparison without a division in both.
//!
//! Slope-scaled and constant bias: W. Reeves, D. Salesin, R. Cook, *Rendering Antialiased Shadows with Depth Maps*,
//! 1987; normal offset: D. Holbert, *Saying "Goodbye" to Shadow Acne*, GDC 2011.

use crate::real::{Lanes, Real};
use crate::shadow::texels::Texels;
use crate::simd::*;
use crate::vec::Vec3;

/// Taps are worked on in blocks of this many.
pub const BLOCK: usize = 8;

/// A depth map seen from a light. Row 0 is the top.
#[derive(Clone, Copy)]
pub struct Map<'a, T> {
    /// Depth along the axis at texel centres; infinite where nothing was hit.
    depth: Texels<'a, T>,
    width: usize,
    height: usize,
    origin: Vec3<T>,
    /// Unit vectors: right, up, axis.
    frame: [Vec3<T>; 3],
    /// The window's left and top, at unit depth (perspective) or in world units (orthographic).
    corner: [T; 2],
    /// Texels per unit of the window.
    pub scale: [T; 2],
    /// The window's units per texel.
    texel: [T; 2],
    /// The least depth of anything that casts a shadow.
    pub near: T,
    /// Which map each receiver looks into, and which one this is; of several maps that share the work.
    chosen: Option<(&'a [u8], u8)>,
}

impl<'a, T: Real> Map<'a, T> {
    /// `window` is left, right, bottom, top. `None` unless the depths fill the size and the window has an extent.
    pub fn new(
        depth: Texels<'a, T>,
        [width, height]: [usize; 2],
        origin: [T; 3],
        frame: [[T; 3]; 3],
        window: [T; 4],
        near: T,
    ) -> Option<Self> {
        let [left, right, bottom, top] = window;
        let fits = width > 0 && height > 0 && depth.fill([width, height]);
        // Texel coordinates are exact in single precision up to there, and indices have 32 bits.
        if !fits
            || width.max(height) > 1 << 22
            || width * height > u32::MAX as usize
            || !(right > left && top > bottom)
        {
            return None;
        }
        let scale = [T::of(width as f64) / (right - left), T::of(height as f64) / (top - bottom)];
        let texel = [(right - left) / T::of(width as f64), (top - bottom) / T::of(height as f64)];
        let frame = frame.map(Vec3::from);
        Some(Map {
            depth,
            width,
            height,
            origin: origin.into(),
            frame,
            corner: [left, top],
            scale,
            texel,
            near,
            chosen: None,
        })
    }

    /// The same map for those receivers alone whose entry in `chosen` is `own`.
    pub fn only(self, chosen: &'a [u8], own: u8) -> Self {
        Map { chosen: Some((chosen, own)), ..self }
    }

    /// Whether receiver `i` looks into another map. Those beyond the list are looked up.
    #[inline(always)]
    pub fn skips(&self, i: usize) -> bool {
        match self.chosen {
            Some((chosen, own)) => i < chosen.len() && chosen[i] != own,
            None => false,
        }
    }

    /// Whether a place in texels lies on the map.
    #[inline(always)]
    pub fn holds(&self, x: T, y: T) -> bool {
        let zero = T::zero();
        x >= zero && y >= zero && x < T::of(self.width as f64) && y < T::of(self.height as f64)
    }

    /// Whether the texel at a place on the map is stored at all.
    #[inline(always)]
    pub fn resident(&self, x: T, y: T) -> bool {
        self.depth.stored(x.floor().to_f64() as u32, y.floor().to_f64() as u32)
    }

    /// The larger side of a texel in units of the window.
    #[inline(always)]
    pub fn larger_texel(&self) -> T {
        self.texel[0].max(self.texel[1])
    }

    /// Width and height in texels.
    #[inline(always)]
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The larger side of the map in texels.
    #[inline(always)]
    pub fn extent(&self) -> T {
        T::of(self.width.max(self.height) as f64)
    }
}

/// The normal of receiver `i`, where there are any.
#[inline(always)]
#[allow(clippy::manual_map)] // A closure would not be compiled for the level unless inlined.
pub fn at<T: Real>(normals: Option<&[[T; 3]]>, i: usize) -> Option<[T; 3]> {
    match normals {
        Some(n) => Some(n[i]),
        None => None,
    }
}

#[inline(always)]
fn into_frame<T: Real>([right, up, axis]: [Vec3<T>; 3], v: Vec3<T>) -> Vec3<T> {
    Vec3::new(right.dot(v), up.dot(v), axis.dot(v))
}

/// The same number in all lanes. (Not a closure: those are not compiled for the level unless inlined.)
#[inline(always)]
pub fn all<T: Real, S: Simd>(s: S, v: T) -> T::V8<S> {
    <T::V8<S> as SimdBase<S>>::splat(s, v)
}

/// The light's image on a plane at `blocker`, seen from a receiver at `depth` and projected into the map: its half
/// sides in texels. At the receiver and behind it there is none.
#[inline(always)]
pub fn light_image<T: Real, const PERSPECTIVE: bool>(
    map: &Map<'_, T>,
    depth: T,
    light: [T; 2],
    blocker: T,
) -> [T; 2] {
    let reach = if PERSPECTIVE { T::one() / blocker - T::one() / depth } else { depth - blocker };
    let reach = reach.max(T::zero()) * T::of(0.5);
    [light[0] * reach * map.scale[0], light[1] * reach * map.scale[1]]
}

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

/// A receiver as the map sees it: where it falls, and the plane that depths are compared with.
#[derive(Clone, Copy)]
pub struct Anchor<T> {
    /// Texel coordinates.
    pub x: T,
    pub y: T,
    pub depth: T,
    /// The plane at (x, y): its reciprocal depth (perspective) or its depth less the bias (orthographic).
    key: T,
    /// The plane at the centre of texel (0, 0).
    base: T,
    /// Change of the plane per texel.
    gx: T,
    gy: T,
    /// Perspective: depth times reciprocal plane depth below which a texel blocks.
    limit: T,
}

/// Where a receiver falls in a map, and how its tangent plane lies there.
#[derive(Clone, Copy)]
pub struct Foot<T> {
    /// Texel coordinates.
    pub x: T,
    pub y: T,
    pub depth: T,
    /// Change of the plane per texel: of its reciprocal depth (perspective) or of its depth.
    gx: T,
    gy: T,
}

impl<T: Real> Foot<T> {
    /// How much depth the receiver's plane gains over a texel across and one down.
    #[inline(always)]
    pub fn gain<const PERSPECTIVE: bool>(&self) -> [T; 2] {
        let per = if PERSPECTIVE { self.depth * self.depth } else { T::one() };
        [self.gx.abs() * per, self.gy.abs() * per]
    }
}

impl<T: Real> Map<'_, T> {
    /// Where a receiver falls; `Err` holds the answer where there is nothing to look up: NaN for NaN, 1 behind the
    /// light.
    #[inline(always)]
    pub fn foot<const PERSPECTIVE: bool>(
        &self,
        point: [T; 3],
        normal: Option<[T; 3]>,
        normal_offset: T,
    ) -> Result<Foot<T>, T> {
        let (zero, one) = (T::zero(), T::one());
        let mut q = into_frame(self.frame, Vec3::from(point) - self.origin);
        #[allow(clippy::manual_map)] // As in `at`.
        let n = match normal {
            Some(n) => Some(into_frame(self.frame, n.into())),
            None => None,
        };

        // Move along the normal by texels of the size that they have at the receiver's depth.
        if let Some(n) = n
            && normal_offset > zero
        {
            let texel = self.texel[0].max(self.texel[1]);
            let (texel, cosine) =
                if PERSPECTIVE { (texel * q.z, -n.dot(q) / q.length()) } else { (texel, -n.z) };
            q = q + n * (normal_offset * texel * (one - cosine * cosine).max(zero).sqrt());
        }
        let of_normal = if let Some(n) = n { n.x + n.y + n.z } else { zero };
        if (q.x + q.y + q.z + of_normal).is_nan() {
            return Err(T::NAN);
        }
        if PERSPECTIVE && !(q.z > zero) {
            return Err(one);
        }

        let inverse = one / q.z;
        let (s, t) = if PERSPECTIVE { (q.x * inverse, q.y * inverse) } else { (q.x, q.y) };
        let (x, y) = ((s - self.corner[0]) * self.scale[0], (self.corner[1] - t) * self.scale[1]);

        // The tangent plane's change per texel, where it faces the light.
        let (mut gx, mut gy) = (zero, zero);
        if let Some(n) = n {
            let facing = if PERSPECTIVE { n.dot(q) } else { -n.z };
            if (PERSPECTIVE && facing < zero) || (!PERSPECTIVE && facing > zero) {
                let per = one / facing;
                (gx, gy) = (n.x * per * self.texel[0], -n.y * per * self.texel[1]);
            }
        }
        Ok(Foot { x, y, depth: q.z, gx, gy })
    }

    /// A receiver as depths are compared with it; `Err` as in [`Map::foot`].
    #[inline(always)]
    pub fn anchor<const PERSPECTIVE: bool>(
        &self,
        point: [T; 3],
        normal: Option<[T; 3]>,
        bias: &Bias<T>,
    ) -> Result<Anchor<T>, T> {
        let Foot { x, y, depth, mut gx, mut gy } =
            self.foot::<PERSPECTIVE>(point, normal, bias.normal_offset)?;
        let (zero, one) = (T::zero(), T::one());
        let steep = gx.abs() + gy.abs();
        if !bias.plane {
            (gx, gy) = (zero, zero);
        }
        // A few roundings of the depth itself are granted always.
        let rounding = T::of(16.0) * T::EPSILON;
        let (key, limit) = if PERSPECTIVE {
            let inverse = one / depth;
            (inverse, one - rounding - bias.constant * inverse - bias.slope * steep * depth)
        } else {
            (depth - (rounding * depth.abs() + bias.constant + bias.slope * steep), one)
        };
        let half = T::of(0.5);
        let base = key + gx * (half - x) + gy * (half - y);
        Ok(Anchor { x, y, depth, key, base, gx, gy, limit })
    }

    /// Depths of the texels at offsets (in texels) from a receiver, and a bit for each that blocks it.
    ///
    /// With `NEARER`, only what is also nearer to the light than the receiver blocks: right for blockers between a
    /// receiver and an area light, where the plane may recede.
    #[inline(always)]
    pub fn taps<S: Simd, const PERSPECTIVE: bool, const NEARER: bool>(
        &self,
        s: S,
        a: &Anchor<T>,
        (ox, oy): (T::V8<S>, T::V8<S>),
    ) -> (T::V8<S>, <T::V8<S> as SimdBase<S>>::Mask) {
        let (x, y, zero) = (all::<T, S>(s, a.x), all::<T, S>(s, a.y), all::<T, S>(s, T::zero()));

        // The receiver's plane at the texel's centre, where its depth was taken.
        let (fx, fy) = (SimdFloat::floor(x + ox), SimdFloat::floor(y + oy));
        let plane = all::<T, S>(s, a.base) + all::<T, S>(s, a.gx) * fx + all::<T, S>(s, a.gy) * fy;
        // Where the plane's horizon is passed, it counts as far away.
        let plane = match (PERSPECTIVE, NEARER) {
            (true, true) => Lanes::max(plane, all::<T, S>(s, a.key)),
            (true, false) => Lanes::max(plane, all::<T, S>(s, a.key * T::of(1e-3))),
            (false, true) => Lanes::min(plane, all::<T, S>(s, a.key)),
            (false, false) => plane,
        };

        // Texels, clamped to the map; NaN goes to 0.
        let last_x = all::<T, S>(s, T::of((self.width - 1) as f64));
        let last_y = all::<T, S>(s, T::of((self.height - 1) as f64));
        let cx = Lanes::min(Lanes::max(fx, zero), last_x);
        let cy = Lanes::min(Lanes::max(fy, zero), last_y);
        let inside = cx.simd_eq(fx) & cy.simd_eq(fy);
        let (ix, iy) = (T::indices::<S>(cx), T::indices::<S>(cy));
        // SAFETY: both coordinates were clamped to the map, whose size `new` checked.
        let depth = unsafe { self.depth.block(self.width, &ix, &iy) };
        let depth =
            inside.select(<T::V8<S> as SimdBase<S>>::load_array(s, depth), all::<T, S>(s, T::INFINITY));
        let blocked =
            if PERSPECTIVE { (depth * plane).simd_lt(all::<T, S>(s, a.limit)) } else { depth.simd_lt(plane) };
        (depth, blocked)
    }

    /// The depth of the texel under a receiver if it blocks: one tap of [`Map::taps`].
    #[inline(always)]
    pub fn blocker_here<const PERSPECTIVE: bool>(&self, a: &Anchor<T>) -> Option<T> {
        let (fx, fy) = (a.x.floor(), a.y.floor());
        let size = [T::of(self.width as f64), T::of(self.height as f64)];
        if !(fx >= T::zero() && fy >= T::zero() && fx < size[0] && fy < size[1]) {
            return None;
        }
        let plane = a.base + a.gx * fx + a.gy * fy;
        let depth = self.depth.at(self.width, fx.to_f64() as usize, fy.to_f64() as usize);
        let blocks =
            if PERSPECTIVE { depth * plane.max(a.key * T::of(1e-3)) < a.limit } else { depth < plane };
        if blocks { Some(depth) } else { None }
    }
}
