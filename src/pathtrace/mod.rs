//! The references: ray casting, direct light with its error, path tracing.
//!
//! - [`aov`]: what is seen beside light
//! - [`camera`]: rays through lens and shutter
//! - [`filter`]: pixel filters, as where samples lie
//! - [`film`]: what is kept of a pixel's samples
//! - [`ray_cast`]: what each pixel's centre sees
//! - [`direct_light`]: light from the lights, once reflected, with shadows, at given points
//! - [`whitted`]: mirrors, glass and hard shadows by recursion
//! - [`distribution`]: with gloss, penumbrae, lens and time
//! - [`path_trace`]: all light paths

pub mod aov;
pub mod camera;
pub(crate) mod copies;
mod diffuse;
pub mod direct_light;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // asked for by Python alone
pub mod distribution;
mod draws;
mod emitters;
mod eye;
pub(crate) mod film;
pub mod filter;
mod lighting;
pub mod path_trace;
pub mod ray_cast;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // asked for by Python alone
pub(crate) mod recursion;
mod sky;
mod standing;
mod surface;
mod wave;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // asked for by Python alone
pub mod whitted;

use crate::accel::Ray;
use crate::real::Real;
use crate::vec::Vec3;
pub use emitters::Emitters;
use film::Tally;
pub use lighting::{Lighting, Selection};
pub use surface::Surfaces;

/// A pinhole: pixel coordinates (x, y) look along `corner + x · right + y · down`.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole<T> {
    pub eye: Vec3<T>,
    pub corner: Vec3<T>,
    pub right: Vec3<T>,
    pub down: Vec3<T>,
}

impl<T: Real> Pinhole<T> {
    /// The unit direction through a point of the picture.
    #[inline(always)]
    fn direction(&self, x: T, y: T) -> Vec3<T> {
        (self.corner + self.right * x + self.down * y).normalize()
    }
}

/// A ray that leaves a surface: it starts `offset` above the side that `wi` points to, so that it does not meet the
/// surface again by rounding.
#[inline(always)]
fn leave<T: Real>(point: Vec3<T>, normal: Vec3<T>, wi: Vec3<T>, offset: T, t_max: T) -> Ray<T> {
    let origin = point + normal * offset.copysign(wi.dot(normal));
    Ray { origin: origin.to_array(), direction: wi.to_array(), t_min: T::zero(), t_max, ignore_face: -1 }
}
