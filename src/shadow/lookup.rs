//! What every lookup into a shadow map shares: the map, and where a receiver falls in it.
//!
//! The light's frame has rows right, up, axis (the way in which light travels); depth is the distance along the axis.

use crate::real::Real;
use crate::shadow::texels::Texels;
use crate::vec::Vec3;

/// Receivers are worked on in lots of this many.
pub const LOT: usize = 8;

/// A depth map seen from a light. Row 0 is the top.
#[derive(Clone, Copy)]
pub struct Map<'a, T> {
    /// Depth along the axis at texel centres; infinite where nothing was hit.
    pub(super) depth: Texels<'a, T>,
    pub(super) width: usize,
    height: usize,
    pub(super) origin: Vec3<T>,
    /// Unit vectors: right, up, axis.
    pub(super) frame: [Vec3<T>; 3],
    /// The window's left and top, at unit depth (perspective) or in world units (orthographic).
    pub(super) corner: [T; 2],
    /// Texels per unit of the window.
    pub scale: [T; 2],
    /// The window's units per texel.
    pub(super) texel: [T; 2],
    /// The least depth of anything that casts a shadow.
    pub near: T,
    /// The last texel across and down.
    pub(super) last: [T; 2],
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
            last: [T::of((width - 1) as f64), T::of((height - 1) as f64)],
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

    /// A bit for each of `n` receivers from `first` on that looks into this map.
    #[inline(always)]
    pub fn asks(&self, first: usize, n: usize) -> u64 {
        let mut bits = (1 << n) - 1;
        if self.chosen.is_some() {
            for k in 0..n {
                bits &= !(u64::from(self.skips(first + k)) << k);
            }
        }
        bits
    }

    /// Whether a place in texels lies on the map.
    #[inline(always)]
    pub fn holds(&self, x: T, y: T) -> bool {
        let zero = T::zero();
        x >= zero && y >= zero && x < self.last[0] + T::one() && y < self.last[1] + T::one()
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
        self.last[0].max(self.last[1]) + T::one()
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

/// Where a receiver falls in a map.
#[derive(Clone, Copy)]
pub struct Foot<T> {
    /// Texel coordinates.
    pub x: T,
    pub y: T,
    pub depth: T,
}

impl<T: Real> Map<'_, T> {
    /// Where a point falls; none for NaN and behind the light. See [`Map::feet`] for many at a time.
    #[inline(always)]
    pub fn foot<const PERSPECTIVE: bool>(&self, point: [T; 3]) -> Option<Foot<T>> {
        let q = into_frame(self.frame, Vec3::from(point) - self.origin);
        if (q.x + q.y + q.z).is_nan() || (PERSPECTIVE && !(q.z > T::zero())) {
            return None;
        }
        let inverse = T::one() / q.z;
        let (s, t) = if PERSPECTIVE { (q.x * inverse, q.y * inverse) } else { (q.x, q.y) };
        let (x, y) = ((s - self.corner[0]) * self.scale[0], (self.corner[1] - t) * self.scale[1]);
        Some(Foot { x, y, depth: q.z })
    }
}
