//! Rough metal: microscopic mirrors under Fresnel's equations for a complex index, f = D V F.
//!
//! One bounce: what the mirrors hide from each other is lost.
//!
//! B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007.

use super::fresnel::fresnel_metal;
use super::microfacets::Microfacets;
use super::model::{Draw, Drawn, Model, Row, triple, weighed};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct RoughConductor<V> {
    pub tint: Vec3<V>,
    pub eta: Vec3<V>,
    pub k: Vec3<V>,
    pub facets: Microfacets<V>,
}

impl<V: Lanes> RoughConductor<V> {
    /// The BRDF; zero unless both directions are above the horizon. In lanes as well.
    #[inline(always)]
    pub fn value(&self, wi: Vec3<V>, wo: Vec3<V>) -> Vec3<V> {
        let zero = wi.z.num(0.0);
        let half = wi + wo;
        let d = self.facets.distribution(half) * self.facets.visibility(wi, wo, half);
        // Unit directions: (wi + wo)·wo = |wi + wo|² / 2.
        let cos_half = (half.length_squared().sqrt() * zero.num(0.5)).min(zero.num(1.0));
        let apart = wi.z.less_eq(zero) | wo.z.less_eq(zero);
        self.fresnel(cos_half).map(
            #[inline(always)]
            |f| V::select(apart, zero, f * d),
        )
    }
    /// The reflectance of a mirror at a cosine.
    #[inline(always)]
    pub fn fresnel(&self, cos_half: V) -> Vec3<V> {
        self.eta
            .zip(
                self.k,
                #[inline(always)]
                |eta, k| fresnel_metal(cos_half, eta, k),
            )
            .times(self.tint)
    }
}

impl<V: Lanes> Model<V> for RoughConductor<V> {
    #[inline(always)]
    fn of(row: &Row<V>) -> Self {
        let facets = Microfacets::of(row[9], row[10], row[11], row[12]);
        RoughConductor { tint: triple(row, 0), eta: triple(row, 3), k: triple(row, 6), facets }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<V>, wo: Vec3<V>) -> Vec3<V> {
        self.value(wi, wo)
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<V>, wo: Vec3<V>) -> V {
        let (half, zero) = (wi + wo, wo.z.num(0.0));
        let density = self.facets.density_over_cosine(wo, half) * zero.num(0.25);
        V::select(wo.z.less_eq(zero) | half.z.less_eq(zero), zero, density)
    }
}

impl<T: Real> Drawn<T> for RoughConductor<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        if !(wo.z > T::zero()) {
            return None;
        }
        let half = self.facets.sample(wo, [u[0], u[1]]);
        let wi = half * (T::of(2.0) * wo.dot(half)) - wo;
        Some(weighed(self, wi, wo, T::one()))
    }
}
