//! Linearly transformed cosines: the mirrors' light from a polygon without a sample.
//!
//! A lobe of GGX times the cosine is approximated by a cosine lobe that a matrix has sheared and stretched; taken back by
//! the inverse, the polygon's integral over the lobe is Lambert's formula over the polygon seen from there. A table over
//! roughness and angle holds the inverse, the lobe's magnitude, and what of it Schlick's grazing term weighs. The formula
//! gives the share of the lobe that the polygon fills: it is the magnitude that makes light of it. The polygon is clipped
//! at the surface's horizon first, then at that of the cosine; the share is of the part of the lobe above the surface, so
//! that a light all around gives the magnitude. A cosine lobe needs no fit: [`super::polygon`] has it exactly.
//!
//! E. Heitz, J. Dupuy, S. Hill, D. Neubelt, *Real-time polygonal-light shading with linearly transformed cosines*, 2016;
//! S. Hill, E. Heitz, *LTC Fresnel approximation*, 2016.

#[cfg_attr(not(feature = "python"), allow(dead_code))] // asked for by Python alone
pub(crate) mod fit;

use super::Light;
use super::polygon::{self, doubled};
use super::textured::Textured;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;
use std::sync::OnceLock;

/// Numbers of a lobe: see [`Lobe`].
pub const ENTRIES: usize = 6;
/// Steps along roughness and along angle of the table that is shipped.
pub const SIZE: usize = 32;

/// A cosine lobe made into one of GGX for one direction of the eye, in the plane of the normal (z) and the eye (x).
#[derive(Clone, Copy, Debug)]
pub struct Lobe {
    /// The inverse matrix over its middle entry, row by row without the zeros: (xx, xz), (zx, zz).
    pub inverse: [f64; 4],
    /// ∫ f cos θ dω without Fresnel, and that weighed by (1 − wi·h)⁵.
    pub magnitude: f64,
    pub grazing: f64,
}

/// A grid of lobes: over √alpha evenly in [0, 1], and over √(1 − cos θ) evenly in [0, 1].
#[derive(Clone, Debug)]
pub struct Table {
    /// One row a roughness; the last row of each inverse is divided by the row's alpha.
    pub lobes: Vec<[f32; ENTRIES]>,
    pub angles: usize,
}

/// Alpha of a row of `rows`.
pub fn alpha_of(row: usize, rows: usize) -> f64 {
    let roughness = row as f64 / (rows - 1) as f64;
    f64::max(roughness * roughness, crate::brdf::metallic_roughness::MIN_ALPHA)
}

/// The table that is shipped.
pub fn shipped() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| {
        // Text that the compiler sees: every word of it is a number.
        let numbers: Vec<f32> = include_str!("table_data.txt")
            .split_whitespace()
            .map(|w| w.parse().unwrap_or(f32::NAN))
            .collect();
        Table { lobes: numbers.as_chunks().0.to_vec(), angles: SIZE }
    })
}

impl Table {
    /// The lobe of an alpha in [0, 1] for a cosine of the eye in (0, 1], between four of the grid.
    #[inline(always)]
    pub fn lobe(&self, alpha: f64, cos_theta: f64) -> Lobe {
        let rows = self.lobes.len() / self.angles;
        let place = |t: f64, n: usize| {
            let t = Lanes::min(Lanes::max(t, 0.0), 1.0) * (n - 1) as f64;
            let i = (t as usize).min(n - 2);
            (i, t - i as f64)
        };
        let (i, s) = place(alpha.sqrt(), rows);
        let (j, t) = place(Lanes::max(1.0 - cos_theta, 0.0).sqrt(), self.angles);
        let at = |i: usize, j: usize| &self.lobes[i * self.angles + j];
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
        let mut entry = [0.0; ENTRIES];
        for k in 0..ENTRIES {
            let (first, second) = (
                f64::from(a[k]) * (1.0 - t) + f64::from(b[k]) * t,
                f64::from(c[k]) * (1.0 - t) + f64::from(d[k]) * t,
            );
            entry[k] = first * (1.0 - s) + second * s;
        }
        let [xx, xz, zx, zz, magnitude, grazing] = entry;
        let alpha = Lanes::max(alpha, crate::brdf::metallic_roughness::MIN_ALPHA);
        Lobe { inverse: [xx, xz, zx * alpha, zz * alpha], magnitude, grazing }
    }
}

impl Lobe {
    #[inline(always)]
    fn straighten(&self, v: Vec3<f64>) -> Vec3<f64> {
        let [xx, xz, zx, zz] = self.inverse;
        Vec3::new(xx * v.x + xz * v.z, v.y, zx * v.x + zz * v.z)
    }

    /// The density of the lobe per solid angle of a unit direction.
    #[inline(always)]
    pub fn density(&self, w: Vec3<f64>) -> f64 {
        let [xx, xz, zx, zz] = self.inverse;
        let v = self.straighten(w);
        let squared = v.length_squared();
        let determinant = (xx * zz - xz * zx).abs();
        Lanes::max(v.z, 0.0) * determinant / (std::f64::consts::PI * squared * squared)
    }

