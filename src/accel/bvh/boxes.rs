//! Boxes that builders decide by: single precision, relative to the scene; upper bounds are negated, so that the union
//! of two boxes is one minimum of eight lanes.

use crate::accel::bounds::LARGE;
use crate::memory;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase, f32x8};
use bytemuck::Zeroable;
use fearless_simd::{SimdCombine, SimdSplit};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Lower bounds, something, negated upper bounds, something.
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C, align(32))]
pub struct Bounds(pub [f32; 8]);

impl Bounds {
    pub const EMPTY: Bounds = Bounds([f32::INFINITY; 8]);

    #[inline(always)]
    pub fn load<S: Simd>(&self, s: S) -> f32x8<S> {
        f32x8::load_array_ref(s, &self.0)
    }
    #[inline(always)]
    pub fn extent(&self, axis: usize) -> f32 {
        -(self.0[axis] + self.0[axis + 4])
    }
}

/// Half the surface.
#[inline(always)]
pub fn area<S: Simd>(bounds: f32x8<S>) -> f32 {
    let (low, high) = bounds.split();
    // The extents, negative; in products of two it does not matter.
    let [x, y, z, _] = (low + high).to_array();
    x * y + y * z + z * x
}

/// The centre of a box, twice, as a box.
#[inline(always)]
pub fn centre<S: Simd>(bounds: f32x8<S>) -> f32x8<S> {
    let (low, high) = bounds.split();
    let c = low - high;
    c.combine(-c)
}

/// A triangle's box. The face's number stands in the last lane, as the bits of a normal number.
#[derive(Clone, Copy, Zeroable)]
#[repr(transparent)]
pub struct Item(pub Bounds);

impl Item {
    const NORMAL: u32 = 1 << 23;

    #[inline(always)]
    fn new(low: [f32; 3], high: [f32; 3], face: usize) -> Self {
        let ([a, b, c], [x, y, z]) = (low, high);
        Item(Bounds([a, b, c, 0.0, -x, -y, -z, f32::from_bits(face as u32 + Self::NORMAL)]))
    }
    #[inline(always)]
    pub fn face(&self) -> usize {
        (self.0.0[7].to_bits() - Self::NORMAL) as usize
    }
    /// Twice the centre along an axis.
    #[inline(always)]
    pub fn centre(&self, axis: usize) -> f32 {
        self.0.0[axis] - self.0.0[axis + 4]
    }
}

/// Scales coordinates so that the longest side of the scene is one.
#[derive(Clone, Copy)]
pub struct Relative {
    low: [f64; 3],
    scale: f64,
}

impl Relative {
    pub fn to<T: Real>(bounds: &[[T; 3]; 2]) -> Self {
        let low = bounds[0].map(|x| x.to_f64());
        let extent = (0..3).map(|k| bounds[1][k].to_f64() - low[k]).fold(0.0, f64::max);
        Relative { low, scale: if extent > 0.0 { 1.0 / extent } else { 0.0 } }
    }
    /// Twice the centre of a triangle, along each axis in 0 … 2.
    #[inline(always)]
    pub fn centre<T: Real, S: Simd>(&self, corners: [T::V4<S>; 3]) -> [f64; 3] {
        let [a, b, c] = corners;
        let low = Lanes::min(Lanes::min(a, b), c).to_array();
        let high = Lanes::max(Lanes::max(a, b), c).to_array();
        let mut centre = [0.0; 3];
        for k in 0..3 {
            let (low, high) = (low[k].to_f64() - self.low[k], high[k].to_f64() - self.low[k]);
            centre[k] = (low + high) * self.scale;
        }
        centre
    }
    fn points<T: Real>(&self, positions: &[[T; 3]], stop: &AtomicBool) -> Vec<[f32; 3]> {
        let one = |p: &[T; 3], k: usize| ((p[k].to_f64() - self.low[k]) * self.scale) as f32;
        let point = |p: &[T; 3]| [one(p, 0), one(p, 1), one(p, 2)];
        let mut points = memory::zeros::<[f32; 3]>(positions.len(), stop);
        points.par_chunks_mut(LARGE).zip(positions.par_chunks(LARGE)).for_each(|(points, positions)| {
            if !stop.load(Ordering::Relaxed) {
                points.iter_mut().zip(positions).for_each(|(to, from)| *to = point(from));
            }
        });
        points
    }
}

/// A box for each face; of no use once `stop` is set.
pub fn items<T: Real>(
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    relative: Relative,
    stop: &AtomicBool,
) -> Vec<Item> {
    let points = relative.points(positions, stop);
    let item = |face: usize| {
        if stop.load(Ordering::Relaxed) {
            return Item(Bounds::EMPTY);
        }
        let [a, b, c] = faces[face].map(|v| points[v as usize]);
        let low = [least(a[0], b[0], c[0]), least(a[1], b[1], c[1]), least(a[2], b[2], c[2])];
        let high = [-least(-a[0], -b[0], -c[0]), -least(-a[1], -b[1], -c[1]), -least(-a[2], -b[2], -c[2])];
        Item::new(low, high, face)
    };
    let mut items = memory::list(faces.len());
    (0..faces.len()).into_par_iter().with_min_len(LARGE).map(item).collect_into_vec(&mut items);
    items
}

#[inline(always)]
fn least(a: f32, b: f32, c: f32) -> f32 {
    let ab = if a < b { a } else { b };
    if ab < c { ab } else { c }
}
