//! The irradiance of each light on an oriented point, nothing in between: I cos θ / d², E cos θ, Lambert's formula for
//! polygons ([`super::polygon`]), and disks and spheres by their rims ([`super::circle`]), all clipped exactly at the
//! horizon.
//!
//! J. H. Lambert, *Photometria*, 1760.

use super::Light;
use super::circle::Circle;
use super::polygon::{self, Moments, double};
use super::textured::Textured;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// Moments of a flat light at a point with a unit normal, from those of its front; zeros behind the side that shines.
/// `to` leads from the point to the light's plane.
#[inline(always)]
fn of_sides(to: Vec3<f64>, normal: Vec3<f64>, two_sided: bool, moments: impl Fn() -> Moments) -> Moments {
    let side = -to.dot(normal);
    if side > 0.0 || (two_sided && side < 0.0) {
        let sign = if side > 0.0 { 1.0 } else { -1.0 };
        moments().map(|m| Lanes::max(sign * m, 0.0))
    } else {
        // NaN travels on; in the light's own plane, and behind it, there is no light.
        [side * 0.0; polygon::ORDERS]
    }
}

/// ∫ cosⁿθ dω for n = 0 … 6 over what is seen of an area light above the horizon of a point with a unit normal.
#[inline(never)]
pub fn moments<T: Real>(light: &Light<T>, point: Vec3<T>, normal: Vec3<T>) -> Moments {
    area(light, point, normal, |circle| circle.moments(), polygon::moments)
}

/// [`moments`], by what gives those of a circle and of a polygon.
#[inline(always)]
fn area<T: Real>(
    light: &Light<T>,
    point: Vec3<T>,
    normal: Vec3<T>,
    circle: impl Fn(&Circle) -> Moments,
    polygon: impl Fn(&[Vec3<f64>]) -> Moments,
) -> Moments {
    let (point, normal) = (double(point.to_array()), double(normal.to_array()));
    let frame = Frame::about(normal);
    let seen = |v: Vec3<T>| frame.local(double(v.to_array()) - point);
    let turned = |v: Vec3<T>| frame.local(double(v.to_array()));
    let nan = (point + normal).dot(Vec3::splat(0.0));
    let none = [nan; polygon::ORDERS];
    if nan.is_nan() {
        return none;
    }
    match light {
        Light::Rect(l) | Light::Textured(Textured { rect: l, .. }) => {
            let corners = l.corners().map(seen);
            of_sides(seen(l.center), turned(l.normal), l.two_sided, || polygon(&corners))
        }
        Light::Polygon(l) => {
            let plane = l.plane;
            of_sides(seen(plane.point), turned(plane.normal), plane.two_sided, || {
                let corners: Vec<_> = l.corners.iter().map(|&c| frame.local(c - point)).collect();
                polygon(&corners)
            })
        }
        Light::Disk(l) => {
            let (center, axis) = (seen(l.center), turned(l.frame.z));
            // A circle is turned to whoever looks.
            let facing = if center.dot(axis) > 0.0 && l.two_sided { -axis } else { axis };
            of_sides(center, facing, false, || circle(&Circle::new(center, axis, l.radius.to_f64())))
        }
        Light::Sphere(l) => Circle::rim(seen(l.center), l.radius.to_f64()).map_or(none, |rim| circle(&rim)),
        Light::Ambient { .. } => std::array::from_fn(|n| std::f64::consts::TAU / (n + 1) as f64),
        _ => none,
    }
}

/// Irradiance in W/m² on the side that the unit `normal` points to.
#[inline(always)]
pub fn irradiance<T: Real>(light: &Light<T>, point: Vec3<T>, normal: Vec3<T>) -> Vec3<T> {
    if let Light::Textured(l) = light {
        return l.irradiance(double(point.to_array()), double(normal.to_array())).map(T::of);
    }
    if light.has_area() {
        let first = |m: f64| [0.0, m, 0.0, 0.0, 0.0, 0.0, 0.0];
        let [_, cosine, ..] = area(
            light,
            point,
            normal,
            |circle| first(Lanes::max(circle.irradiance(), 0.0)),
            polygon::moments,
        );
        return light.radiance() * T::of(cosine);
    }
    light.beam(point).map_or(Vec3::splat(T::zero()), |beam| {
        let cos_theta = beam.wi.dot(normal);
        beam.irradiance * if cos_theta <= T::zero() { T::zero() } else { cos_theta }
    })
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
