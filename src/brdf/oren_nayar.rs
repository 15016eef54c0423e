//! Rough diffusers: facets that are Lambert's themselves, brighter towards the light than a flat one.
//!
//! `Qualitative` is the approximation of the source, σ the deviation of slopes' angles in radians; it loses light as it
//! grows rougher, since facets light each other only once. `EnergyPreserving` takes a roughness of [0, 1] and adds the
//! light of further bounces, so that an albedo of one gives all back.
//!
//! M. Oren, S. K. Nayar, *Generalization of Lambert's reflectance model*, 1994; Y. Fujii, *A tiny improvement of
//! Oren-Nayar reflectance model*; J. Portsmouth, P. Kutz, S. Hill, *EON: a practical energy-preserving rough diffuse
//! BRDF*, 2025.

use super::lambert::{cosine_pdf, cosine_sample};
use super::model::{Draw, Drawn, Model, Row, triple};
use crate::math;
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct OrenNayar<T> {
    pub albedo: Vec3<T>,
    /// σ, or the roughness.
    pub sigma: T,
    pub energy_preserving: bool,
}

impl<T: Real> OrenNayar<T> {
    /// cos φ sin θi sin θo: the part of wi·wo across the normal.
    #[inline(always)]
    fn across(wi: Vec3<T>, wo: Vec3<T>) -> T {
        wi.x * wo.x + wi.y * wo.y
    }

    #[inline(always)]
    fn qualitative(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let s2 = self.sigma * self.sigma;
        let a = T::one() - T::of(0.5) * s2 / (s2 + T::of(0.33));
        let b = T::of(0.45) * s2 / (s2 + T::of(0.09));
        // max(0, cos φ) sin α tan β, with tan β = sin β / cos β of the direction nearer the normal: its cosine is the larger.
        let s = Lanes::max(Self::across(wi, wo), T::zero());
        self.albedo * ((a + b * s / Lanes::max(wi.z, wo.z)) / T::PI)
    }

    /// What one bounce gives back of light from a direction, and on the average, of an albedo of one.
    #[inline(always)]
    fn given_back(&self, w: Vec3<T>, scale: T) -> T {
        let (one, two_thirds) = (T::one(), T::of(2.0 / 3.0));
        let sine = Lanes::min((w.x * w.x + w.y * w.y).sqrt(), one);
        let c = w.z;
        // 1 − s³ over c, without the difference.
        let rest = c * (one + sine + sine * sine) / (one + sine);
        let g = sine * (math::atan2(sine, c) - sine * c) + two_thirds * sine * (rest - one);
        scale * (one + self.sigma * g / T::PI)
    }

    #[inline(always)]
    fn preserving(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let (zero, one, pi) = (T::zero(), T::one(), T::PI);
        let scale = one / (one + T::of(0.5 - 2.0 / (3.0 * std::f64::consts::PI)) * self.sigma);
        let s = Self::across(wi, wo);
        let t = if s > zero { Lanes::max(wi.z, wo.z) } else { one };
        let once = scale * (one + self.sigma * s / t) / pi;
        let lost = one - scale * (one + T::of(2.0 / 3.0 - 28.0 / (15.0 * std::f64::consts::PI)) * self.sigma);
        if !(lost > zero) {
            return self.albedo * (once + lost * zero);
        }
        let (li, lo) = (one - self.given_back(wi, scale), one - self.given_back(wo, scale));
        let shape = li * lo / (lost * pi);
        self.albedo.map(
            #[inline(always)]
            |a| a * once + a * a * (one - lost) / (one - a * lost) * shape,
        )
    }
}

impl<T: Real> Model<T> for OrenNayar<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        OrenNayar { albedo: triple(row, 0), sigma: row[3], energy_preserving: row[4] > T::of(0.5) }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        if super::apart(wi, wo) {
            Vec3::splat(T::zero())
        } else if self.energy_preserving {
            self.preserving(wi, wo)
        } else {
            self.qualitative(wi, wo)
        }
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        cosine_pdf(wi, wo)
    }
}

impl<T: Real> Drawn<T> for OrenNayar<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        cosine_sample(self, wo, u)
    }
}
