//! The irradiance of each light on an oriented point, nothing in between: I cos θ / d², E cos θ, and Lambert's formula for
//! rectangles ([`super::polygon`]), clipped at the horizon.
//!
//! J. H. Lambert, *Photometria*, 1760.

use super::Light;
use super::polygon::{self, double};
use super::rect::Rect;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// Moments of a rectangle at a point with a unit normal; zeros behind the side that shines.
#[inline(always)]
pub fn rect_moments<T: Real>(light: &Rect<T>, point: Vec3<T>, normal: Vec3<T>) -> [f64; polygon::ORDERS] {
    let (point, normal) = (double(point.to_array()), double(normal.to_array()));
    let corners = light.corners().map(|c| double(c.to_array()));
    let side = (point - double(light.center.to_array())).dot(double(light.normal.to_array()));
    if side > 0.0 || (light.two_sided && side < 0.0) {
        let sign = if side > 0.0 { 1.0 } else { -1.0 };
        polygon::moments(&polygon::seen_from(corners, point, normal)).map(|m| Lanes::max(sign * m, 0.0))
    } else {
        // NaN travels on; in the light's own plane, and behind it, there is no light.
        [(side + normal.dot(normal)) * 0.0; polygon::ORDERS]
    }
}

/// Irradiance in W/m² on the side that the unit `normal` points to.
#[inline(always)]
pub fn irradiance<T: Real>(light: &Light<T>, point: Vec3<T>, normal: Vec3<T>) -> Vec3<T> {
    match light {
        Light::Rect(rect) => {
            let [_, cosine, ..] = rect_moments(rect, point, normal);
            rect.radiance * T::of(cosine)
        }
        _ => light.beam(point).map_or(Vec3::splat(T::zero()), |beam| {
            let cos_theta = beam.wi.dot(normal);
            beam.irradiance * if cos_theta <= T::zero() { T::zero() } else { cos_theta }
        }),
    }
}

/// [`irradiance`] over arrays of equal length.
pub fn irradiance_many<T: Real>(
    watch: &mut dyn Watch,
    light: &Light<T>,
    points: &[[T; 3]],
    normals: &[[T; 3]],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (points, normals, out), 1 << 12, |_, (points, normals, out)| {
        dispatch!(_s => {
            for i in 0..out.len() {
                out[i] = irradiance(light, points[i].into(), normals[i].into()).to_array();
            }
        })
    })
}
