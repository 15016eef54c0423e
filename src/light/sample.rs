//! Directions towards area lights, drawn from the unit square, with their densities per solid angle.
//!
//! Flat lights draw points evenly over their area: the density d² / (A cos θ), θ at the light, grows without bound
//! where they are seen edge-on, and with it falls what a sample carries. Rectangles and polygons may draw evenly over
//! their solid angle instead, so that every sample carries the same; it costs more. Spheres draw evenly over the cone in which they
//! are seen, ambient light over all directions.
//!
//! P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996.

use super::Light;
use crate::dispatch;
use crate::math;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// A direction of the whole sphere, evenly.
#[inline(always)]
pub(super) fn anywhere<T: Real>(u: [T; 2]) -> Vec3<T> {
    let (one, two) = (T::one(), T::of(2.0));
    let z = one - two * u[0];
    let r = Lanes::max((one - z) * (one + z), T::zero()).sqrt();
    let (sin, cos) = math::sin_cos(two * T::PI * u[1]);
    Vec3::new(r * cos, r * sin, z)
}

/// [`Light::sight`], or [`Light::sight_evenly`], over arrays of equal length: directions, distances and densities; zeros where nothing shines, NaN
/// where `u` is outside of the unit square.
pub fn light_sample_many<T: Real>(
    watch: &mut dyn Watch,
    light: &Light<T>,
    evenly: bool,
    points: &[[T; 3]],
    u: &[[T; 2]],
    wi: &mut [[T; 3]],
    distance: &mut [T],
    pdf: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (points, u, wi, distance, pdf), 1 << 12, |_, (points, u, wi, distance, pdf)| {
        dispatch!(_s => {
            for i in 0..points.len() {
                let from = Vec3::from(points[i]);
                let [v, w] = u[i];
                let inside = v >= T::zero() && v <= T::one() && w >= T::zero() && w <= T::one();
                let nan = if inside { from.dot(Vec3::splat(T::zero())) } else { T::NAN };
                (wi[i], distance[i], pdf[i]) = match if evenly { light.sight_evenly(from, u[i]) } else { light.sight(from, u[i]) } {
                    Some(s) if !nan.is_nan() => (s.wi.to_array(), s.distance, s.pdf),
                    _ => ([nan; 3], nan, nan),
                };
            }
        })
    })
}

/// The density of [`light_sample_many`], of unit directions: zero where they miss the shining side.
pub fn light_pdf_many<T: Real>(
    watch: &mut dyn Watch,
    light: &Light<T>,
    evenly: bool,
    points: &[[T; 3]],
    wi: &[[T; 3]],
    pdf: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (points, wi, pdf), 1 << 12, |_, (points, wi, pdf)| {
        dispatch!(_s => {
            for i in 0..points.len() {
                let (from, w) = (Vec3::from(points[i]), Vec3::from(wi[i]));
                let nan = (from + w).dot(Vec3::splat(T::zero()));
                let met = if evenly { light.meet_evenly(from, w) } else { light.meet(from, w) };
                pdf[i] = met.map_or(nan, |s| s.pdf + nan);
            }
        })
    })
}
