//! The unit square onto the directions within an angle of z, areas in constant proportion.
//!
//! All in terms of h = 1 − cos θ = 2 sin²(θ/2), which keeps its digits where the cosine has none left: cones of 10⁻¹⁵
//! radians are as even as the hemisphere. An angle of π gives the sphere.
//!
//! P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996.

use super::disk::{self, Method};
use crate::math;
use crate::real::Real;
use crate::vec::Vec3;

/// Directions within an angle of z.
#[derive(Clone, Copy, Debug)]
pub struct Cone<T> {
    /// 1 − cos of the angle, and 1 + cos of it.
    depth: T,
    rest: T,
    cos: T,
}

impl<T: Real> Cone<T> {
    /// Of an angle in (0, π]; NaN for others.
    #[inline(always)]
    pub fn new(angle: T) -> Self {
        let two = T::of(2.0);
        let valid = angle > T::zero() && angle <= T::PI;
        let (sin, cos) = math::sin_cos(if valid { angle * T::of(0.5) } else { T::NAN });
        let (depth, rest) = (two * sin * sin, two * cos * cos);
        // cos θ from the nearer of both ends.
        Cone { depth, rest, cos: if depth < T::one() { T::one() - depth } else { rest - T::one() } }
    }
    /// About a ball of this radius seen from a distance, in which it subtends less than the hemisphere.
    #[inline(always)]
    pub fn about_ball(radius: T, distance: T) -> Self {
        let sine = radius / distance;
        let cos = ((T::one() - sine) * (T::one() + sine)).sqrt();
        Cone { depth: sine * sine / (T::one() + cos), rest: T::one() + cos, cos }
    }
    #[inline(always)]
    pub fn solid_angle(&self) -> T {
        T::of(2.0) * T::PI * self.depth
    }
    #[inline(always)]
    pub fn sample(&self, u: [T; 2], method: Method) -> Vec3<T> {
        let ([x, y], rim) = disk::point_and_depth(u, method);
        // 1 + z over a point of the disk at distance r, with rim = 1 - r²: a sum of positive terms.
        let above = self.rest + self.depth * rim;
        let scale = (self.depth * above).sqrt();
        let z = self.cos + self.depth * rim;
        Vec3::new(x * scale, y * scale, z)
    }
    /// The inverse of [`Cone::sample`] for unit directions in the cone, in [0, 1).
    #[inline(always)]
    pub fn invert(&self, d: Vec3<T>, method: Method) -> [T; 2] {
        let one = T::one();
        let squared = d.x * d.x + d.y * d.y;
        let above = if d.z < T::zero() { squared / (one - d.z) } else { one + d.z };
        // The lower pole itself is the whole rim of the disk.
        let rim = !(above > T::zero());
        let scale = (self.depth * above).sqrt();
        let p = if rim { [one, T::zero() * squared] } else { [d.x / scale, d.y / scale] };
        disk::disk_to_square(p, method)
    }
    /// The density per solid angle of a unit direction; the rim counts as inside, a few rounding units wide.
    #[inline(always)]
    pub fn pdf(&self, d: Vec3<T>) -> T {
        let one = T::one();
        let squared = d.x * d.x + d.y * d.y;
        let depth = if d.z > T::zero() { squared / (one + d.z) } else { one - d.z };
        let outside = depth > self.depth * (one + T::of(16.0) * T::EPSILON);
        if outside { T::zero() } else { one / self.solid_angle() + depth * T::zero() }
    }
}
