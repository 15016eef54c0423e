//! The camera's rays of a wave, eight at a time.
//!
//! What a lens, a shutter or a filter of pieces needs beside is done lane by lane.

use super::camera::Camera;
use super::diffuse::{load, splat};
use super::filter::{Filter, Shape};
use super::wave::{Tracer, Wave, purpose};
use crate::accel::Ray;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};

/// Starts the paths of all slots of the wave, whose pixels are in `places`.
#[inline(always)]
pub fn start<T: Real, S: Simd>(
    s: S,
    tracer: &Tracer<'_, T>,
    camera: &Camera<T>,
    filter: &Filter,
    places: &[[u32; 2]],
    wave: &mut Wave<T>,
) {
    let mut first = 0;
    while first < places.len() {
        let n = (places.len() - first).min(8);
        let (mut keys, mut samples) = ([0u32; 8], [0u32; 8]);
        let mut at = [[T::zero(); 8]; 2];
        for l in 0..n {
            keys[l] = wave.keys[first + l];
            samples[l] = wave.samples[first + l];
            at[0][l] = T::of(f64::from(places[first + l][0]));
            at[1][l] = T::of(f64::from(places[first + l][1]));
        }
        let u = tracer.draws.pairs::<T>(&keys, &samples, purpose::PIXEL);
        let half = load::<T, S>(s, &[T::of(0.5); 8]);
        let x = load::<T, S>(s, &at[0]) + half + offset(s, filter, &u[0]);
        let y = load::<T, S>(s, &at[1]) + half + offset(s, filter, &u[1]);
        if camera.has_lens() || camera.end.is_some() {
            let lens = tracer.draws.pairs::<T>(&keys, &samples, purpose::LENS);
            let time = tracer.draws.pairs::<T>(&keys, &samples, purpose::TIME);
            let (x, y) = (x.to_array(), y.to_array());
            for l in 0..n {
                wave.start(camera.ray(x[l], y[l], [lens[0][l], lens[1][l]], time[0][l]));
            }
        } else {
            let p = &camera.start.pinhole;
            let direction = (splat(x, p.corner) + splat(x, p.right) * x + splat(x, p.down) * y).normalize();
            let (dx, dy, dz) = (direction.x.to_array(), direction.y.to_array(), direction.z.to_array());
            for l in 0..n {
                wave.start(Ray::new(p.eye.to_array(), [dx[l], dy[l], dz[l]]));
            }
        }
        first += n;
    }
}

/// [`Filter::warp1`] of eight numbers.
#[inline(always)]
fn offset<T: Real, S: Simd>(s: S, filter: &Filter, u: &[T; 8]) -> T::V8<S> {
    if filter.shape == Shape::Box {
        let u = load::<T, S>(s, u);
        return (u + u - u.num(1.0)) * u.num(filter.radius);
    }
    let mut out = [T::zero(); 8];
    for l in 0..8 {
        out[l] = filter.warp1(u[l]);
    }
    load::<T, S>(s, &out)
}