    /// The share of the lobe above the surface's horizon: the horizon is straightened into a great circle, and what a
    /// cosine lobe has on one side of it is (1 + cos) / 2 by the angle between both axes.
    #[inline(always)]
    pub fn above(&self) -> f64 {
        let [xx, _, zx, _] = self.inverse;
        0.5 + 0.5 * xx / (xx * xx + zx * zx).sqrt()
    }

    /// The share of the lobe that a polygon fills, seen in the frame of normal and eye; positive where its front is
    /// seen. `scratch` holds corners on the way.
    #[inline(always)]
    pub fn share(&self, corners: impl Iterator<Item = Vec3<f64>>, scratch: &mut Vec<Vec3<f64>>) -> f64 {
        self.seen(corners, scratch).z
    }

    /// [`Lobe::share`], and beside it the middle of what is filled: the mean direction of the polygon, straightened.
    #[inline(always)]
    fn seen(&self, corners: impl Iterator<Item = Vec3<f64>>, scratch: &mut Vec<Vec3<f64>>) -> Vec3<f64> {
        scratch.clear();
        let mut first = None;
        let mut before = Vec3::splat(0.0);
        let mut push = |before: Vec3<f64>, corner: Vec3<f64>| {
            if (before.z > 0.0) != (corner.z > 0.0) {
                let mut crossing = before + (corner - before) * (before.z / (before.z - corner.z));
                crossing.z = 0.0;
                scratch.push(self.straighten(crossing));
            }
            if corner.z > 0.0 {
                scratch.push(self.straighten(corner));
            }
        };
        for corner in corners {
            match first {
                None => first = Some(corner),
                Some(_) => push(before, corner),
            }
            before = corner;
        }
        if let Some(first) = first {
            push(before, first);
        }
        if scratch.len() < 3 {
            return Vec3::splat(0.0);
        }
        polygon::vector_irradiance(scratch) * (1.0 / std::f64::consts::PI)
    }
}

/// What a polygon of unit radiance sends to an eye by the mirrors: the part of F0 and that of F90 − F0.
#[inline(always)]
pub fn mirrored(
    table: &Table,
    corners: impl Iterator<Item = Vec3<f64>>,
    frame: &Frame<f64>,
    wo: Vec3<f64>,
    alpha: f64,
    scratch: &mut Vec<Vec3<f64>>,
) -> [f64; 2] {
    let (lobe, turn) = (table.lobe(alpha, wo.z), Turn::of(wo));
    let turned = corners.map(
        #[inline(always)]
        |c| turn.by(frame.local(c)),
    );
    // What a lobe has below the horizon GGX has above it.
    let share = lobe.share(turned, scratch) / lobe.above();
    [share * lobe.magnitude, share * lobe.grazing]
}

/// [`mirrored`] for a rectangle that shows a picture, with the mean radiance of what the lobe sees of it.
#[inline(always)]
pub fn mirrored_picture<T: Real>(
    table: &Table,
    light: &Textured<T>,
    point: Vec3<f64>,
    corners: impl Iterator<Item = Vec3<f64>>,
    frame: &Frame<f64>,
    wo: Vec3<f64>,
    alpha: f64,
    scratch: &mut Vec<Vec3<f64>>,
) -> ([f64; 2], Vec3<f64>) {
    let (lobe, turn) = (table.lobe(alpha, wo.z), Turn::of(wo));
    let turned = corners.map(
        #[inline(always)]
        |c| turn.by(frame.local(c)),
    );
    let seen = lobe.seen(turned, scratch);
    let share = seen.z / lobe.above();
    let [corner, across, down] = light.edges(frame, point);
    let straight =
        [lobe.straighten(turn.by(corner)), lobe.straighten(turn.by(across)), lobe.straighten(turn.by(down))];
    let color = light.picture.seen(straight[0], straight[1], straight[2], seen);
    ([share * lobe.magnitude, share * lobe.grazing], color)
}

/// The mean radiance that a cosine lobe about the frame's z sees of a rectangle that shows a picture.
#[inline(always)]
pub fn diffuse_picture<T: Real>(
    light: &Textured<T>,
    point: Vec3<f64>,
    corners: impl Iterator<Item = Vec3<f64>>,
    frame: &Frame<f64>,
    scratch: &mut Vec<Vec3<f64>>,
) -> Vec3<f64> {
    scratch.clear();
    for corner in corners {
        scratch.push(frame.local(corner));
    }
    let [corner, across, down] = light.edges(frame, point);
    light.picture.seen(corner, across, down, polygon::vector_irradiance(scratch))
}

/// About the normal so that the eye lies above x; straight above any turn serves.
#[derive(Clone, Copy)]
struct Turn {
    cos: f64,
    sin: f64,
}

