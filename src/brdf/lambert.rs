//! The perfect diffuser: the same radiance in every direction, albedo / π of the irradiance.
//!
//! J. H. Lambert, *Photometria*, 1760.

use super::model::{Draw, Model, Row, triple, weighed};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::sampling::cosine_hemisphere::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};
use crate::sampling::disk::Method;
use crate::vec::Vec3;

/// The BRDF in sr⁻¹ for unit directions in the local frame; zero unless both are above the horizon.
#[inline(always)]
pub fn lambert<T: Real>(wi: Vec3<T>, wo: Vec3<T>, albedo: Vec3<T>) -> Vec3<T> {
    if super::apart(wi, wo) {
        Vec3::splat(T::zero())
    } else {
        albedo * (T::one() / T::PI + (wi.z + wo.z) * T::zero())
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Diffuse<T> {
    pub albedo: Vec3<T>,
}

impl<T: Real> Model<T> for Diffuse<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        Diffuse { albedo: triple(row, 0) }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        lambert(wi, wo, self.albedo)
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        cosine_pdf(wi, wo)
    }
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        cosine_sample(self, wo, u)
    }
}

/// The density of [`cosine_sample`].
#[inline(always)]
pub fn cosine_pdf<T: Real>(wi: Vec3<T>, wo: Vec3<T>) -> T {
    if wo.z <= T::zero() { T::zero() } else { square_to_cosine_hemisphere_pdf(wi) }
}

/// A direction by the cosine, for models that are nearly diffuse.
#[inline(always)]
pub fn cosine_sample<T: Real, M: Model<T>>(model: &M, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
    if !(wo.z > T::zero()) {
        return None;
    }
    let wi = square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric);
    Some(weighed(model, wi, wo, T::one()))
}

/// [`lambert`] over arrays of equal length; NaN where the albedo is not in [0, 1].
pub fn lambert_many<T: Real>(
    watch: &mut dyn Watch,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    albedo: &[[T; 3]],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (wi, wo, albedo, out),
        1 << 13,
        |_, (wi, wo, albedo, out)| dispatch!(_s => body(wi, wo, albedo, out)),
    )
}

#[inline(always)]
fn body<T: Real>(wi: &[[T; 3]], wo: &[[T; 3]], albedo: &[[T; 3]], out: &mut [[T; 3]]) {
    for i in 0..out.len() {
        let albedo = Vec3::from(albedo[i]).map(super::in_unit);
        out[i] = lambert(wi[i].into(), wo[i].into(), albedo).to_array();
    }
}
