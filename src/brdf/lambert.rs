//! The perfect diffuser: the same radiance in every direction, albedo / π of the irradiance.
//!
//! J. H. Lambert, *Photometria*, 1760.

use super::model::{Draw, Drawn, Model, Row, triple, weighed};
use crate::real::{Lanes, Real};
use crate::sampling::cosine_hemisphere::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};
use crate::sampling::disk::Method;
use crate::vec::Vec3;

/// The BRDF in sr⁻¹ for unit directions in the local frame; zero unless both are above the horizon.
#[inline(always)]
pub fn lambert<V: Lanes>(wi: Vec3<V>, wo: Vec3<V>, albedo: Vec3<V>) -> Vec3<V> {
    let (z, one) = (wi.z + wo.z, wi.z.num(1.0));
    super::above(wi, wo, albedo * (one / one.num(std::f64::consts::PI) + z * one.num(0.0)))
}

#[derive(Clone, Copy, Debug)]
pub struct Diffuse<T> {
    pub albedo: Vec3<T>,
}

impl<V: Lanes> Model<V> for Diffuse<V> {
    #[inline(always)]
    fn of(row: &Row<V>) -> Self {
        Diffuse { albedo: triple(row, 0) }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<V>, wo: Vec3<V>) -> Vec3<V> {
        lambert(wi, wo, self.albedo)
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<V>, wo: Vec3<V>) -> V {
        cosine_pdf(wi, wo)
    }
}

impl<T: Real> Drawn<T> for Diffuse<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        cosine_sample(self, wo, u)
    }
}

/// The density of [`cosine_sample`].
#[inline(always)]
pub fn cosine_pdf<V: Lanes>(wi: Vec3<V>, wo: Vec3<V>) -> V {
    let zero = wo.z.num(0.0);
    V::select(wo.z.less_eq(zero), zero, square_to_cosine_hemisphere_pdf(wi))
}

/// A direction by the cosine, for models that are nearly diffuse.
#[inline(always)]
pub fn cosine_sample<T: Real, M: Drawn<T>>(model: &M, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
    if !(wo.z > T::zero()) {
        return None;
    }
    let wi = square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric);
    Some(weighed(model, wi, wo, T::one()))
}
