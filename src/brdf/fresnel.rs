//! Fresnel reflectance by Schlick's polynomial: `f0` at normal incidence, `f90` at grazing.
//!
//! Within 0.04 of Fresnel's equations for glass, coarser for metals beyond 60°.
//!
//! C. Schlick, *An inexpensive BRDF model for physically-based rendering*, 1994.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;

/// (1 − c)⁵, the weight of `f90`.
#[inline(always)]
pub fn schlick_weight<T: Real>(cos_theta: T) -> T {
    let x = T::one() - cos_theta;
    let squared = x * x;
    squared * squared * x
}

#[inline(always)]
pub fn fresnel_schlick<T: Real>(cos_theta: T, f0: T, f90: T) -> T {
    f0 + (f90 - f0) * schlick_weight(cos_theta)
}

/// [`fresnel_schlick`] over arrays of equal length; NaN outside cos θ ∈ [0, 1].
pub fn fresnel_schlick_many<T: Real>(
    watch: &mut dyn Watch,
    cos_theta: &[T],
    f0: &[T],
    f90: &[T],
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (cos_theta, f0, f90, out),
        1 << 14,
        |_, (c, f0, f90, out)| dispatch!(_s => body(c, f0, f90, out)),
    )
}

#[inline(always)]
fn body<T: Real>(cos_theta: &[T], f0: &[T], f90: &[T], out: &mut [T]) {
    for i in 0..out.len() {
        let c = cos_theta[i];
        let inside = c >= T::zero() && c <= T::one();
        out[i] = if inside { fresnel_schlick(c, f0[i], f90[i]) } else { T::NAN };
    }
}
