//! Any reflection model, as kernels hold it at a surface point: one of all kinds, copied by value.

use super::compensated_glass::CompensatedGlass;
use super::compensated_lobes::CompensatedLobes;
use super::compensated_principled::CompensatedPrincipled;
use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::kulla_conty::Compensated;
use super::lambert::Diffuse;
use super::metallic_roughness::Lobes;
use super::model::{Draw, Drawn, Model, Row};
use super::oren_nayar::OrenNayar;
use super::phong::Phong;
use super::plastic::Plastic;
use super::principled::Principled;
use super::rough_conductor::RoughConductor;
use super::rough_dielectric::RoughDielectric;
use super::specular_glossiness::SpecularGlossiness;
use crate::real::Real;
use crate::vec::Vec3;

/// Lists the models once: their numbers as the face knows them, and what each method calls. The methods are scalar, and
/// compiled once a precision: inlined, fifteen models times the places that call them were a third of all code.
macro_rules! models {
    ($($number:literal $name:ident($model:ident)),+ $(,)?) => {
        #[derive(Clone, Copy, Debug)]
        pub enum Bsdf<T> {
            $($name($model<T>)),+
        }

        impl<T: Real> Bsdf<T> {
            /// The model of a kind from its row; None for a kind that is not there.
            #[inline(never)]
            pub fn of(kind: i32, row: &Row<T>) -> Option<Self> {
                match kind {
                    $($number => Some(Bsdf::$name($model::of(row))),)+
                    _ => None,
                }
            }
            /// The BSDF in sr⁻¹, without the cosine; what is specular has no value.
            #[inline(never)]
            pub fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
                match self {
                    $(Bsdf::$name(m) => m.eval(wi, wo)),+
                }
            }
            /// The density of [`Bsdf::sample`] per solid angle of `wi`, without specular draws.
            #[inline(never)]
            pub fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
                match self {
                    $(Bsdf::$name(m) => m.pdf(wi, wo)),+
                }
            }
            /// A direction for `wo` from three numbers of [0, 1); None if nothing can come back along `wo`.
            #[inline(never)]
            pub fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
                match self {
                    $(Bsdf::$name(m) => Drawn::sample(m, wo, u)),+
                }
            }
        }
    };
}

models! {
    0 MetallicRoughness(Lobes),
    1 Diffuse(Diffuse),
    2 Conductor(Conductor),
    3 Dielectric(Dielectric),
    4 RoughConductor(RoughConductor),
    5 RoughDielectric(RoughDielectric),
    6 OrenNayar(OrenNayar),
    7 Phong(Phong),
    8 Plastic(Plastic),
    9 SpecularGlossiness(SpecularGlossiness),
    10 Compensated(Compensated),
    11 Principled(Principled),
    12 CompensatedLobes(CompensatedLobes),
    13 CompensatedGlass(CompensatedGlass),
    14 CompensatedPrincipled(CompensatedPrincipled),
}

/// The factors of a microfacet model, f = D F G / (4 cos θi cos θo).
#[derive(Clone, Copy, Debug)]
pub struct Terms<T> {
    /// Unit.
    pub half: Vec3<T>,
    pub distribution: T,
    pub fresnel: Vec3<T>,
    pub masking: T,
}

impl<T: Real> Bsdf<T> {
    /// As [`Bsdf::of`], with the row's colour multiplied by the surface's.
    #[inline(always)]
    pub fn tinted(kind: i32, row: &Row<T>, color: Vec3<T>) -> Option<Self> {
        let mut row = *row;
        (row[0], row[1], row[2]) = (row[0] * color.x, row[1] * color.y, row[2] * color.z);
        Self::of(kind, &row)
    }
    /// Whether light passes: directions then stand on both sides, in a frame whose z points out of the body. Others
    /// are seen from above; callers turn the frame for the two sides of a thin surface.
    #[inline(always)]
    pub fn transmits(&self) -> bool {
        match self {
            Bsdf::Principled(p) => p.through() > T::zero(),
            Bsdf::CompensatedPrincipled(p) => p.once.through() > T::zero(),
            _ => matches!(self, Bsdf::Dielectric(_) | Bsdf::RoughDielectric(_) | Bsdf::CompensatedGlass(_)),
        }
    }
    /// D, F, G and the half vector of models of facets; None of others.
    #[inline(always)]
    pub fn terms(&self, wi: Vec3<T>, wo: Vec3<T>) -> Option<Terms<T>> {
        let half = (wi + wo).normalize();
        let c = wo.dot(half);
        let (facets, fresnel) = match self {
            Bsdf::RoughConductor(m) => (m.facets, m.fresnel(c)),
            Bsdf::Compensated(m) => (m.once.facets, m.once.fresnel(c)),
            Bsdf::RoughDielectric(m) => (m.facets, m.fresnel(c, wo)),
            Bsdf::CompensatedGlass(m) => (m.once.facets, m.once.fresnel(c, wo)),
            Bsdf::CompensatedPrincipled(m) => (m.once.glass.facets, m.once.mirrors(c)),
            Bsdf::Principled(m) => (m.glass.facets, m.mirrors(c)),
            Bsdf::MetallicRoughness(m) => (m.facets(), m.fresnel(c)),
            Bsdf::CompensatedLobes(m) => (m.once.facets(), m.once.fresnel(c)),
            Bsdf::SpecularGlossiness(SpecularGlossiness(m)) => (m.facets(), m.fresnel(c)),
            _ => return None,
        };
        let (zero, same) = (T::zero(), wi.z > T::zero() && wo.z > T::zero());
        let masking = facets.visibility(wi, wo, half) * T::of(4.0) * wi.z * wo.z;
        let masking = if same || half.z.is_nan() { masking } else { zero };
        Some(Terms { half, distribution: facets.distribution(half), fresnel, masking })
    }
    /// Whether every draw is specular, so that light samples are of no use.
    #[inline(always)]
    pub fn is_smooth(&self) -> bool {
        matches!(self, Bsdf::Conductor(_) | Bsdf::Dielectric(_))
    }
}
