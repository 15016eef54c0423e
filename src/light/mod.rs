//! Punctual and area lights: what they send, where to look for them, and what arrives without obstacles.
//!
//! - [`sample`]: points on lights as seen from elsewhere, their densities, rays that meet them
//! - [`polygon`]: light from a polygon in closed form: solid angle, irradiance, higher moments of the cosine
//! - [`irradiance`]: of each light, in closed form
//! - [`ltc`]: the mirrors' light from polygons by linearly transformed cosines, and their fit
//! - [`solid_angle`]: of triangles, polygons, rectangles, spheres, boxes
//! - [`tree`]: which of many lights to draw from
//! - [`unshadowed`]: the radiance that surfaces reflect, nothing in between
//!
//! The lights themselves: [`rect`], [`textured`] (a rectangle that shows a `picture`), [`disk`], [`sphere`], [`polygon_light`], [`spot`]; [`circle`] has the closed forms
//! of disks and spheres.

pub(crate) mod circle;
pub(crate) mod disk;
mod flat;
pub mod irradiance;
pub mod ltc;
pub(crate) mod picture;
pub mod polygon;
pub(crate) mod polygon_light;
pub(crate) mod rect;
mod representative;
pub mod sample;
pub mod solid_angle;
pub(crate) mod sphere;
pub(crate) mod spot;
pub mod textured;
pub mod tree;
pub mod unshadowed;

use crate::real::Real;
use crate::vec::Vec3;
use disk::Disk;
use polygon_light::PolygonLight;
use rect::Rect;
use sphere::Sphere;
use spot::Spot;
use textured::Textured;

/// A light, per colour channel.
#[derive(Clone, Debug)]
pub enum Light<T> {
    /// Radiant intensity in W/sr.
    Point {
        position: Vec3<T>,
        intensity: Vec3<T>,
    },
    Spot(Spot<T>),
    /// Irradiance in W/m² on a plane that faces the light; `direction` is the unit vector in which it travels.
    Directional {
        direction: Vec3<T>,
        irradiance: Vec3<T>,
    },
    Rect(Rect<T>),
    Textured(Textured<T>),
    Disk(Disk<T>),
    Sphere(Sphere<T>),
    Polygon(PolygonLight<T>),
    /// The same radiance from every direction, W/(m² sr).
    Ambient {
        radiance: Vec3<T>,
    },
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

/// A point on a light as seen from elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Sighting<T> {
    /// Unit, towards the light.
    pub wi: Vec3<T>,
    /// Infinite for ambient light.
    pub distance: T,
    /// Per solid angle, of drawing this direction.
    pub pdf: T,
}

/// What one draw from a light brings: [`Light::sample`].
#[derive(Clone, Copy, Debug)]
pub struct Arrival<T> {
    /// Unit, towards the light.
    pub wi: Vec3<T>,
    pub distance: T,
    /// Radiance over density; of a beam, its irradiance on a plane that faces it.
    pub value: Vec3<T>,
    /// Per solid angle; infinite for a beam, which no other draw finds.
    pub pdf: T,
}

// What tells lights apart is scalar, and compiled once a precision rather than at every place that asks.
impl<T: Real> Light<T> {
    /// What a punctual light sends to `point`; none from area lights, or from a light at the point
    /// itself, or so near that it overflows.
    #[inline(never)]
    pub fn beam(&self, point: Vec3<T>) -> Option<Beam<T>> {
        match self {
            Light::Point { position, intensity } => from_point(*position, *intensity, point),
            Light::Spot(spot) => {
                let beam = from_point(spot.position, spot.intensity, point)?;
                let share = spot.falloff(-beam.wi);
                // NaN goes on.
                (share != T::zero()).then(|| Beam { irradiance: beam.irradiance * share, ..beam })
            }
            Light::Directional { direction, irradiance } => {
                Some(Beam { wi: -*direction, distance: T::INFINITY, irradiance: *irradiance })
            }
            _ => None,
        }
    }

    /// Whether it comes from more than one direction, so that there is something to draw.
    #[inline(always)]
    pub fn has_area(&self) -> bool {
        !matches!(self, Light::Point { .. } | Light::Spot(_) | Light::Directional { .. })
    }

    /// Whether what is seen of it has corners or a rim.
    #[inline(always)]
    pub fn has_outline(&self) -> bool {
        self.has_area() && !matches!(self, Light::Ambient { .. })
    }

    /// W/(m² sr) of an area light, on the average over its area; zero of a punctual one.
    #[inline(always)]
    pub fn radiance(&self) -> Vec3<T> {
        match self {
            Light::Rect(l) => l.radiance,
            Light::Textured(l) => l.rect.radiance,
            Light::Disk(l) => l.radiance,
            Light::Sphere(l) => l.radiance,
            Light::Polygon(l) => l.radiance,
            Light::Ambient { radiance } => *radiance,
            _ => Vec3::splat(T::zero()),
        }
    }

