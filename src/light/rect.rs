//! A rectangle that radiates evenly in every direction of its front, or of both sides.
//!
//! Points are drawn evenly over the area; seen from a surface, their density per solid angle is d² / (A cos θ), with θ
//! at the light. It grows without bound where the light is seen edge-on, and with it falls what a sample carries.
//!
//! P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996.

pub use super::Sighting;
use super::flat::Plane;
use crate::real::Real;
use crate::sampling::spherical_rectangle::SphericalRectangle;
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
    #[inline(always)]
    fn plane(&self) -> Plane<T> {
        Plane { point: self.center, normal: self.normal, area: self.area, two_sided: self.two_sided }
    }
    /// The point at `u` seen from `from`, if it shines there.
    #[inline(always)]
    pub fn sample(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        self.plane().sight(from, self.point(u))
    }
    /// A direction towards it, even over its solid angle.
    #[inline(always)]
    pub fn sample_evenly(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        if !self.plane().shines_to(from) {
            return None;
        }
        let seen = SphericalRectangle::new(self.center - from, self.edge_u, self.edge_v);
        self.plane().along(from, seen.sample(u), T::one() / seen.solid_angle())
    }
    #[inline(always)]
    pub fn solid_angle(&self, from: Vec3<T>) -> T {
        SphericalRectangle::new(self.center - from, self.edge_u, self.edge_v).solid_angle()
    }
    /// Where a ray with unit direction meets the shining side, beyond `from` itself.
    #[inline(always)]
    pub fn meet(&self, from: Vec3<T>, wi: Vec3<T>) -> Option<Sighting<T>> {
        let half = T::of(0.5);
        self.plane().meet(from, wi, |at| {
            at.dot(self.edge_u).abs() <= half * self.edge_u.length_squared()
                && at.dot(self.edge_v).abs() <= half * self.edge_v.length_squared()
        })
    }
}
