//! The mirrors' light from an area light as if all of it came from one point: that on the light nearest to the mirror
//! direction, by a lobe that is widened, and dimmed by as much, for the size of the light.
//!
//! Cheap, right in the limits of sharp and far, and wrong between: the shape of highlights is not that of the light.
//!
//! B. Karis, *Real shading in Unreal Engine 4*, 2013.

use super::Light;
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// One direction that stands for all of a light.
#[derive(Clone, Copy, Debug)]
pub struct Representative<T> {
    /// Unit.
    pub wi: Vec3<T>,
    /// About the solid angle of the light.
    pub solid_angle: T,
    /// What the width of the lobe grows by.
    pub wider: T,
}

/// Of a rectangle, a disk or a sphere, for the mirror direction `mirror`; None where it does not shine, and of others.
#[inline(always)]
pub fn representative<T: Real>(
    light: &Light<T>,
    from: Vec3<T>,
    mirror: Vec3<T>,
) -> Option<Representative<T>> {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let clamp = |x: T, end: T| Lanes::min(Lanes::max(x, -end), end);
    // The place in a plane at which the mirror direction arrives, from its middle; as far as may be if never.
    let arrives = |center: Vec3<T>, normal: Vec3<T>| {
        let (to, along) = (center - from, mirror.dot(normal));
        let t = to.dot(normal) / along;
        let far = T::of(1e3) * to.length();
        mirror * (if t > zero && t < far { t } else { far }) - to
    };
    let flat = |at: Vec3<T>, normal: Vec3<T>, area: T, two_sided: bool| {
        let to = at - from;
        let wi = to.normalize();
        let distance = to.dot(wi);
        let cos_light = -wi.dot(normal);
        let shines = cos_light > zero || (two_sided && cos_light < zero);
        // Of a small light; next to a large one no more than half of all directions.
        let solid_angle = Lanes::min(area * cos_light.abs() / distance / distance, T::PI + T::PI);
        let wider = half * (area / T::PI).sqrt() / distance;
        (shines && distance > zero).then_some(Representative { wi, solid_angle, wider })
    };
    match light {
        Light::Rect(l) => {
            let at = arrives(l.center, l.normal);
            let along = |edge: Vec3<T>| edge * clamp(at.dot(edge) / edge.length_squared(), half);
            flat(l.center + along(l.edge_u) + along(l.edge_v), l.normal, l.area, l.two_sided)
        }
        Light::Disk(l) => {
            let at = arrives(l.center, l.frame.z);
            let at = l.frame.x * at.dot(l.frame.x) + l.frame.y * at.dot(l.frame.y);
            let scale = Lanes::min(l.radius / at.length(), one);
            let scale = if scale > zero { scale } else { one };
            flat(l.center + at * scale, l.frame.z, l.area(), l.two_sided)
        }
        Light::Sphere(l) => {
            let to = l.center - from;
            let distance = to.length();
            if !(distance > l.radius) {
                return None;
            }
            let nearest = mirror * Lanes::max(to.dot(mirror), zero) - to;
            let scale = Lanes::min(l.radius / nearest.length(), one);
            let wi = (to + nearest * (if scale > zero { scale } else { one })).normalize();
            let sin = l.radius / distance;
            Some(Representative { wi, solid_angle: T::PI * sin * sin, wider: half * sin })
        }
        _ => None,
    }
}
