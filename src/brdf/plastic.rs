//! Smooth plastic: a diffuser under a clear, smooth coat. Light passes the coat, is scattered, and is reflected back
//! inside by it until it comes out.
//!
//! The share that the coat reflects inside follows from Fresnel's average in closed form: what leaves is what enters, by
//! the square of the index, 1 − R = (1 − F̄) / η². `nonlinear` counts each inner bounce with the colour of the diffuser,
//! which makes colours deeper; otherwise once. What passes the coat is never one less what it reflects, of which nothing
//! would be left at large indices.
//!
//! W. Jakob, *Mitsuba renderer* (the documentation of `plastic`), 2010; G. Baranoski and others, as the source of the
//! inner reflectance see [`super::fresnel_average`].

use super::fresnel::{dielectric_transmittance, fresnel_dielectric};
use super::model::{Draw, Drawn, Model, Row, triple, weighed};
use crate::math::exact::largest;
use crate::real::Real;
use crate::sampling::cosine_hemisphere::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};
use crate::sampling::disk::Method;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Plastic<T> {
    pub diffuse: Vec3<T>,
    pub eta: T,
    /// What passes the coat of diffuse light from outside, 1 − F̄.
    pub passes: T,
    pub nonlinear: bool,
}

impl<T: Real> Plastic<T> {
    /// What the coat reflects along the mirror direction, over the chance of drawing that; and the chance of the others.
    #[inline(always)]
    fn chances(&self, cos_theta: T) -> (T, T) {
        let reflected = fresnel_dielectric(cos_theta, self.eta).average();
        let below = dielectric_transmittance(cos_theta, self.eta) * largest(self.diffuse);
        (reflected + below, below / (reflected + below))
    }
}

impl<T: Real> Model<T> for Plastic<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        Plastic { diffuse: triple(row, 0), eta: row[3], passes: row[4], nonlinear: row[5] > T::of(0.5) }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        if super::apart(wi, wo) {
            return Vec3::splat(T::zero());
        }
        let through = dielectric_transmittance(wi.z, self.eta) * dielectric_transmittance(wo.z, self.eta);
        // d / η² over 1 − R d.
        self.diffuse.map(
            #[inline(always)]
            |d| {
                let bounced = if self.nonlinear { d } else { T::one() };
                let left = (T::one() - bounced) * self.eta * self.eta + bounced * self.passes;
                d * through / (T::PI * left)
            },
        )
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        if wo.z <= T::zero() {
            return T::zero();
        }
        self.chances(wo.z).1 * square_to_cosine_hemisphere_pdf(wi)
    }
}

impl<T: Real> Drawn<T> for Plastic<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        let one = T::one();
        if !(wo.z > T::zero()) {
            return None;
        }
        let (weight, others) = self.chances(wo.z);
        let chance = one - others;
        if u[2] < chance {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return Some(Draw { wi, weight: Vec3::splat(weight), pdf: chance, specular: true, eta: one });
        }
        let wi = square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric);
        Some(weighed(self, wi, wo, one))
    }
}
