//! The smooth interface between two clear bodies: reflects by Fresnel's equations, refracts the rest by Snell's law.
//!
//! z points out of the body whose index is `eta` times that outside. Refracted radiance is divided by the square of the
//! index it leaves for `wo` over (1/η on the way in), as radiance per η² is what stays along a ray.

use super::fresnel::fresnel_dielectric;
use super::model::{Draw, Drawn, Model, Row, triple};
use crate::real::Real;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Dielectric<T> {
    /// A factor of what passes.
    pub tint: Vec3<T>,
    /// Index inside over outside.
    pub eta: T,
}

impl<T: Real> Model<T> for Dielectric<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        Dielectric { tint: triple(row, 0), eta: row[3] }
    }
    #[inline(always)]
    fn eval(&self, _wi: Vec3<T>, _wo: Vec3<T>) -> Vec3<T> {
        Vec3::splat(T::zero())
    }
    #[inline(always)]
    fn pdf(&self, _wi: Vec3<T>, _wo: Vec3<T>) -> T {
        T::zero()
    }
}

impl<T: Real> Drawn<T> for Dielectric<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        let one = T::one();
        let eta = if wo.z > T::zero() { self.eta } else { one / self.eta };
        let f = fresnel_dielectric(wo.z.abs(), eta);
        let reflectance = f.average();
        if !(wo.z.abs() > T::zero()) {
            None
        } else if u[2] < reflectance {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            Some(Draw { wi, weight: Vec3::splat(one), pdf: reflectance, specular: true, eta: one })
        } else {
            let shrink = one / eta;
            let wi = Vec3::new(-wo.x * shrink, -wo.y * shrink, -f.cos_t.copysign(wo.z));
            let weight = self.tint * (shrink * shrink);
            Some(Draw { wi, weight, pdf: one - reflectance, specular: true, eta })
        }
    }
}
