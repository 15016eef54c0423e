//! Shadows by rays to points on the light: the share of the light that a receiver sees, without a map.
//!
//! Points are Owen-scrambled Sobol' points, scrambled anew for each receiver. With normals, points count by the
//! irradiance that they would send, so that the fraction times the unshadowed irradiance is the shadowed one (the ratio
//! estimator of E. Heitz, S. Hill, M. McGuire, *Combining Analytic Direct Illumination and Stochastic Shadows*, 2018);
//! without, by area.

use crate::accel::{Bvh, Ray};
use crate::dispatch;
use crate::light::Light;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::sampling::sobol::{self, Scramble};
use crate::shadow::lookup::at;
use crate::simd::*;
use crate::vec::Vec3;

/// What rays are sent to.
#[derive(Clone)]
pub enum Emitter<T> {
    Point {
        position: Vec3<T>,
    },
    /// Unit vector towards the light.
    Directional {
        towards: Vec3<T>,
    },
    Rect {
        center: Vec3<T>,
        u: Vec3<T>,
        v: Vec3<T>,
    },
    /// Any light with an area, by its own draws.
    Area(Light<T>),
}

pub struct Knobs<T> {
    pub emitter: Emitter<T>,
    pub samples: usize,
    pub seed: u64,
    /// How far rays start off the surface along its normal, in world units.
    pub offset: T,
}

/// Rays in flight before they are traced together.
const BATCH: usize = 1 << 10;
/// Rays end so far before the light, as a fraction of their length, that a surface in the light's plane hides nothing.
const SHORT_OF_LIGHT: f64 = 1e-4;

/// The lit fraction of every receiver. `ignore` holds the face that each lies on, -1 for none.
pub fn ray_traced<T: Real>(
    watch: &mut dyn Watch,
    bvh: &Bvh<T>,
    receivers: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    ignore: Option<&[i32]>,
    knobs: &Knobs<T>,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let columns = sobol::columns();
    let points: Vec<[u32; 2]> = (0..knobs.samples as u32)
        .map(|i| [sobol::sobol(i, &columns[0]), sobol::sobol(i, &columns[1])])
        .collect();
    let piece = ((1 << 15) / knobs.samples).clamp(1, 1 << 12);
    parallel::for_each(
        watch,
        (receivers, normals, ignore, out),
        piece,
        |first, (p, n, ignore, out)| dispatch!(s => body(s, bvh, first, p, n, ignore, knobs, &points, out)),
    )
}

/// Rays waiting to be traced, and whose they are.
struct Batch<T> {
    rays: Vec<Ray<T>>,
    hits: Vec<bool>,
    weights: Vec<T>,
    owners: Vec<u32>,
}

#[inline(always)]
fn body<T: Real, S: Simd>(
    s: S,
    bvh: &Bvh<T>,
    first: usize,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    ignore: Option<&[i32]>,
    knobs: &Knobs<T>,
    pattern: &[[u32; 2]],
    out: &mut [T],
) {
    let room = BATCH + pattern.len();
    let mut batch = Batch {
        rays: Vec::with_capacity(room),
        hits: vec![false; room],
        weights: Vec::with_capacity(room),
        owners: Vec::with_capacity(room),
    };
    // Weights of all rays and of those that arrive.
    let mut sums = vec![[T::zero(); 2]; out.len()];
    for i in 0..out.len() {
        let face = if let Some(f) = ignore { f[i] } else { -1 };
        push(
            &mut batch,
            i as u32,
            (first + i) as u64,
            points[i].into(),
            at(normals, i),
            face,
            knobs,
            pattern,
        );
        if batch.rays.len() >= BATCH {
            flush(s, bvh, &mut batch, &mut sums);
        }
    }
    flush(s, bvh, &mut batch, &mut sums);
    for i in 0..out.len() {
        let [all, arrived] = sums[i];
        let mut check = points[i][0] + points[i][1] + points[i][2];
        if let Some(n) = normals {
            check += n[i][0] + n[i][1] + n[i][2];
        }
        out[i] = if !check.is_finite() {
            T::NAN
        } else if all > T::zero() {
            arrived / all
        } else {
            // No point of the light is above the horizon: nothing that is sent is blocked.
            T::one()
        };
    }
}

