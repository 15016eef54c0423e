//! The perfect diffuser: the same radiance in every direction, albedo / π of the irradiance.
//!
//! J. H. Lambert, *Photometria*, 1760.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
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
