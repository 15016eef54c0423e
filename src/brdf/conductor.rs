//! The smooth metal: a mirror whose reflectance is Fresnel's for a complex index, per channel.

use super::fresnel::fresnel_metal;
use super::model::{Draw, Drawn, Model, Row, triple};
use crate::real::Real;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Conductor<T> {
    /// A factor of the reflectance.
    pub tint: Vec3<T>,
    pub eta: Vec3<T>,
    pub k: Vec3<T>,
}

impl<T: Real> Conductor<T> {
    /// The reflectance at a cosine.
    #[inline(always)]
    pub fn reflectance(&self, cos_theta: T) -> Vec3<T> {
        self.eta
            .zip(
                self.k,
                #[inline(always)]
                |eta, k| fresnel_metal(cos_theta, eta, k),
            )
            .times(self.tint)
    }
}

impl<T: Real> Model<T> for Conductor<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        Conductor { tint: triple(row, 0), eta: triple(row, 3), k: triple(row, 6) }
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

impl<T: Real> Drawn<T> for Conductor<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, _u: [T; 3]) -> Option<Draw<T>> {
        let one = T::one();
        if !(wo.z > T::zero()) {
            return None;
        }
        let wi = Vec3::new(-wo.x, -wo.y, wo.z);
        Some(Draw { wi, weight: self.reflectance(wo.z), pdf: one, specular: true, eta: one })
    }
}
