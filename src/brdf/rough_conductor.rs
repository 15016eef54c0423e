//! Rough metal: microscopic mirrors under Fresnel's equations for a complex index, f = D V F.
//!
//! One bounce: what the mirrors hide from each other is lost.
//!
//! B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007.

use super::fresnel::fresnel_metal;
use super::microfacets::Microfacets;
use super::model::{Draw, Model, Row, triple, weighed};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
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

/// A number in every lane.
#[inline(always)]
fn all<T: Real, S: Simd>(s: S, x: T) -> T::V8<S> {
    <T::V8<S> as SimdBase<S>>::splat(s, x)
}

impl<T: Real> RoughConductor<T> {
    /// The same metal in every lane.
    #[inline(always)]
    pub fn lanes<S: Simd>(&self, s: S) -> RoughConductor<T::V8<S>> {
        let Microfacets { alpha_x, alpha_y, ratio: [ratio, inverse], shape, masking } = self.facets;
        let (alpha_x, alpha_y) = (all(s, alpha_x), all(s, alpha_y));
        RoughConductor {
            tint: self.tint.map(
                #[inline(always)]
                |x| all(s, x),
            ),
            eta: self.eta.map(
                #[inline(always)]
                |x| all(s, x),
            ),
            k: self.k.map(
                #[inline(always)]
                |x| all(s, x),
            ),
            facets: Microfacets { alpha_x, alpha_y, ratio: [all(s, ratio), all(s, inverse)], shape, masking },
        }
    }
}

impl<T: Real> Model<T> for RoughConductor<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        let facets = Microfacets::of([row[9], row[10], row[11], row[12]]);
        RoughConductor { tint: triple(row, 0), eta: triple(row, 3), k: triple(row, 6), facets }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        self.value(wi, wo)
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        let half = wi + wo;
        if wo.z <= T::zero() || half.z <= T::zero() {
            return T::zero();
        }
        self.facets.density_over_cosine(wo, half) * T::of(0.25)
    }
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