impl Turn {
    #[inline(always)]
    fn of(wo: Vec3<f64>) -> Self {
        let across = (wo.x * wo.x + wo.y * wo.y).sqrt();
        if across > 0.0 {
            Turn { cos: wo.x / across, sin: wo.y / across }
        } else {
            Turn { cos: 1.0, sin: 0.0 }
        }
    }
    #[inline(always)]
    fn by(&self, v: Vec3<f64>) -> Vec3<f64> {
        Vec3::new(self.cos * v.x + self.sin * v.y, self.cos * v.y - self.sin * v.x, v.z)
    }
}

/// How many corners stand for a round light.
const ROUND: usize = 24;

/// The corners of an area light as seen from a point, counter-clockwise from its shining side, into `corners`; false where
/// it does not shine, or is no polygon. Disks, and spheres as the disks of their rims, become polygons of equal area.
#[inline(always)]
pub fn outline<T: Real>(light: &Light<T>, point: Vec3<f64>, corners: &mut Vec<Vec3<f64>>) -> bool {
    corners.clear();
    let (to, normal, two_sided) = match light {
        Light::Rect(l) | Light::Textured(Textured { rect: l, .. }) => {
            for corner in l.corners() {
                corners.push(doubled(corner) - point);
            }
            (doubled(l.center) - point, doubled(l.normal), l.two_sided)
        }
        Light::Polygon(l) => {
            for &corner in l.corners.iter() {
                corners.push(corner - point);
            }
            (doubled(l.plane.point) - point, doubled(l.plane.normal), l.plane.two_sided)
        }
        Light::Disk(l) => {
            let (x, y, n) = (doubled(l.frame.x), doubled(l.frame.y), doubled(l.frame.z));
            let to = doubled(l.center) - point;
            round(to, x, y, l.radius.to_f64(), corners);
            (to, n, l.two_sided)
        }
        Light::Sphere(l) => {
            let to = doubled(l.center) - point;
            let (axis, radius) = (to.normalize(), l.radius.to_f64());
            let sin = radius / to.dot(axis);
            if !(sin < 1.0) {
                return false;
            }
            let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
            let frame = Frame::about(-axis);
            round(axis * cos, frame.x, frame.y, sin, corners);
            (to, -axis, false)
        }
        _ => return false,
    };
    let side = -to.dot(normal);
    if side < 0.0 && two_sided {
        corners.reverse();
        return true;
    }
    side > 0.0
}

fn round(center: Vec3<f64>, x: Vec3<f64>, y: Vec3<f64>, radius: f64, corners: &mut Vec<Vec3<f64>>) {
    use std::f64::consts::{PI, TAU};
    let step = TAU / ROUND as f64;
    let radius = radius * (2.0 * PI / (ROUND as f64 * crate::math::sin(step))).sqrt();
    corners.extend((0..ROUND).map(|k| {
        let (sin, cos) = crate::math::sin_cos(step * k as f64);
        center + x * (cos * radius) + y * (sin * radius)
    }));
}

/// The mirrors' light from one area light at points with unit normals and directions to the eye: the parts of F0 and of
/// F90 − F0, for unit radiance, and the radiance seen. NaN where alpha is not in (0, 1]; zero seen from below.
pub fn ltc_many<T: Real>(
    watch: &mut dyn Watch,
    table: &Table,
    light: &Light<T>,
    points: &[[T; 3]],
    normals: &[[T; 3]],
    wo: &[[T; 3]],
    alpha: &[T],
    out: &mut [[T; 5]],
) -> Result<(), Interrupted> {
    let even = doubled(light.radiance());
    parallel::for_each(
        watch,
        (points, normals, wo, alpha, out),
        1 << 11,
        |_, (points, normals, wo, alpha, out)| {
            let (mut corners, mut scratch) = (Vec::new(), Vec::new());
            dispatch!(_s => {
                for i in 0..out.len() {
                    let [point, normal, eye] = [points[i], normals[i], wo[i]].map(polygon::double);
                    let alpha = alpha[i].to_f64();
                    let nan = (point + normal + eye).dot(Vec3::splat(0.0)) + alpha * 0.0;
                    let frame = Frame::about(normal);
                    let eye = frame.local(eye);
                    if nan.is_nan() || !(alpha > 0.0 && alpha <= 1.0) {
                        out[i] = [T::NAN; 5];
                        continue;
                    }
                    let (mut parts, mut color) = ([0.0; 2], even);
                    if eye.z > 0.0 && outline(light, point, &mut corners) {
                        let corners = corners.iter().copied();
                        (parts, color) = if let Light::Textured(light) = light {
                            mirrored_picture(table, light, point, corners, &frame, eye, alpha, &mut scratch)
                        } else {
                            (mirrored(table, corners, &frame, eye, alpha, &mut scratch), even)
                        };
                    }
                    let [base, edge] = [Lanes::max(parts[0], 0.0), Lanes::max(parts[1], 0.0)];
                    out[i] = [T::of(base), T::of(edge), T::of(color.x), T::of(color.y), T::of(color.z)];
                }
            })
        },
    )
}
