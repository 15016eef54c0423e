//! What flat lights share: points drawn evenly over an area, as seen from elsewhere.

use super::Sighting;
use crate::real::Real;
use crate::vec::Vec3;

/// The plane of a light, and what of it shines.
#[derive(Clone, Copy, Debug)]
pub struct Plane<T> {
    /// That places are told from.
    pub point: Vec3<T>,
    /// Unit: the side that radiates.
    pub normal: Vec3<T>,
    pub area: T,
    pub two_sided: bool,
}

impl<T: Real> Plane<T> {
    /// Whether light goes towards a surface, given the cosine at the light of the way there.
    #[inline(always)]
    fn shines(&self, cos_light: T) -> bool {
        cos_light > T::zero() || (self.two_sided && cos_light < T::zero())
    }
    /// Whether the side towards `from` radiates.
    #[inline(always)]
    pub fn shines_to(&self, from: Vec3<T>) -> bool {
        self.shines((from - self.point).dot(self.normal))
    }
    /// Where the direction `wi` from `from` meets the plane, with a density.
    #[inline(always)]
    pub fn along(&self, from: Vec3<T>, wi: Vec3<T>, pdf: T) -> Option<Sighting<T>> {
        let distance = (self.point - from).dot(self.normal) / wi.dot(self.normal);
        (distance > T::zero() && pdf > T::zero()).then_some(Sighting { wi, distance, pdf })
    }
    /// A point of the light seen from `from`, if it shines there.
    #[inline(always)]
    pub fn sight(&self, from: Vec3<T>, at: Vec3<T>) -> Option<Sighting<T>> {
        let to = at - from;
        let wi = to.normalize();
        let distance = to.dot(wi);
        let cos_light = -wi.dot(self.normal);
        let pdf = distance * (distance / (self.area * cos_light.abs()));
        // NaN, from a point on the light itself, is no sighting.
        (self.shines(cos_light) && pdf > T::zero()).then_some(Sighting { wi, distance, pdf })
    }
    /// Where a ray with unit direction meets the shining side, beyond `from` itself, if the place, told from
    /// `self.point`, is `inside`.
    #[inline(always)]
    pub fn meet(&self, from: Vec3<T>, wi: Vec3<T>, inside: impl Fn(Vec3<T>) -> bool) -> Option<Sighting<T>> {
        let cos_light = -wi.dot(self.normal);
        if !self.shines(cos_light) {
            return None;
        }
        let distance = (from - self.point).dot(self.normal) / cos_light;
        let at = from + wi * distance - self.point;
        let pdf = distance * (distance / (self.area * cos_light.abs()));
        (distance > T::zero() && pdf > T::zero() && inside(at)).then_some(Sighting { wi, distance, pdf })
    }
}
