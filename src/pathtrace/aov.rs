//! What the camera sees beside light: albedo, normal, depth, position, which face of which thing, and where it goes.
//!
//! Denoisers and temporal filters ask for these. Numbers are means over a pixel's samples, drawn as those of light are
//! (filter, lens); identity and motion cannot be averaged and are those of the ray through the pixel's centre.
//!
//! Motion is where the point seen at time 0 stands in the picture at time 1, less where it is seen: by the camera's
//! movement and the thing's own. What is at infinity moves as its direction does.
//!
//! T. Saito, T. Takahashi, *Comprehensible rendering of 3-D shapes*, 1990.

use super::Surfaces;
use super::camera::{Camera, Pose};
use super::filter::Filter;
use crate::accel::{Hit, Ray};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::sampling::generator::Generator;
use crate::simd::Simd;
use crate::vec::Vec3;

/// What can be seen. Indices are in range.
pub struct Things<'a, T> {
    pub scene: &'a Surfaces<'a, T>,
    /// Where vertices are at time 1, if any moves; copies of meshes do not.
    pub moved: Option<&'a [[T; 3]]>,
    /// The instance of each face that is of no copy, and of each copy.
    pub instances: [&'a [i32]; 2],
    /// Of each material.
    pub albedo: &'a [[T; 3]],
}

/// Pictures, row by row.
pub struct Aovs<'a, T> {
    /// Part of the samples that meet something.
    pub coverage: &'a mut [T],
    pub albedo: &'a mut [[T; 3]],
    pub normal: &'a mut [[T; 3]],
    /// Along the camera's axis.
    pub depth: &'a mut [T],
    pub position: &'a mut [[T; 3]],
    pub face: &'a mut [i32],
    pub instance: &'a mut [i32],
    pub material: &'a mut [i32],
    /// In pixels to the right and down.
    pub motion: &'a mut [[T; 2]],
}

/// How pictures are sampled: `count` samples from the `start`-th on; none looks through the pixels' centres alone.
#[derive(Clone, Copy)]
pub struct Samples {
    pub width: usize,
    pub count: u32,
    pub start: u32,
    pub seed: u64,
}

/// Sums over the samples of a pixel.
#[derive(Clone, Copy, Default)]
struct Sums {
    hits: f64,
    albedo: [f64; 3],
    normal: [f64; 3],
    depth: f64,
    position: [f64; 3],
}

impl<T: Real> Things<'_, T> {
    #[inline(always)]
    fn interpolate(&self, corners: [[T; 3]; 3], hit: &Hit<T>) -> Vec3<T> {
        let [a, b, c] = corners.map(Vec3::from);
        a * (T::one() - hit.u - hit.v) + b * hit.u + c * hit.v
    }

    #[inline(always)]
    fn add(&self, pose: &Pose<T>, hit: &Hit<T>, copy: i32, sums: &mut Sums) {
        if !hit.is_hit() {
            return;
        }
        let (scene, face) = (self.scene, hit.face as usize);
        let corners = scene.corners_of(face, copy);
        let point = self.interpolate(corners, hit);
        let mut albedo = Vec3::from(self.albedo[scene.row_of(face, copy)]);
        if let Some(colors) = scene.colors {
            albedo = albedo.times(self.interpolate(scene.colors_of(face, copy, colors), hit));
        }
        let [a, b, c] = corners.map(Vec3::from);
        let mut normal = (b - a).cross(c - a).normalize();
        if let Some(normals) = scene.normals {
            let shading = self.interpolate(scene.normals_of(face, copy, normals), hit).normalize();
            normal = if shading.x.is_nan() { normal } else { shading };
        }
        sums.hits += 1.0;
        sums.depth += pose.depth(point).to_f64();
        for (sum, v) in [(&mut sums.albedo, albedo), (&mut sums.normal, normal), (&mut sums.position, point)]
        {
            let v = v.to_array();
            (0..3).for_each(|c| sum[c] += v[c].to_f64());
        }
    }

    /// How far what the centre's ray sees moves in the picture, from `start`'s to `end`'s.
    #[inline(always)]
    fn motion(&self, start: &Pose<T>, end: &Pose<T>, ray: &Ray<T>, hit: &Hit<T>, copy: i32) -> [T; 2] {
        let (from, to) = if hit.is_hit() {
            let face = hit.face as usize;
            let point = self.interpolate(self.scene.corners_of(face, copy), hit);
            let then = match self.moved {
                Some(moved) if copy < 0 => {
                    self.interpolate(self.scene.faces[face].map(|v| moved[v as usize]), hit)
                }
                _ => point,
            };
            (start.seen(point - start.pinhole.eye), end.seen(then - end.pinhole.eye))
        } else {
            let direction = ray.direction.into();
            (start.seen(direction), end.seen(direction))
        };
        [to[0] - from[0], to[1] - from[1]]
    }
}

