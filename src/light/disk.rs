//! A disk that radiates evenly in every direction of its front, or of both sides. Points are drawn evenly over the area,
//! as on [`super::rect`].

use super::Sighting;
use super::flat::Plane;
use crate::real::Real;
use crate::sampling::disk::{Method, square_to_disk};
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Disk<T> {
    pub center: Vec3<T>,
    /// About the normal, the side that radiates.
    pub frame: Frame<T>,
    pub radius: T,
    /// W/(m² sr)
    pub radiance: Vec3<T>,
    pub two_sided: bool,
}

impl<T: Real> Disk<T> {
    #[inline(always)]
    pub fn area(&self) -> T {
        T::PI * self.radius * self.radius
    }
    #[inline(always)]
    fn plane(&self) -> Plane<T> {
        Plane { point: self.center, normal: self.frame.z, area: self.area(), two_sided: self.two_sided }
    }
    #[inline(always)]
    pub fn sample(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        let [x, y] = square_to_disk(u, Method::Concentric).map(|x| x * self.radius);
        self.plane().sight(from, self.center + self.frame.x * x + self.frame.y * y)
    }
    #[inline(always)]
    pub fn meet(&self, from: Vec3<T>, wi: Vec3<T>) -> Option<Sighting<T>> {
        self.plane().meet(from, wi, |at| at.length_squared() <= self.radius * self.radius)
    }
}
