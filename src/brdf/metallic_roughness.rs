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
use super::model::{Draw, Model, Row, triple, weighed};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
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

impl<T: Real> Material<T> {
    #[inline(always)]
    pub fn lobes(self) -> Lobes<T> {
        let (m, rest) = (self.metallic, T::one() - self.metallic);
        let base_f0 = T::of(DIELECTRIC_F0) * self.specular;
        Lobes {
            diffuse: self.base_color * rest,
            base_f0,
            base_f90: self.specular,
            f0: self.base_color.map(
                #[inline(always)]
                |c| rest * base_f0 + m * c,
            ),
            f90: rest * self.specular + m,
            alpha: Lanes::max(self.roughness * self.roughness, T::of(MIN_ALPHA)),
        }
    }
    /// NaN throughout where a parameter is out of [0, 1].
    #[inline(always)]
    pub fn checked(self) -> Self {
        let Material { base_color: c, metallic, roughness, specular } = self;
        let sum = super::in_unit(c.x) + super::in_unit(c.y) + super::in_unit(c.z);
        let sum = sum + super::in_unit(metallic) + super::in_unit(roughness) + super::in_unit(specular);
        if sum.is_nan() {
            Material { base_color: Vec3::splat(T::NAN), metallic: sum, roughness: sum, specular: sum }
        } else {
            self
        }
    }
}

impl<T: Real> Lobes<T> {
    /// What the dielectric lets through in a direction with this cosine.
    #[inline(always)]
    pub fn transmitted(&self, cos_theta: T) -> T {
        T::one() - (self.base_f0 + (self.base_f90 - self.base_f0) * schlick_weight(cos_theta))
    }
    #[inline(always)]
    pub fn is_specular(&self) -> bool {
        self.f90 > T::zero()
    }
    #[inline(always)]
    pub fn facets(&self) -> Microfacets<T> {
        Microfacets::ggx(self.alpha, Masking::HeightCorrelated)
    }
    /// The reflectance of a mirror at a cosine.
    #[inline(always)]
    pub fn fresnel(&self, cos_half: T) -> Vec3<T> {
        let weight = schlick_weight(Lanes::min(cos_half, T::one()));
        self.f0.map(
            #[inline(always)]
            |f0| f0 + (self.f90 - f0) * weight,
        )
    }
    /// The mirrors' part of the BRDF; both directions above the horizon.
    #[inline(always)]
    pub fn specular(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let (dv, cos_half) = ggx::distribution_and_visibility(wi, wo, self.alpha, Masking::HeightCorrelated);
        self.fresnel(cos_half) * dv
    }
    /// The BRDF in sr⁻¹; zero unless both directions are above the horizon.
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        if super::apart(wi, wo) {
            return Vec3::splat(T::zero());
        }
        let through = self.transmitted(wi.z) * self.transmitted(wo.z) / T::PI;
        self.diffuse * through + self.specular(wi, wo)
    }
    /// The probability of drawing from the mirrors rather than from the cosine lobe, for light leaving along `wo`.
    #[inline(always)]
    pub fn specular_chance(&self, wo: Vec3<T>) -> T {
        let weight = schlick_weight(wo.z);
        let mirrors = largest(self.f0) * (T::one() - weight) + self.f90 * weight;
        let diffuse = largest(self.diffuse) * self.transmitted(wo.z);
        if mirrors > T::zero() { mirrors / (mirrors + diffuse) } else { mirrors }
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
    /// The density of [`Lobes::sample`] per solid angle of `wi`.
    #[inline(always)]
    pub fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        if wo.z <= T::zero() {
            return T::zero();
        }
        let chance = self.specular_chance(wo);
        let mirrors = if chance > T::zero() { ggx::ggx_pdf(wi, wo, self.alpha) } else { T::zero() };
        chance * mirrors + (T::one() - chance) * square_to_cosine_hemisphere_pdf(wi)
    }
}

impl<T: Real> Model<T> for Lobes<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        let [metallic, roughness, specular] = [row[3], row[4], row[5]];
        Material { base_color: triple(row, 0), metallic, roughness, specular }.lobes()
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        Lobes::eval(self, wi, wo)
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        Lobes::pdf(self, wi, wo)
    }
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        if !(wo.z > T::zero()) {
            return None;
        }
        Some(weighed(self, Lobes::sample(self, wo, u), wo, T::one()))
    }
}

#[inline(always)]
fn largest<T: Real>(c: Vec3<T>) -> T {
    Lanes::max(Lanes::max(c.x, c.y), c.z)
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

const PIECE: usize = 1 << 13;

/// [`Lobes::eval`] over arrays of equal length; NaN where a parameter is out of [0, 1].
pub fn metallic_roughness_many<T: Real>(
    watch: &mut dyn Watch,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    materials: Materials<'_, T>,
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (wi, wo, out), PIECE, |first, (wi, wo, out)| {
        dispatch!(_s => {
            for i in 0..out.len() {
                let lobes = materials.at(first + i).checked().lobes();
                out[i] = lobes.eval(wi[i].into(), wo[i].into()).to_array();
            }
        })
    })
}

/// [`Lobes::sample`] over arrays of equal length; NaN where `wo` is below the horizon.
pub fn metallic_roughness_sample_many<T: Real>(
    watch: &mut dyn Watch,
    wo: &[[T; 3]],
    u: &[[T; 3]],
    materials: Materials<'_, T>,
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (wo, u, out), PIECE, |first, (wo, u, out)| {
        dispatch!(_s => {
            for i in 0..out.len() {
                let material = materials.at(first + i).checked();
                let valid = wo[i][2] > T::zero() && !material.metallic.is_nan();
                let wi = material.lobes().sample(wo[i].into(), u[i]);
                out[i] = if valid { wi.to_array() } else { [T::NAN; 3] };
            }
        })
    })
}

/// [`Lobes::pdf`] over arrays of equal length; NaN where a parameter is out of [0, 1].
pub fn metallic_roughness_pdf_many<T: Real>(
    watch: &mut dyn Watch,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    materials: Materials<'_, T>,
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (wi, wo, out), PIECE, |first, (wi, wo, out)| {
        dispatch!(_s => {
            for i in 0..out.len() {
                let material = materials.at(first + i).checked();
                let pdf = material.lobes().pdf(wi[i].into(), wo[i].into());
                out[i] = if material.metallic.is_nan() { T::NAN } else { pdf };
            }
        })
    })
}
