//! Linearly transformed cosines: the mirrors' light from a polygon without a sample.
//!
//! A lobe of GGX times the cosine is approximated by the sum of two cosine lobes that matrices have sheared and stretched,
//! a narrow one and a wide one: taken back by the inverses, the polygon's integral over each is Lambert's formula over the
//! polygon seen from there. One lobe alone, as published, leaves two to four times the error at middle roughness. A table
//! over roughness and angle holds the inverses, the lobes' magnitudes, and what of them Schlick's grazing term weighs. The
//! formula gives the share of a lobe that the polygon fills: it is the magnitude that makes light of it. The polygon is
//! clipped at the surface's horizon first, then at that of the cosine; magnitudes are of the parts of the lobes above
//! the surface, so that a light all around gives the whole. A diffuse lobe needs no fit: [`super::polygon`] has it
//! exactly.
//!
//! E. Heitz, J. Dupuy, S. Hill, D. Neubelt, *Real-time polygonal-light shading with linearly transformed cosines*, 2016;
//! S. Hill, E. Heitz, *LTC Fresnel approximation*, 2016.

#[cfg_attr(not(feature = "python"), allow(dead_code))] // asked for by Python alone
pub(crate) mod fit;
mod seen;
mod table;

pub use table::{Table, shipped};

use super::Light;
use super::polygon::{self, doubled};
use super::textured::Textured;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;
use seen::seen;

/// Corners on the way.
pub type Scratch = [Vec<Vec3<f64>>; 3];

/// What a polygon of unit radiance, given from the point, sends to an eye by the mirrors: the part of F0 and that of
/// F90 − F0.
#[inline(always)]
pub fn mirrored<S: Simd>(
    s: S,
    table: &Table,
    corners: &[Vec3<f64>],
    frame: &Frame<f64>,
    wo: Vec3<f64>,
    alpha: f64,
    scratch: &mut Scratch,
) -> [f64; 2] {
    let lobes = table.lobes(alpha, wo.z);
    let [a, b] = seen(s, &lobes, corners, &towards(frame, wo), scratch);
    [
        Lanes::max(a.z, 0.0) * lobes[0].magnitude + Lanes::max(b.z, 0.0) * lobes[1].magnitude,
        Lanes::max(a.z, 0.0) * lobes[0].grazing + Lanes::max(b.z, 0.0) * lobes[1].grazing,
    ]
}

/// [`mirrored`] for a rectangle that shows a picture, with the mean radiance of what the lobes see of it.
#[inline(always)]
pub fn mirrored_picture<T: Real, S: Simd>(
    s: S,
    table: &Table,
    light: &Textured<T>,
    point: Vec3<f64>,
    corners: &[Vec3<f64>],
    frame: &Frame<f64>,
    wo: Vec3<f64>,
    alpha: f64,
    scratch: &mut Scratch,
) -> ([f64; 2], Vec3<f64>) {
    let lobes = table.lobes(alpha, wo.z);
    let frame = towards(frame, wo);
    let seen = seen(s, &lobes, corners, &frame, scratch);
    let [corner, across, down] = light.edges(&frame, point);
    let (mut parts, mut color, mut total) = ([0.0; 2], Vec3::splat(0.0), 0.0);
    for k in 0..2 {
        let (lobe, share) = (&lobes[k], Lanes::max(seen[k].z, 0.0));
        if !(share > 0.0) {
            continue;
        }
        parts = [parts[0] + share * lobe.magnitude, parts[1] + share * lobe.grazing];
        let straight = [lobe.straighten(corner), lobe.straighten(across), lobe.straighten(down)];
        let weight = share * lobe.magnitude;
        color = color + light.picture.seen(straight[0], straight[1], straight[2], seen[k]) * weight;
        total += weight;
    }
    (parts, if total > 0.0 { color * (1.0 / total) } else { light.picture.mean().map(T::to_f64) })
}

/// The mean radiance that a cosine lobe about the frame's z sees of a rectangle that shows a picture.
#[inline(never)]
pub fn diffuse_picture<T: Real>(
    light: &Textured<T>,
    point: Vec3<f64>,
    corners: &[Vec3<f64>],
    frame: &Frame<f64>,
    scratch: &mut Scratch,
) -> Vec3<f64> {
    let [local, ..] = scratch;
    local.clear();
    for &corner in corners {
        local.push(frame.local(corner));
    }
    let [corner, across, down] = light.edges(frame, point);
    light.picture.seen(corner, across, down, polygon::vector_irradiance(local))
}

/// The frame turned about its normal so that the eye lies above x; straight above any turn serves.
#[inline(always)]
fn towards(frame: &Frame<f64>, wo: Vec3<f64>) -> Frame<f64> {
    let across = (wo.x * wo.x + wo.y * wo.y).sqrt();
    let per = 1.0 / across;
    let (cos, sin) = if across > 0.0 { (wo.x * per, wo.y * per) } else { (1.0, 0.0) };
    Frame { x: frame.x * cos + frame.y * sin, y: frame.y * cos - frame.x * sin, z: frame.z }
}

/// How many corners stand for a round light.
const ROUND: usize = 24;

/// The corners of an area light as seen from a point, counter-clockwise from its shining side, into `corners`; false where
/// it does not shine, or is no polygon. Disks, and spheres as the disks of their rims, become polygons of equal area.
#[inline(never)]
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
    if polygon::is_edge_on(corners) {
        return false;
    }
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
            let (mut corners, mut scratch) = (Vec::new(), Scratch::default());
            dispatch!(s => {
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
                        (parts, color) = if let Light::Textured(light) = light {
                            mirrored_picture(s, table, light, point, &corners, &frame, eye, alpha, &mut scratch)
                        } else {
                            (mirrored(s, table, &corners, &frame, eye, alpha, &mut scratch), even)
                        };
                    }
                    let [base, edge] = parts;
                    out[i] = [T::of(base), T::of(edge), T::of(color.x), T::of(color.y), T::of(color.z)];
                }
            })
        },
    )
}
