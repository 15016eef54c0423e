//! The bounds of a scene.

use crate::dispatch;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Lists longer than this are worth more than one thread.
pub const LARGE: usize = 1 << 14;

/// The exact bounds of all triangles; zeros if there are none.
pub fn scene_bounds<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]]) -> [[T; 3]; 2] {
    scene_bounds_until(&AtomicBool::new(false), positions, faces)
}

/// The same, and of no use once `stop` is set.
pub fn scene_bounds_until<T: Real>(
    stop: &AtomicBool,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
) -> [[T; 3]; 2] {
    if faces.is_empty() {
        return [[T::zero(); 3]; 2];
    }
    let empty = || [[T::INFINITY; 4], [-T::INFINITY; 4]];
    let merge = |a: [[T; 4]; 2], b: [[T; 4]; 2]| {
        let low = std::array::from_fn(|k| Lanes::min(a[0][k], b[0][k]));
        [low, std::array::from_fn(|k| Lanes::max(a[1][k], b[1][k]))]
    };
    let of = |faces: &[[i32; 3]]| {
        let faces = if stop.load(Ordering::Relaxed) { &[] } else { faces };
        dispatch!(s => bounds_of(s, positions, faces))
    };
    let [[a, b, c, _], [x, y, z, _]] = faces.par_chunks(LARGE).map(of).reduce(empty, merge);
    [[a, b, c], [x, y, z]]
}

#[inline(always)]
fn bounds_of<T: Real, S: Simd>(s: S, positions: &[[T; 3]], faces: &[[i32; 3]]) -> [[T; 4]; 2] {
    let mut all = Box4::<T, S>::empty(s);
    for &[a, b, c] in faces {
        all = all.with(vertex(s, positions, a)).with(vertex(s, positions, b)).with(vertex(s, positions, c));
    }
    all.store()
}

/// A vertex in three lanes; what the fourth holds means nothing.
#[inline(always)]
pub fn vertex<T: Real, S: Simd>(s: S, positions: &[[T; 3]], index: i32) -> T::V4<S> {
    let index = index as usize;
    match positions.as_flattened()[3 * index..].first_chunk() {
        Some(four) => SimdBase::load_array_ref(s, four),
        None => {
            let [x, y, z] = positions[index];
            SimdBase::load_array(s, [x, y, z, z])
        }
    }
}

/// A box in the first three of four lanes.
#[derive(Clone, Copy)]
pub struct Box4<T: Real, S: Simd> {
    low: T::V4<S>,
    high: T::V4<S>,
}

impl<T: Real, S: Simd> Box4<T, S> {
    #[inline(always)]
    pub fn empty(s: S) -> Self {
        Box4 { low: SimdBase::splat(s, T::INFINITY), high: SimdBase::splat(s, -T::INFINITY) }
    }
    #[inline(always)]
    pub fn load(s: S, [low, high]: &[[T; 4]; 2]) -> Self {
        Box4 { low: SimdBase::load_array_ref(s, low), high: SimdBase::load_array_ref(s, high) }
    }
    #[inline(always)]
    pub fn store(self) -> [[T; 4]; 2] {
        [self.low.to_array(), self.high.to_array()]
    }
    #[inline(always)]
    pub fn with(self, point: T::V4<S>) -> Self {
        self.union(Box4 { low: point, high: point })
    }
    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Box4 { low: Lanes::min(self.low, other.low), high: Lanes::max(self.high, other.high) }
    }
}
