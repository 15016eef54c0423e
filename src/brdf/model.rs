//! What every reflection model gives: its value, a direction drawn from it, and the density of drawing it.
//!
//! Models come from rows of numbers, the same for arrays, pictures and paths. The first three numbers of a row are a
//! colour, by which colours of vertices and textures are multiplied. Domains are checked where rows are made; a
//! parameter that is NaN makes the values NaN.
//!
//! Directions are unit, in the frame whose z is the normal. `wo` goes to the eye, `wi` to the light. Opaque models
//! reflect above the horizon alone; those that transmit take directions on both sides, z pointing out of the body.
//! Values are for radiance: what crosses into the body and comes back out keeps it, since radiance is divided by the
//! square of the index on the way in and multiplied by it on the way out.

use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// Numbers of a row.
pub const WIDTH: usize = 20;

pub type Row<T> = [T; WIDTH];

/// A direction to the light, drawn for one to the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw<T> {
    pub wi: Vec3<T>,
    /// Value times cosine over density; zero where nothing comes back (below the horizon, say).
    pub weight: Vec3<T>,
    /// Per solid angle; of a specular draw the chance of it.
    pub pdf: T,
    /// One of finitely many directions (mirrors, smooth interfaces), which light samples cannot hit.
    pub specular: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`: one unless the draw crosses.
    pub eta: T,
}

impl<T: Real> Draw<T> {
    /// Nothing comes back.
    #[inline(always)]
    pub fn none(wi: Vec3<T>) -> Self {
        let zero = T::zero();
        Draw { wi, weight: Vec3::splat(zero), pdf: zero, specular: false, eta: T::one() }
    }
}

/// Of numbers, or of lanes where a model is written for both; options are then those of the first lane.
pub trait Model<V: Lanes>: Copy {
    fn of(row: &Row<V>) -> Self;
    /// The BSDF in sr⁻¹, without the cosine; what is specular has no value.
    fn eval(&self, wi: Vec3<V>, wo: Vec3<V>) -> Vec3<V>;
    /// The density of [`Drawn::sample`] per solid angle of `wi`, without specular draws.
    fn pdf(&self, wi: Vec3<V>, wo: Vec3<V>) -> V;
}

pub trait Drawn<T: Real>: Model<T> {
    /// A direction for `wo` from three numbers of [0, 1); None if nothing can come back along `wo`.
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>>;
}

/// The draw of a direction, by the model's own value and density.
#[inline(always)]
pub fn weighed<T: Real, M: Model<T>>(model: &M, wi: Vec3<T>, wo: Vec3<T>, eta: T) -> Draw<T> {
    let pdf = model.pdf(wi, wo);
    // Of densities below the normal numbers no quotient is known; they are drawn never.
    if !(pdf >= T::MIN_POSITIVE) {
        return Draw { eta, ..Draw::none(wi) };
    }
    Draw { wi, weight: model.eval(wi, wo) * (wi.z.abs() / pdf), pdf, specular: false, eta }
}

/// The three numbers of a row from `at` on.
#[inline(always)]
pub fn triple<V: Copy>(row: &Row<V>, at: usize) -> Vec3<V> {
    Vec3::new(row[at], row[at + 1], row[at + 2])
}
