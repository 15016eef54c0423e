//! Shadows by rays to points on the light: the share of the light that a receiver sees, without a map.
//!
//! Points come from any sampler, drawn anew for each receiver (by default Owen-scrambled Sobol' points), or are one set
//! for all, shifted by each receiver's own offset. With normals, points count by the irradiance that they would send, so that the fraction times the unshadowed irradiance is the shadowed one (the ratio
//! estimator of E. Heitz, S. Hill, M. McGuire, *Combining Analytic Direct Illumination and Stochastic Shadows*, 2018);
//! without, by area.

use crate::accel::{Bvh, Ray};
use crate::dispatch;
use crate::light::Light;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::sampling::sampler::Sampler;
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

pub struct Knobs<'a, T> {
    pub emitter: Emitter<T>,
    pub samples: usize,
    pub sampler: Sampler,
    /// What each receiver's points are shifted by on the torus; all then share those of the first.
    pub shifts: Option<&'a [[T; 2]]>,
    /// How far rays start off the surface along its normal, in world units.
    pub offset: T,
}

/// Rays in flight before they are traced together.
const BATCH: usize = 1 << 10;
/// Rays end so far before the light, as a fraction of their length, that a surface in the light's plane hides nothing.
const SHORT_OF_LIGHT: f64 = 1e-4;

/// Points of the unit square that rays are sent through.
enum Points<'a, T> {
    Sobol { seed: u64, points: Vec<[u32; 2]> },
    Drawn { sampler: Sampler, samples: u32 },
    Shifted { points: Vec<[T; 2]>, shifts: &'a [[T; 2]] },
}

impl<'a, T: Real> Points<'a, T> {
    fn new(knobs: &Knobs<'a, T>) -> Self {
        let samples = knobs.samples as u32;
        if let Some(shifts) = knobs.shifts {
            let points = (0..samples).map(|k| knobs.sampler.pair(0, k, 0)).collect();
            return Points::Shifted { points, shifts };
        }
        match knobs.sampler {
            // Worked out once; receivers differ by how they scramble them.
            Sampler::Sobol { seed } => {
                let columns = sobol::columns();
                let point = |i| [sobol::sobol(i, &columns[0]), sobol::sobol(i, &columns[1])];
                Points::Sobol { seed, points: (0..samples).map(point).collect() }
            }
            sampler => Points::Drawn { sampler, samples },
        }
    }

    #[inline(always)]
    fn count(&self) -> usize {
        match self {
            Points::Sobol { points, .. } => points.len(),
            Points::Drawn { samples, .. } => *samples as usize,
            Points::Shifted { points, .. } => points.len(),
        }
    }
}

/// One receiver's points.
struct Draw<'a, T> {
    points: &'a Points<'a, T>,
    receiver: u64,
    scrambles: [Scramble; 2],
}

impl<'a, T: Real> Draw<'a, T> {
    #[inline(always)]
    fn new(points: &'a Points<'a, T>, receiver: u64) -> Self {
        let seed = if let Points::Sobol { seed, .. } = points { *seed } else { 0 };
        let scrambles = [Scramble::new(seed, receiver, 0), Scramble::new(seed, receiver, 1)];
        Draw { points, receiver, scrambles }
    }

    #[inline(always)]
    fn at(&self, k: usize) -> [T; 2] {
        match self.points {
            Points::Sobol { points, .. } => {
                let [x, y] = &self.scrambles;
                [x.fraction(points[k][0]), y.fraction(points[k][1])]
            }
            Points::Drawn { sampler, .. } => sampler.pair(self.receiver, k as u32, 0),
            Points::Shifted { points, shifts } => {
                let shift = shifts[self.receiver as usize];
                let (x, y) = (points[k][0] + shift[0], points[k][1] + shift[1]);
                [x - x.floor(), y - y.floor()]
            }
        }
    }
}

/// The lit fraction of every receiver. `ignore` holds the face that each lies on, -1 for none.
pub fn ray_traced<T: Real>(
    watch: &mut dyn Watch,
    bvh: &Bvh<T>,
    receivers: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    ignore: Option<&[i32]>,
    knobs: &Knobs<'_, T>,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let points = Points::new(knobs);
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
    knobs: &Knobs<'_, T>,
    pattern: &Points<'_, T>,
    out: &mut [T],
) {
    let room = BATCH + pattern.count();
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
    knobs: &Knobs<'_, T>,
    pattern: &Points<'_, T>,
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
            let draw = Draw::new(pattern, index);
            let (half, facing) = (T::of(0.5), u.cross(v));
            for k in 0..pattern.count() {
                let [x, y] = draw.at(k);
                let target = center + u * (x - half) + v * (y - half);
                let w = weight(normal, target - origin, Some(facing));
                if w > T::zero() {
                    batch.add(owner, to_point(origin, target, short, face), w);
                }
            }
        }
        Emitter::Area(light) => {
            let draw = Draw::new(pattern, index);
            for k in 0..pattern.count() {
                let Some(s) = light.sight(origin, draw.at(k)) else { continue };
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
