//! A rectangle that radiates evenly in every direction of its front, or of both sides.
//!
//! Points are drawn evenly over the area; seen from a surface, their density per solid angle is d² / (A cos θ), with θ
//! at the light. It grows without bound where the light is seen edge-on, and with it falls what a sample carries.
//!
//! P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Rect<T> {
    pub center: Vec3<T>,
    /// Full edges, perpendicular to each other.
    pub edge_u: Vec3<T>,
    pub edge_v: Vec3<T>,
    /// Unit, along edge_u × edge_v: the side that radiates.
    pub normal: Vec3<T>,
    pub area: T,
    /// W/(m² sr)
    pub radiance: Vec3<T>,
    pub two_sided: bool,
}

/// A point on a light as seen from elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Sighting<T> {
    /// Unit, towards the light.
    pub wi: Vec3<T>,
    pub distance: T,
    /// Per solid angle, of drawing points evenly over the area.
    pub pdf: T,
}

impl<T: Real> Rect<T> {
    pub fn new(
        center: Vec3<T>,
        edge_u: Vec3<T>,
        edge_v: Vec3<T>,
        radiance: Vec3<T>,
        two_sided: bool,
    ) -> Self {
        let normal = edge_u.normalize().cross(edge_v.normalize()).normalize();
        let area = edge_u.dot(edge_u.normalize()) * edge_v.dot(edge_v.normalize());
        Rect { center, edge_u, edge_v, normal, area, radiance, two_sided }
    }
    /// Corners, counter-clockwise as seen from the front.
    #[inline(always)]
    pub fn corners(&self) -> [Vec3<T>; 4] {
        let half = T::of(0.5);
        let (u, v) = (self.edge_u * half, self.edge_v * half);
        [self.center - u - v, self.center + u - v, self.center + u + v, self.center - u + v]
    }
    /// The point of the unit square's `u`.
    #[inline(always)]
    pub fn point(&self, u: [T; 2]) -> Vec3<T> {
        let half = T::of(0.5);
        self.center + self.edge_u * (u[0] - half) + self.edge_v * (u[1] - half)
    }
    /// Whether light goes from the rectangle towards a surface, given the cosine at the light of the way back.
    #[inline(always)]
    fn shines(&self, cos_light: T) -> bool {
        cos_light > T::zero() || (self.two_sided && cos_light < T::zero())
    }
    /// The point at `u` seen from `from`, if it shines there.
    #[inline(always)]
    pub fn sample(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        let to = self.point(u) - from;
        let wi = to.normalize();
        let distance = to.dot(wi);
        let cos_light = -wi.dot(self.normal);
        let pdf = distance * (distance / (self.area * cos_light.abs()));
        // NaN, from a point on the light itself, is no sighting.
        (self.shines(cos_light) && pdf > T::zero()).then_some(Sighting { wi, distance, pdf })
    }
    /// Where a ray with unit direction meets the shining side, beyond `from` itself.
    #[inline(always)]
    pub fn meet(&self, from: Vec3<T>, wi: Vec3<T>) -> Option<Sighting<T>> {
        let cos_light = -wi.dot(self.normal);
        if !self.shines(cos_light) {
            return None;
        }
        let distance = (from - self.center).dot(self.normal) / cos_light;
        let at = from + wi * distance - self.center;
        let half = T::of(0.5);
        let inside = at.dot(self.edge_u).abs() <= half * self.edge_u.length_squared()
            && at.dot(self.edge_v).abs() <= half * self.edge_v.length_squared();
        let pdf = distance * (distance / (self.area * cos_light.abs()));
        (inside && distance > T::zero() && pdf > T::zero()).then_some(Sighting { wi, distance, pdf })
    }
}

/// [`Rect::sample`] over arrays of equal length: directions, distances and densities; zeros where nothing shines.
pub fn rect_sample_many<T: Real>(
    watch: &mut dyn Watch,
    light: Rect<T>,
    points: &[[T; 3]],
    u: &[[T; 2]],
    wi: &mut [[T; 3]],
    distance: &mut [T],
    pdf: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (points, u, wi, distance, pdf), 1 << 13, |_, (points, u, wi, distance, pdf)| {
        dispatch!(_s => {
            for i in 0..points.len() {
                let from = Vec3::from(points[i]);
                let to = light.point(u[i]) - from;
                // The direction is worth having where nothing shines as well.
                (wi[i], distance[i]) = (to.normalize().to_array(), to.dot(to.normalize()));
                pdf[i] = light.sample(from, u[i]).map_or(distance[i] * T::zero(), |s| s.pdf);
            }
        })
    })
}

/// The density of [`Rect::sample`] per solid angle, of unit directions: zero where they miss the shining side.
pub fn rect_pdf_many<T: Real>(
    watch: &mut dyn Watch,
    light: Rect<T>,
    points: &[[T; 3]],
    wi: &[[T; 3]],
    pdf: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (points, wi, pdf), 1 << 13, |_, (points, wi, pdf)| {
        dispatch!(_s => {
            for i in 0..points.len() {
                let (from, w) = (Vec3::from(points[i]), Vec3::from(wi[i]));
                let nan = (from + w).dot(Vec3::splat(T::zero()));
                pdf[i] = light.meet(from, w).map_or(nan, |s| s.pdf);
            }
        })
    })
}
