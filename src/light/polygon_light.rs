//! A planar polygon, convex or not, that radiates evenly in every direction of its front, or of both sides. Points are
//! drawn evenly over the triangles into which it is cut.
//!
//! G. H. Meisters, *Polygons have ears*, 1975.

use super::Sighting;
use super::flat::Plane;
use crate::real::Real;
use crate::sampling::spherical_triangle::SphericalTriangle;
use crate::sampling::triangle::{Method, square_to_triangle};
use crate::vec::Vec3;
use std::sync::Arc;

#[derive(Clone, Debug)]
pub struct PolygonLight<T> {
    pub plane: Plane<T>,
    /// Of the front, counter-clockwise; in double, for closed forms.
    pub corners: Arc<[Vec3<f64>]>,
    /// Three corners each, and the area up to and with each.
    triangles: Arc<[([Vec3<T>; 3], T)]>,
    /// W/(m² sr)
    pub radiance: Vec3<T>,
}

/// Twice the area of a polygon, along its normal.
fn twice_area(corners: &[Vec3<f64>]) -> Vec3<f64> {
    let mut sum = Vec3::splat(0.0);
    for pair in corners[1..].windows(2) {
        sum = sum + (pair[0] - corners[0]).cross(pair[1] - corners[0]);
    }
    sum
}

/// Triangles of a polygon without self-intersection; None if no ear is left to cut.
pub fn triangulate(corners: &[Vec3<f64>]) -> Option<Vec<[usize; 3]>> {
    let normal = twice_area(corners).normalize();
    let mut left: Vec<usize> = (0..corners.len()).collect();
    let mut triangles = Vec::with_capacity(corners.len());
    while left.len() > 3 {
        let n = left.len();
        // Of all ears the one farthest from a sliver.
        let (mut best, mut widest) = (None, 0.0);
        for i in 0..n {
            let [a, b, c] = [left[(i + n - 1) % n], left[i], left[(i + 1) % n]].map(|k| corners[k]);
            let area = (b - a).cross(c - b).dot(normal);
            let shape =
                area / ((b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared());
            // A straight corner is an ear as well, if there is no better one.
            if shape >= 0.0 && (best.is_none() || shape > widest) {
                let holds = |p: Vec3<f64>| {
                    [(a, b), (b, c), (c, a)]
                        .iter()
                        .all(|&(p0, p1)| (p1 - p0).cross(p - p0).dot(normal) >= 0.0)
                };
                let corner = |p: Vec3<f64>| p == a || p == b || p == c;
                if !left.iter().any(|&k| !corner(corners[k]) && area > 0.0 && holds(corners[k])) {
                    (best, widest) = (Some(i), shape);
                }
            }
        }
        let i = best?;
        triangles.push([left[(i + n - 1) % n], left[i], left[(i + 1) % n]]);
        left.remove(i);
    }
    triangles.push([left[0], left[1], left[2]]);
    Some(triangles)
}

impl<T: Real> PolygonLight<T> {
    /// None for a polygon that crosses itself, or touches itself so that its triangles overlap.
    pub fn new(corners: &[Vec3<f64>], radiance: Vec3<T>, two_sided: bool) -> Option<Self> {
        let rounded = |v: Vec3<f64>| v.map(T::of);
        let mut area = 0.0;
        let triangles = triangulate(corners)?
            .into_iter()
            .map(|t| {
                let t = t.map(|k| corners[k]);
                area += twice_area(&t).length() / 2.0;
                (t.map(rounded), T::of(area))
            })
            .collect();
        let whole = twice_area(corners);
        if area > 0.5 * whole.length() * (1.0 + 1e-9) {
            return None;
        }
        let normal = rounded(whole.normalize());
        let plane = Plane { point: rounded(corners[0]), normal, area: T::of(area), two_sided };
        Some(PolygonLight { plane, corners: corners.into(), triangles, radiance })
    }
    #[inline(always)]
    pub fn sample(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        let at = u[0] * self.plane.area;
        let k = self.triangles.partition_point(|t| t.1 <= at).min(self.triangles.len() - 1);
        let ([a, b, c], end) = self.triangles[k];
        let start = if k == 0 { T::zero() } else { self.triangles[k - 1].1 };
        let [v, w] = square_to_triangle([((at - start) / (end - start)).clamp01(), u[1]], Method::Fold);
        self.plane.sight(from, a * (T::one() - v - w) + b * v + c * w)
    }
    /// Of its triangles, which do not overlap.
    #[inline(always)]
    pub fn solid_angle(&self, from: Vec3<T>) -> T {
        self.seen(from).fold(T::zero(), |sum, t| sum + t.solid_angle())
    }
    /// The triangles that have a solid angle: not those seen edge-on.
    #[inline(always)]
    fn seen(&self, from: Vec3<T>) -> impl Iterator<Item = SphericalTriangle<T>> {
        let triangles = self.triangles.iter();
        let seen = triangles.map(move |&([a, b, c], _)| SphericalTriangle::new(a - from, b - from, c - from));
        seen.filter(|t| t.solid_angle() > T::zero())
    }
    /// A direction towards it, even over its solid angle.
    #[inline(always)]
    pub fn sample_evenly(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        if !self.plane.shines_to(from) {
            return None;
        }
        let whole = self.solid_angle(from);
        let (mut left, mut chosen) = (u[0] * whole, None);
        for triangle in self.seen(from) {
            chosen = Some((triangle, (left / triangle.solid_angle()).clamp01()));
            if left < triangle.solid_angle() {
                break;
            }
            left -= triangle.solid_angle();
        }
        let (triangle, v) = chosen?;
        self.plane.along(from, triangle.sample([v, u[1]]), T::one() / whole)
    }
    #[inline(always)]
    pub fn meet(&self, from: Vec3<T>, wi: Vec3<T>) -> Option<Sighting<T>> {
        self.plane.meet(from, wi, |at| {
            let at = at + self.plane.point;
            self.triangles.iter().any(|&([a, b, c], _)| {
                let side = |p: Vec3<T>, q: Vec3<T>| (q - p).cross(at - p).dot(self.plane.normal) >= T::zero();
                side(a, b) && side(b, c) && side(c, a)
            })
        })
    }
}
