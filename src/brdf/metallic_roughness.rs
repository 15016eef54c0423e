//! The material of real-time rendering: a mix of metal and of a dielectric base, by glTF's parameters.
//!
//! f = (1 − metallic) · (diffuse + dielectric mirrors) + metallic · metal mirrors. Mirrors are [`super::ggx`] of width
//! alpha = roughness² under Schlick's Fresnel; a metal reflects `base_color` at normal incidence, a dielectric 4 %
//! times `specular`. What the dielectric lets in comes out diffuse: base/π · (1 − F(cos θi)) (1 − F(cos θo)), which is
//! reciprocal and never gives back more than came (glTF's own factor 1 − F(wo·h) does, at grazing angles). With
//! `specular` 0 the dielectric is Lambert's diffuser. Widths below 10⁻⁴ are raised to it: there are no perfect mirrors.
//!
//! Khronos, *glTF 2.0 specification*, 2021, appendix B, and KHR_materials_specular; P. Shirley, B. Smits, H. Hu,
//! E. Lafortune, *A practitioners' assessment of light reflection models*, 1997 (the diffuse factor).

use super::fresnel::schlick_weight;
use super::ggx::{self, Masking};
use super::microfacets::Microfacets;
use super::model::{Draw, Drawn, Model, Row, triple, weighed};
use crate::real::{Lanes, Real};
use crate::sampling::cosine_hemisphere::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};
use crate::sampling::disk::Method;
use crate::vec::Vec3;

/// Reflectance of a dielectric of index 1.5 at normal incidence.
pub const DIELECTRIC_F0: f64 = 0.04;
/// The narrowest GGX that materials have.
pub const MIN_ALPHA: f64 = 1e-4;

/// The parameters as artists give them, all in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material<T> {
    pub base_color: Vec3<T>,
    pub metallic: T,
    pub roughness: T,
    pub specular: T,
}

/// What evaluation needs of a [`Material`], worked out once a surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobes<T> {
    /// Albedo of the diffuse part before Fresnel's factors.
    pub diffuse: Vec3<T>,
    /// Dielectric reflectance at normal incidence and at grazing.
    pub base_f0: T,
    pub base_f90: T,
    /// The mixed mirrors' reflectance at normal incidence and at grazing.
    pub f0: Vec3<T>,
    pub f90: T,
    pub alpha: T,
}

impl<V: Lanes> Material<V> {
    #[inline(always)]
    pub fn lobes(self) -> Lobes<V> {
        let m = self.metallic;
        let rest = m.num(1.0) - m;
        let base_f0 = m.num(DIELECTRIC_F0) * self.specular;
        Lobes {
            diffuse: self.base_color * rest,
            base_f0,
            base_f90: self.specular,
            f0: self.base_color.map(
                #[inline(always)]
                |c| rest * base_f0 + m * c,
            ),
            f90: rest * self.specular + m,
            alpha: (self.roughness * self.roughness).max(m.num(MIN_ALPHA)),
        }
    }
    /// NaN throughout where a parameter is out of [0, 1].
    #[inline(always)]
    pub fn checked(self) -> Self {
        let Material { base_color: c, metallic, roughness, specular } = self;
        let sum = super::in_unit(c.x) + super::in_unit(c.y) + super::in_unit(c.z);
        let sum = sum + super::in_unit(metallic) + super::in_unit(roughness) + super::in_unit(specular);
        let (good, nan) = (sum.equal(sum), sum.like(V::Elem::NAN));
        Material {
            base_color: c.map(
                #[inline(always)]
                |c| V::select(good, c, nan),
            ),
            metallic: V::select(good, metallic, nan),
            roughness: V::select(good, roughness, nan),
            specular: V::select(good, specular, nan),
        }
    }
}