    /// What is seen of an area light along a sighting, W/(m² sr).
    #[inline(always)]
    pub fn shown(&self, from: Vec3<T>, s: &Sighting<T>) -> Vec3<T> {
        match self {
            Light::Textured(l) => l.radiance(from, s.wi, s.distance),
            _ => self.radiance(),
        }
    }

    /// The middle of a light with an outline, with the density of a point drawn evenly.
    #[inline(always)]
    pub fn middle(&self, from: Vec3<T>) -> Option<Sighting<T>> {
        let half = [T::of(0.5), T::of(0.5)];
        match self {
            Light::Textured(l) => l.rect.sample(from, half),
            _ => self.sight(from, half),
        }
    }

    /// A direction towards an area light, for a point of the unit square; None from where the drawn point does not
    /// shine, and for punctual lights.
    #[inline(never)]
    pub fn sight(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        match self {
            Light::Rect(l) => l.sample(from, u),
            Light::Textured(l) => l.sample(from, u),
            Light::Disk(l) => l.sample(from, u),
            Light::Sphere(l) => l.sample(from, u),
            Light::Polygon(l) => l.sample(from, u),
            Light::Ambient { .. } => Some(everywhere(sample::anywhere(u))),
            _ => None,
        }
    }

    /// Where a ray with unit direction meets an area light that shines against it, with the density of [`Light::sight`].
    #[inline(never)]
    pub fn meet(&self, from: Vec3<T>, wi: Vec3<T>) -> Option<Sighting<T>> {
        match self {
            Light::Rect(l) => l.meet(from, wi),
            Light::Textured(l) => l.meet(from, wi),
            Light::Disk(l) => l.meet(from, wi),
            Light::Sphere(l) => l.meet(from, wi),
            Light::Polygon(l) => l.meet(from, wi),
            Light::Ambient { .. } => Some(everywhere(wi)),
            _ => None,
        }
    }

    /// [`Light::sight`] evenly over the solid angle where there is a map: rectangles, polygons, spheres, ambient light.
    #[inline(always)]
    pub fn sight_evenly(&self, from: Vec3<T>, u: [T; 2]) -> Option<Sighting<T>> {
        match self {
            Light::Rect(l) => l.sample_evenly(from, u),
            Light::Textured(l) => l.rect.sample_evenly(from, u),
            Light::Polygon(l) => l.sample_evenly(from, u),
            _ => self.sight(from, u),
        }
    }

    /// [`Light::meet`] with the density of [`Light::sight_evenly`].
    #[inline(always)]
    pub fn meet_evenly(&self, from: Vec3<T>, wi: Vec3<T>) -> Option<Sighting<T>> {
        let met = self.meet(from, wi)?;
        let solid_angle = match self {
            Light::Rect(l) => l.solid_angle(from),
            Light::Textured(l) => l.rect.solid_angle(from),
            Light::Polygon(l) => l.solid_angle(from),
            _ => return Some(met),
        };
        Some(Sighting { pdf: T::one() / solid_angle, ..met })
    }

    /// The density of [`Light::sight`] per solid angle, zero where a ray misses.
    #[inline(always)]
    pub fn pdf(&self, from: Vec3<T>, wi: Vec3<T>) -> T {
        self.meet(from, wi).map_or(T::zero(), |s| s.pdf)
    }

    /// Whether rays may meet it somewhere.
    pub fn stands(&self) -> bool {
        matches!(
            self,
            Light::Rect(_) | Light::Textured(_) | Light::Disk(_) | Light::Sphere(_) | Light::Polygon(_)
        )
    }

    /// Light that arrives if nothing is in between: a beam, or one draw from an area.
    #[inline(always)]
    pub fn sample(&self, from: Vec3<T>, u: [T; 2]) -> Option<Arrival<T>> {
        if let Some(s) = self.sight(from, u) {
            let value = self.shown(from, &s) * (T::one() / s.pdf);
            return Some(Arrival { wi: s.wi, distance: s.distance, value, pdf: s.pdf });
        }
        let beam = self.beam(from)?;
        Some(Arrival { wi: beam.wi, distance: beam.distance, value: beam.irradiance, pdf: T::INFINITY })
    }
}

#[inline(always)]
fn from_point<T: Real>(position: Vec3<T>, intensity: Vec3<T>, point: Vec3<T>) -> Option<Beam<T>> {
    let to = position - point;
    if to == Vec3::splat(T::zero()) {
        return None;
    }
    let wi = to.normalize();
    let distance = to.dot(wi);
    // In two steps: the square of a large distance overflows before the quotient vanishes.
    let irradiance = intensity.map(
        #[inline(always)]
        |i| i / distance / distance,
    );
    // So near that no number holds what arrives: as at the light itself. NaN goes on.
    if irradiance.x == T::INFINITY || irradiance.y == T::INFINITY || irradiance.z == T::INFINITY {
        return None;
    }
    Some(Beam { wi, distance, irradiance })
}

/// Ambient light, from `wi`.
#[inline(always)]
fn everywhere<T: Real>(wi: Vec3<T>) -> Sighting<T> {
    Sighting { wi, distance: T::INFINITY, pdf: T::one() / (T::of(4.0) * T::PI) }
}
