//! A sphere that radiates evenly outwards.
//!
//! Directions are drawn evenly over the cone in which it is seen, so that every sample carries the same: nothing is
//! drawn on the far side, and nothing grows without bound. From within, nothing of it is seen.
//!
//! P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996.

use super::Sighting;
use crate::real::{Lanes, Real};
use crate::sampling::disk::{Method, square_to_disk};
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Sphere<T> {
    pub center: Vec3<T>,
    pub radius: T,
    /// W/(m² sr)
    pub radiance: Vec3<T>,
}

/// A sphere as seen from a point beyond it.
struct View<T> {
    /// Unit, to the centre.
    axis: Vec3<T>,
    distance: T,
    /// 1 − cos of the cone's half angle.
    depth: T,
}

impl<T: Real> Sphere<T> {
    #[inline(always)]
    fn seen_from(&self, from: Vec3<T>) -> Option<View<T>> {
        let to = self.center - from;
        let axis = to.normalize();
        let distance = to.dot(axis);
        let sin = self.radius / distance;
        if !(sin < T::one()) {
            return None;
        }
        // 1 − cos = sin² / (1 + cos): no cancellation for spheres far away.
        let cos = ((T::one() - sin) * (T::one() + sin)).sqrt();
        Some(View { axis, distance, depth: sin * sin / (T::one() + cos) })
    }
    /// Where the ray at that cosine and squared sine from the axis comes in.
    #[inline(always)]
    fn entry(&self, view: &View<T>, cos: T, sin_squared: T) -> T {
        let off = view.distance * (view.distance * sin_squared);
        let chord = Lanes::max(self.radius * self.radius - off, T::zero()).sqrt();
        let beyond = (view.distance - self.radius) * (view.distance + self.radius);
        beyond / (view.distance * cos + chord)
    }
    #[inline(always)]
    fn pdf(view: &View<T>) -> T {
        T::one() / (T::of(2.0) * T::PI * view.depth)
    }
    #[inline(always)]
    pub fn sample(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        let view = self.seen_from(from)?;
        let (one, two) = (T::one(), T::of(2.0));
        let [x, y] = square_to_disk(u, Method::Concentric);
        let s = Lanes::min(x * x + y * y, one);
        // 1 − cos is even in the cone; the sine follows from it.
        let off = s * view.depth;
        let scale = (view.depth * (two - off)).sqrt();
        let wi = Frame::about(view.axis).world(Vec3::new(x * scale, y * scale, one - off));
        let distance = self.entry(&view, one - off, off * (two - off));
        Some(Sighting { wi, distance, pdf: Self::pdf(&view) })
    }
    #[inline(always)]
    pub fn meet(&self, from: Vec3<T>, wi: Vec3<T>) -> Option<Sighting<T>> {
        let view = self.seen_from(from)?;
        // 1 − cos from the chord between unit vectors.
        let off = (wi - view.axis).length_squared() * T::of(0.5);
        let inside = off <= view.depth;
        inside.then(|| Sighting {
            wi,
            distance: self.entry(&view, T::one() - off, off * (T::of(2.0) - off)),
            pdf: Self::pdf(&view),
        })
    }
}