/// Adds the rays of one receiver.
#[inline(always)]
fn push<T: Real>(
    batch: &mut Batch<T>,
    owner: u32,
    index: u64,
    point: Vec3<T>,
    normal: Option<[T; 3]>,
    face: i32,
    knobs: &Knobs<T>,
    pattern: &[[u32; 2]],
) {
    let mut origin = point;
    if let Some(n) = normal {
        origin = origin + Vec3::from(n) * knobs.offset;
    }
    let short = T::one() - T::of(SHORT_OF_LIGHT);
    match &knobs.emitter {
        Emitter::Point { position } => {
            let ray = to_point(origin, *position, short, face);
            batch.add(owner, ray, weight(normal, *position - origin, None));
        }
        Emitter::Directional { towards } => {
            let ray = Ray { ignore_face: face, ..Ray::new(origin.to_array(), towards.to_array()) };
            batch.add(owner, ray, weight(normal, *towards, None));
        }
        Emitter::Rect { center, u, v } => {
            let (center, u, v) = (*center, *u, *v);
            let (x, y) = (Scramble::new(knobs.seed, index, 0), Scramble::new(knobs.seed, index, 1));
            let (half, facing) = (T::of(0.5), u.cross(v));
            for &[a, b] in pattern {
                let target = center + u * (x.fraction::<T>(a) - half) + v * (y.fraction::<T>(b) - half);
                let w = weight(normal, target - origin, Some(facing));
                if w > T::zero() {
                    batch.add(owner, to_point(origin, target, short, face), w);
                }
            }
        }
        Emitter::Area(light) => {
            let (x, y) = (Scramble::new(knobs.seed, index, 0), Scramble::new(knobs.seed, index, 1));
            for &[a, b] in pattern {
                let Some(s) = light.sight(origin, [x.fraction(a), y.fraction(b)]) else { continue };
                let w = match normal {
                    Some(n) => Vec3::from(n).dot(s.wi).max(T::zero()) / s.pdf,
                    None => T::one(),
                };
                if w > T::zero() {
                    let ray = Ray::new(origin.to_array(), s.wi.to_array());
                    batch.add(owner, Ray { t_max: s.distance * short, ignore_face: face, ..ray }, w);
                }
            }
        }
    }
}

#[inline(always)]
fn to_point<T: Real>(origin: Vec3<T>, target: Vec3<T>, short: T, face: i32) -> Ray<T> {
    let towards = (target - origin).to_array();
    Ray { t_max: short, ignore_face: face, ..Ray::new(origin.to_array(), towards) }
}

/// What a point of the light counts for, up to a factor: cosines over squared distance, or 1 without a normal.
#[inline(always)]
fn weight<T: Real>(normal: Option<[T; 3]>, towards: Vec3<T>, facing: Option<Vec3<T>>) -> T {
    let Some(n) = normal else { return T::one() };
    let cosine = Vec3::from(n).dot(towards).max(T::zero());
    match facing {
        None => cosine,
        Some(f) => {
            let r2 = towards.length_squared();
            cosine * f.dot(towards).abs() / (r2 * r2)
        }
    }
}

impl<T: Real> Batch<T> {
    #[inline(always)]
    fn add(&mut self, owner: u32, ray: Ray<T>, weight: T) {
        self.rays.push(ray);
        self.weights.push(weight);
        self.owners.push(owner);
    }
}

#[inline(always)]
fn flush<T: Real, S: Simd>(s: S, bvh: &Bvh<T>, batch: &mut Batch<T>, sums: &mut [[T; 2]]) {
    let n = batch.rays.len();
    bvh.any_hits(s, &batch.rays, &mut batch.hits[..n]);
    for i in 0..n {
        let (sum, weight) = (&mut sums[batch.owners[i] as usize], batch.weights[i]);
        sum[0] += weight;
        if !batch.hits[i] {
            sum[1] += weight;
        }
    }
    batch.rays.clear();
    batch.weights.clear();
    batch.owners.clear();
}
