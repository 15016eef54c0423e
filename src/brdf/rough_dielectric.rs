//! Rough glass: microscopic smooth interfaces that reflect and refract.
//!
//! z points out of the body whose index is `eta` times that outside; directions stand on both sides. Refraction takes
//! Smith's separable masking, whichever reflection has. With η = 1 nothing is bent: light passes straight, specular.
//!
//! B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007.

use super::fresnel::fresnel_dielectric;
use super::microfacets::Microfacets;
use super::model::{Draw, Drawn, Model, Row, triple, weighed};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric<T> {
    /// A factor of what passes.
    pub tint: Vec3<T>,
    /// Index inside over outside.
    pub eta: T,
    pub facets: Microfacets<T>,
}

impl<T: Real> RoughDielectric<T> {
    /// Index on the other side over that on the side of `wo`.
    #[inline(always)]
    pub fn across(&self, wo: Vec3<T>) -> T {
        if wo.z > T::zero() { self.eta } else { T::one() / self.eta }
    }
    /// The reflectance of an interface at a cosine.
    #[inline(always)]
    pub fn fresnel(&self, cos_half: T, wo: Vec3<T>) -> Vec3<T> {
        Vec3::splat(fresnel_dielectric(cos_half.abs(), self.across(wo)).average())
    }
    /// What an interface passes: none where rounding takes its reflectance above one.
    #[inline(always)]
    fn through(cos_half: T, eta: T) -> T {
        Lanes::max(T::one() - fresnel_dielectric(cos_half, eta).average(), T::zero())
    }
    /// Both directions with `wo` above the horizon: the surface is the same seen from below.
    #[inline(always)]
    fn upright(wi: Vec3<T>, wo: Vec3<T>) -> (Vec3<T>, Vec3<T>) {
        if wo.z < T::zero() { (-wi, -wo) } else { (wi, wo) }
    }
    /// The unit normal, above the horizon, that refracts one into the other, and wo·h + η wi·h; None where no interface
    /// does.
    #[inline(always)]
    fn bend(wi: Vec3<T>, wo: Vec3<T>, eta: T) -> Option<(Vec3<T>, T)> {
        let sum = wo + wi * eta;
        let length = sum.length();
        let half = sum * (T::one().copysign(sum.z) / length);
        let (ci, co) = (wi.dot(half), wo.dot(half));
        // Against the beam |wo·h + η wi·h| is the length of the sum itself.
        (length > T::zero() && co > T::zero() && ci < T::zero()).then_some((half, length))
    }
}

impl<T: Real> Model<T> for RoughDielectric<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        let facets = Microfacets::of(row[4], row[5], row[6], row[7]);
        RoughDielectric { tint: triple(row, 0), eta: row[3], facets }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let none = Vec3::splat(T::zero());
        let eta = self.across(wo);
        let (wi, wo) = Self::upright(wi, wo);
        if wi.z * wo.z == T::zero() {
            return none;
        }
        if wi.z > T::zero() {
            let half = wi + wo;
            let cos_half = Lanes::min(half.length() * T::of(0.5), T::one());
            let f = fresnel_dielectric(cos_half, eta).average();
            return Vec3::splat(self.facets.distribution(half) * self.facets.visibility(wi, wo, half) * f);
        }
        let Some((half, sum)) = Self::bend(wi, wo, eta) else { return Vec3::splat(wi.dot(wo) * T::zero()) };
        let (ci, co) = (wi.dot(half).abs(), wo.dot(half).abs());
        let through = Self::through(co, eta);
        let masked = self.facets.masking_at(wi, half) * self.facets.masking_at(wo, half);
        let d = self.facets.distribution(half) / (sum * sum);
        self.tint * (d * through * masked * (ci / wi.z.abs()) * (co / wo.z))
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        let zero = T::zero();
        let eta = self.across(wo);
        let (wi, wo) = Self::upright(wi, wo);
        if wi.z * wo.z == zero {
            return zero;
        }
        // What is reflected below the horizon, or refracted above it, is not looked for: its draws weigh nothing.
        if wi.z > zero {
            let half = wi + wo;
            let cos_half = Lanes::min(half.length() * T::of(0.5), T::one());
            let f = fresnel_dielectric(cos_half, eta).average();
            return self.facets.density_over_cosine(wo, half) * f * T::of(0.25);
        }
        let Some((half, sum)) = Self::bend(wi, wo, eta) else { return wi.dot(wo) * zero };
        let (ci, co) = (wi.dot(half).abs(), wo.dot(half).abs());
        let through = Self::through(co, eta);
        let bent = eta / sum;
        self.facets.density_over_cosine(wo, half) * co * through * (bent * bent * ci)
    }
}

impl<T: Real> RoughDielectric<T> {
    /// The draw's direction, and the index on its side over that on the side of `wo`; or the whole draw, where it has no
    /// density or weighs nothing.
    #[inline(always)]
    pub fn directed(&self, wo: Vec3<T>, u: [T; 3]) -> Result<(Vec3<T>, T), Option<Draw<T>>> {
        let (zero, one) = (T::zero(), T::one());
        if !(wo.z.abs() > zero) {
            return Err(None);
        }
        let eta = self.across(wo);
        if eta == one {
            return Err(Some(Draw { wi: -wo, weight: self.tint, pdf: one, specular: true, eta }));
        }
        let side = one.copysign(wo.z);
        let up = wo * side;
        let half = self.facets.sample(up, [u[0], u[1]]);
        let cos_half = up.dot(half);
        if !(cos_half > zero) {
            return Err(Some(Draw::none(wo)));
        }
        let f = fresnel_dielectric(cos_half, eta);
        if u[2] < f.average() {
            let wi = half * (cos_half + cos_half) - up;
            let wi = wi * side;
            return if wi.z * side > zero { Ok((wi, one)) } else { Err(Some(Draw::none(wi))) };
        }
        let wi = (half * (cos_half / eta - f.cos_t) - up * (one / eta)).normalize() * side;
        if wi.z * side < zero { Ok((wi, eta)) } else { Err(Some(Draw::none(wi))) }
    }
}

impl<T: Real> Drawn<T> for RoughDielectric<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        match self.directed(wo, u) {
            Ok((wi, eta)) => Some(weighed(self, wi, wo, eta)),
            Err(draw) => draw,
        }
    }
}
