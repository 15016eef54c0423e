//! Smooth plastic: a diffuser under a clear, smooth coat. Light passes the coat, is scattered, and is reflected back
//! inside by it until it comes out.
//!
//! The share that the coat reflects inside is Fresnel's average in closed form. `nonlinear` counts each inner bounce
//! with the colour of the diffuser, which makes colours deeper; otherwise once.
//!
//! W. Jakob, *Mitsuba renderer* (the documentation of `plastic`), 2010; G. Baranoski and others, as the source of the
//! inner reflectance see [`super::fresnel_average`].

use super::fresnel::fresnel_dielectric;
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
    /// What the coat reflects of diffuse light from inside.
    pub inner: T,
    pub nonlinear: bool,
}

impl<T: Real> Plastic<T> {
    #[inline(always)]
    fn reflected(&self, cos_theta: T) -> T {
        fresnel_dielectric(cos_theta, self.eta).average()
    }
    /// The chance of drawing the mirror direction.
    #[inline(always)]
    fn chance(&self, reflected: T) -> T {
        reflected / (reflected + (T::one() - reflected) * largest(self.diffuse))
    }
}

impl<T: Real> Model<T> for Plastic<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        Plastic { diffuse: triple(row, 0), eta: row[3], inner: row[4], nonlinear: row[5] > T::of(0.5) }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        if super::apart(wi, wo) {
            return Vec3::splat(T::zero());
        }
        let one = T::one();
        let through = (one - self.reflected(wi.z)) * (one - self.reflected(wo.z));
        let scale = through / (self.eta * self.eta * T::PI);
        self.diffuse.map(
            #[inline(always)]
            |d| d * scale / (one - self.inner * if self.nonlinear { d } else { one }),
        )
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        if wo.z <= T::zero() {
            return T::zero();
        }
        (T::one() - self.chance(self.reflected(wo.z))) * square_to_cosine_hemisphere_pdf(wi)
    }
}

impl<T: Real> Drawn<T> for Plastic<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        let one = T::one();
        if !(wo.z > T::zero()) {
            return None;
        }
        let reflected = self.reflected(wo.z);
        let chance = self.chance(reflected);
        if u[2] < chance {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            let weight = Vec3::splat(reflected / chance);
            return Some(Draw { wi, weight, pdf: chance, specular: true, eta: one });
        }
        let wi = square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric);
        Some(weighed(self, wi, wo, one))
    }
}