impl<V: Lanes> Lobes<V> {
    /// What the dielectric lets through in a direction with this cosine.
    #[inline(always)]
    pub fn transmitted(&self, cos_theta: V) -> V {
        cos_theta.num(1.0) - (self.base_f0 + (self.base_f90 - self.base_f0) * schlick_weight(cos_theta))
    }
    #[inline(always)]
    pub fn facets(&self) -> Microfacets<V> {
        Microfacets::ggx(self.alpha, Masking::HeightCorrelated)
    }
    /// The reflectance of a mirror at a cosine.
    #[inline(always)]
    pub fn fresnel(&self, cos_half: V) -> Vec3<V> {
        let weight = schlick_weight(cos_half.min(cos_half.num(1.0)));
        self.f0.map(
            #[inline(always)]
            |f0| f0 + (self.f90 - f0) * weight,
        )
    }
    /// The mirrors' part of the BRDF; both directions above the horizon.
    #[inline(always)]
    pub fn specular(&self, wi: Vec3<V>, wo: Vec3<V>) -> Vec3<V> {
        let (dv, cos_half) = ggx::distribution_and_visibility(wi, wo, self.alpha, Masking::HeightCorrelated);
        self.fresnel(cos_half) * dv
    }
    /// The BRDF in sr⁻¹; zero unless both directions are above the horizon.
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<V>, wo: Vec3<V>) -> Vec3<V> {
        let pi = wi.z.num(std::f64::consts::PI);
        let through = self.transmitted(wi.z) * self.transmitted(wo.z) / pi;
        super::above(wi, wo, self.diffuse * through + self.specular(wi, wo))
    }
    /// The probability of drawing from the mirrors rather than from the cosine lobe, for light leaving along `wo`.
    #[inline(always)]
    pub fn specular_chance(&self, wo: Vec3<V>) -> V {
        let (zero, one, weight) = (wo.z.num(0.0), wo.z.num(1.0), schlick_weight(wo.z));
        let mirrors = largest(self.f0) * (one - weight) + self.f90 * weight;
        let diffuse = largest(self.diffuse) * self.transmitted(wo.z);
        V::select(zero.less(mirrors), mirrors / (mirrors + diffuse), mirrors)
    }
    /// A direction `wi` for `wo` above the horizon, from three numbers of [0, 1); may lie below the horizon. Both parts
    /// are worked out: for lanes.
    #[inline(always)]
    pub fn sample_of_both(&self, wo: Vec3<V>, u: [V; 3]) -> Vec3<V> {
        let mirrors = u[2].less(self.specular_chance(wo));
        let cosine = square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric);
        ggx::ggx_sample(wo, [u[0], u[1]], self.alpha).zip(
            cosine,
            #[inline(always)]
            |a, b| V::select(mirrors, a, b),
        )
    }
    /// The density of [`Lobes::sample`] per solid angle of `wi`.
    #[inline(always)]
    pub fn pdf(&self, wi: Vec3<V>, wo: Vec3<V>) -> V {
        let (zero, one) = (wo.z.num(0.0), wo.z.num(1.0));
        let chance = self.specular_chance(wo);
        let mirrors = V::select(zero.less(chance), ggx::ggx_pdf(wi, wo, self.alpha), zero);
        let pdf = chance * mirrors + (one - chance) * square_to_cosine_hemisphere_pdf(wi);
        V::select(wo.z.less_eq(zero), zero, pdf)
    }
}

impl<T: Real> Lobes<T> {
    #[inline(always)]
    pub fn is_specular(&self) -> bool {
        self.f90 > T::zero()
    }
    /// A direction `wi` for `wo` above the horizon, from three numbers of [0, 1); may lie below the horizon.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Vec3<T> {
        if u[2] < self.specular_chance(wo) {
            ggx::ggx_sample(wo, [u[0], u[1]], self.alpha)
        } else {
            square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric)
        }
    }
}

impl<V: Lanes> Model<V> for Lobes<V> {
    #[inline(always)]
    fn of(row: &Row<V>) -> Self {
        let [metallic, roughness, specular] = [row[3], row[4], row[5]];
        Material { base_color: triple(row, 0), metallic, roughness, specular }.lobes()
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<V>, wo: Vec3<V>) -> Vec3<V> {
        Lobes::eval(self, wi, wo)
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<V>, wo: Vec3<V>) -> V {
        Lobes::pdf(self, wi, wo)
    }
}

impl<T: Real> Drawn<T> for Lobes<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        if !(wo.z > T::zero()) {
            return None;
        }
        Some(weighed(self, Lobes::sample(self, wo, u), wo, T::one()))
    }
}

#[inline(always)]
fn largest<V: Lanes>(c: Vec3<V>) -> V {
    c.x.max(c.y).max(c.z)
}

/// Material parameters as arrays of equal length.
#[derive(Clone, Copy)]
pub struct Materials<'a, T> {
    pub base_color: &'a [[T; 3]],
    pub metallic: &'a [T],
    pub roughness: &'a [T],
    pub specular: &'a [T],
}

impl<T: Real> Materials<'_, T> {
    #[inline(always)]
    pub fn at(&self, i: usize) -> Material<T> {
        Material {
            base_color: self.base_color[i].into(),
            metallic: self.metallic[i],
            roughness: self.roughness[i],
            specular: self.specular[i],
        }
    }
}
