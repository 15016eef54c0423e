//! Punctual and area lights: what they send, where to look for them, and what arrives without obstacles.
//!
//! - [`rect`]: points on rectangles, their densities, rays that meet them
//! - [`polygon`]: light from a polygon in closed form: solid angle, irradiance, higher moments of the cosine
//! - [`irradiance`]: of each light, in closed form
//! - [`unshadowed`]: the radiance that surfaces reflect, nothing in between

pub mod irradiance;
pub mod polygon;
pub mod rect;
pub mod unshadowed;

use crate::real::Real;
use crate::vec::Vec3;
use rect::Rect;

/// A light, per colour channel.
#[derive(Clone, Copy, Debug)]
pub enum Light<T> {
    /// Radiant intensity in W/sr.
    Point {
        position: Vec3<T>,
        intensity: Vec3<T>,
    },
    /// Irradiance in W/m² on a plane that faces the light; `direction` is the unit vector in which it travels.
    Directional {
        direction: Vec3<T>,
        irradiance: Vec3<T>,
    },
    Rect(Rect<T>),
}

/// Light that arrives at a point from one direction: a punctual light.
#[derive(Clone, Copy, Debug)]
pub struct Beam<T> {
    /// Unit, towards the light.
    pub wi: Vec3<T>,
    /// Infinite for directional lights.
    pub distance: T,
    /// On a plane that faces the light, W/m².
    pub irradiance: Vec3<T>,
}

impl<T: Real> Light<T> {
    /// What a punctual light sends to `point`; none from area lights, or from a light at the point itself.
    #[inline(always)]
    pub fn beam(&self, point: Vec3<T>) -> Option<Beam<T>> {
        match *self {
            Light::Point { position, intensity } => {
                let to = position - point;
                if to == Vec3::splat(T::zero()) {
                    return None;
                }
                let wi = to.normalize();
                let distance = to.dot(wi);
                // In two steps: the square of a large distance overflows before the quotient vanishes.
                let irradiance = intensity.map(|i| i / distance / distance);
                Some(Beam { wi, distance, irradiance })
            }
            Light::Directional { direction, irradiance } => {
                Some(Beam { wi: -direction, distance: T::INFINITY, irradiance })
            }
            Light::Rect(_) => None,
        }
    }
}
