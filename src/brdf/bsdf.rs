//! Any reflection model, as kernels hold it at a surface point: one of all kinds, copied by value.

use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::lambert::Diffuse;
use super::metallic_roughness::Lobes;
use super::model::{Draw, Model, Row};
use super::rough_conductor::RoughConductor;
use super::rough_dielectric::RoughDielectric;
use crate::real::Real;
use crate::vec::Vec3;

/// Lists the models once: their numbers as the face knows them, and what each method calls.
macro_rules! models {
    ($($number:literal $name:ident($model:ident)),+ $(,)?) => {
        #[derive(Clone, Copy, Debug)]
        pub enum Bsdf<T> {
            $($name($model<T>)),+
        }

        impl<T: Real> Bsdf<T> {
            /// The model of a kind from its row; None for a kind that is not there.
            #[inline(always)]
            pub fn of(kind: i32, row: &Row<T>) -> Option<Self> {
                match kind {
                    $($number => Some(Bsdf::$name($model::of(row))),)+
                    _ => None,
                }
            }
            /// The BSDF in sr⁻¹, without the cosine; what is specular has no value.
            #[inline(always)]
            pub fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
                match self {
                    $(Bsdf::$name(m) => m.eval(wi, wo)),+
                }
            }
            /// The density of [`Bsdf::sample`] per solid angle of `wi`, without specular draws.
            #[inline(always)]
            pub fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
                match self {
                    $(Bsdf::$name(m) => m.pdf(wi, wo)),+
                }
            }
            /// A direction for `wo` from three numbers of [0, 1); None if nothing can come back along `wo`.
            #[inline(always)]
            pub fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
                match self {
                    $(Bsdf::$name(m) => Model::sample(m, wo, u)),+
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
        matches!(self, Bsdf::Dielectric(_) | Bsdf::RoughDielectric(_))
    }
    /// Whether every draw is specular, so that light samples are of no use.
    #[inline(always)]
    pub fn is_smooth(&self) -> bool {
        matches!(self, Bsdf::Conductor(_) | Bsdf::Dielectric(_))
    }
}