pub fn aovs<T: Real>(
    watch: &mut dyn Watch,
    things: &Things<'_, T>,
    camera: &Camera<T>,
    filter: &Filter,
    samples: Samples,
    out: Aovs<'_, T>,
) -> Result<(), Interrupted> {
    // About 10 ms of rays.
    let piece = (1 << 14) / (samples.count as usize + 1);
    let Aovs { coverage, albedo, normal, depth, position, face, instance, material, motion } = out;
    parallel::for_each(
        watch,
        (coverage, albedo, normal, depth, position, face, instance, material, motion),
        piece.clamp(1, 1 << 12),
        |first, (coverage, albedo, normal, depth, position, face, instance, material, motion)| {
            let out = Aovs { coverage, albedo, normal, depth, position, face, instance, material, motion };
            dispatch!(s => body(s, things, camera, filter, samples, first, out))
        },
    )
}

#[inline(always)]
fn body<T: Real, S: Simd>(
    s: S,
    things: &Things<'_, T>,
    camera: &Camera<T>,
    filter: &Filter,
    samples: Samples,
    first: usize,
    out: Aovs<'_, T>,
) {
    let n = out.depth.len();
    let (random, half) = (Generator::new(samples.seed), T::of(0.5));
    let (start, end) = (camera.pose(T::zero()), camera.pose(T::one()));
    let mut rays = Vec::with_capacity(n);
    let mut poses = Vec::with_capacity(n);
    let mut hits = vec![Hit::miss(); n];
    let mut copies = vec![-1; n];
    let mut sums = vec![Sums::default(); n];
    // The centres last: theirs are the ids.
    for k in 0..=samples.count {
        let centre = k == samples.count;
        rays.clear();
        poses.clear();
        for i in first..first + n {
            let (x, y) = (T::of((i % samples.width) as f64) + half, T::of((i / samples.width) as f64) + half);
            if centre {
                rays.push(start.ray(x, y, [half; 2]));
                poses.push(start);
            } else {
                let u: [T; 4] = random.quad(i as u64, samples.start + k, 0);
                let time: [T; 4] = random.quad(i as u64, samples.start + k, 1);
                let [dx, dy] = filter.warp([u[0], u[1]]);
                let pose = camera.pose(camera.moment(time[0]));
                rays.push(pose.ray(x + dx, y + dy, [u[2], u[3]]));
                poses.push(pose);
            }
        }
        things.scene.closest_hits(s, &rays, &mut hits, &mut copies);
        if !centre || samples.count == 0 {
            for i in 0..n {
                things.add(&poses[i], &hits[i], copies[i], &mut sums[i]);
            }
        }
    }
    let share = 1.0 / f64::from(samples.count.max(1));
    for i in 0..n {
        let sum = &sums[i];
        let hit = if sum.hits > 0.0 { 1.0 / sum.hits } else { 0.0 };
        out.coverage[i] = T::of(sum.hits * share);
        out.albedo[i] = sum.albedo.map(|x| T::of(x * share));
        out.normal[i] = sum.normal.map(|x| T::of(x * share));
        out.depth[i] = if sum.hits > 0.0 { T::of(sum.depth * hit) } else { T::INFINITY };
        out.position[i] = sum.position.map(|x| T::of(x * hit));
        let (seen, copy) = (&hits[i], copies[i]);
        (out.face[i], out.instance[i], out.material[i]) = (seen.face, -1, -1);
        if seen.is_hit() {
            let face = seen.face as usize;
            out.material[i] = things.scene.row_of(face, copy) as i32;
            out.instance[i] =
                if copy < 0 { things.instances[0][face] } else { things.instances[1][copy as usize] };
        }
        out.motion[i] = things.motion(&start, &end, &rays[i], seen, copy);
    }
}
