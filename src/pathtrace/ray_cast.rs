//! What the centre of each pixel sees: the nearest face, without shading.
//!
//! A. Appel, *Some techniques for shading machine renderings of solids*, 1968.

use super::Pinhole;
use crate::accel::{Bvh, Hit, Ray};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::simd::Simd;

/// Pictures of `width` columns, row by row.
pub struct Seen<'a, T> {
    /// Along the ray, in units of length.
    pub t: &'a mut [T],
    pub face: &'a mut [i32],
    pub u: &'a mut [T],
    pub v: &'a mut [T],
}

pub fn ray_cast<T: Real>(
    watch: &mut dyn Watch,
    bvh: &Bvh<T>,
    camera: &Pinhole<T>,
    width: usize,
    seen: Seen<'_, T>,
) -> Result<(), Interrupted> {
    let Seen { t, face, u, v } = seen;
    parallel::for_each(
        watch,
        (t, face, u, v),
        1 << 12,
        |first, (t, face, u, v)| dispatch!(s => body(s, bvh, camera, first, width, Seen { t, face, u, v })),
    )
}

#[inline(always)]
fn body<T: Real, S: Simd>(
    s: S,
    bvh: &Bvh<T>,
    camera: &Pinhole<T>,
    first: usize,
    width: usize,
    seen: Seen<'_, T>,
) {
    let half = T::of(0.5);
    let rays: Vec<Ray<T>> = (first..first + seen.t.len())
        .map(|i| {
            let (x, y) = (T::of((i % width) as f64) + half, T::of((i / width) as f64) + half);
            Ray::new(camera.eye.to_array(), camera.direction(x, y).to_array())
        })
        .collect();
    let mut hits = vec![Hit::miss(); rays.len()];
    bvh.closest_hits(s, &rays, &mut hits);
    for (i, hit) in hits.iter().enumerate() {
        (seen.t[i], seen.face[i], seen.u[i], seen.v[i]) = (hit.t, hit.face, hit.u, hit.v);
    }
}
