//! A rectangle that shows a picture: a screen, a window, a lamp behind glass.
//!
//! Radiance is constant within each texel and the same in every direction. Points are drawn in proportion to luminance
//! and area, so that a sample near a small light carries the same wherever it falls; irradiance is the sum over texels of
//! Lambert's formula; transformed cosines see a prefiltered picture ([`super::picture`]).
//!
//! E. Heitz, J. Dupuy, S. Hill, D. Neubelt, *Real-time polygonal-light shading with linearly transformed cosines*, 2016.

use super::Sighting;
use super::picture::Picture;
use super::polygon;
use super::rect::Rect;
use crate::real::{Lanes, Real};
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;
use std::sync::Arc;

#[derive(Clone)]
pub struct Textured<T> {
    /// Its radiance is the picture's mean.
    pub rect: Rect<T>,
    pub picture: Arc<Picture<T>>,
}

impl<T> std::fmt::Debug for Textured<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Textured")
    }
}

impl<T: Real> Textured<T> {
    pub fn new(mut rect: Rect<T>, picture: Arc<Picture<T>>) -> Self {
        rect.radiance = picture.mean();
        Textured { rect, picture }
    }

    /// Where on the picture a point of the rectangle is: in [0, 1]², from the left and from the top.
    #[inline(always)]
    fn place(&self, at: Vec3<T>) -> [T; 2] {
        let (half, r) = (T::of(0.5), &self.rect);
        let to = at - r.center;
        let inside = |x: T| Lanes::min(Lanes::max(x, T::zero()), T::one());
        [
            inside(half + to.dot(r.edge_u) / r.edge_u.length_squared()),
            inside(half - to.dot(r.edge_v) / r.edge_v.length_squared()),
        ]
    }

    /// What a ray sees that meets it at a distance.
    #[inline(always)]
    pub fn radiance(&self, from: Vec3<T>, wi: Vec3<T>, distance: T) -> Vec3<T> {
        self.picture.radiance(self.place(from + wi * distance))
    }

    /// A sighting's density, by the picture. Told from where the ray arrives, so that radiance and density are of one
    /// texel.
    #[inline(always)]
    fn weighed(&self, from: Vec3<T>, s: Sighting<T>) -> Sighting<T> {
        Sighting { pdf: s.pdf * self.picture.pdf(self.place(from + s.wi * s.distance)), ..s }
    }

    #[inline(always)]
    pub fn sample(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        let [x, y] = self.picture.draw(u);
        let s = self.weighed(from, self.rect.sample(from, [x, T::one() - y])?);
        if s.pdf > T::zero() { Some(s) } else { None }
    }

    /// Where a ray with unit direction meets the shining side; of density zero where the picture is black.
    #[inline(always)]
    pub fn meet(&self, from: Vec3<T>, wi: Vec3<T>) -> Option<Sighting<T>> {
        Some(self.weighed(from, self.rect.meet(from, wi)?))
    }

    /// The left upper corner, and the edges from there, as a frame at a point sees them.
    #[inline(always)]
    pub fn edges(&self, frame: &Frame<f64>, point: Vec3<f64>) -> [Vec3<f64>; 3] {
        let r = &self.rect;
        let double = |v: Vec3<T>| polygon::doubled(v);
        let (u, v) = (double(r.edge_u), double(r.edge_v));
        let corner = double(r.center) - point - u * 0.5 + v * 0.5;
        [frame.local(corner), frame.local(u), frame.local(-v)]
    }

    /// Irradiance at a point with a unit normal: Lambert's formula over every run of equal texels.
    pub fn irradiance(&self, point: Vec3<f64>, normal: Vec3<f64>) -> Vec3<f64> {
        let frame = Frame::about(normal);
        let nan = (point + normal).dot(Vec3::splat(0.0));
        let side = (point - polygon::doubled(self.rect.center)).dot(polygon::doubled(self.rect.normal));
        let front = side > 0.0;
        if nan.is_nan() || !(front || (self.rect.two_sided && side < 0.0)) {
            return Vec3::splat(nan);
        }
        let (width, height) = self.picture.size();
        let [corner, across, down] = self.edges(&frame, point);
        let (across, down) = (across * (1.0 / width as f64), down * (1.0 / height as f64));
        let mut sum = Vec3::splat(0.0);
        for i in 0..height {
            let (above, below) = (corner + down * i as f64, corner + down * (i + 1) as f64);
            let mut j = 0;
            while j < width {
                let (start, color) = (j, self.picture.texel(i, j));
                while j < width && self.picture.texel(i, j) == color {
                    j += 1;
                }
                if color == Vec3::splat(T::zero()) {
                    continue;
                }
                let (left, right) = (across * start as f64, across * j as f64);
                let cell = [below + left, below + right, above + right, above + left];
                let share = polygon::irradiance(&cell).abs();
                sum = sum + polygon::doubled(color) * share;
            }
        }
        sum
    }
}
