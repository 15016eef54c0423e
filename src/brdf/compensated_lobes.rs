//! The material of real-time rendering with the light of its mirrors' further bounces.
//!
//! As [`super::kulla_conty`] gives it to rough metal: a lobe of the same shape, coloured by the average of Schlick's
//! reflectance, F0 + (F90 − F0) / 21, of metal and dielectric mixed; or the mirrors' own lobe times 1 + F0 (1/E − 1). Of
//! what a dielectric lets in nothing is lost between facets: it is the diffuser's.
//!
//! C. Kulla, A. Conty, *Revisiting physically based shading at Imageworks*, 2017; E. Turquin, *Practical multiple
//! scattering compensation for microfacet models*, 2019.

use super::ggx::Masking;
use super::kulla_conty::{Albedo, Form, Slice, missing};
use super::metallic_roughness::Lobes;
use super::microfacets::Shape;
use super::model::{Draw, Drawn, Model, Row, weighed};
use crate::math::exact::largest;
use crate::real::Real;
use crate::sampling::cosine_hemisphere::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};
use crate::sampling::disk::Method;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct CompensatedLobes<T> {
    pub once: Lobes<T>,
    form: Form,
    slice: Slice<'static>,
    /// Of the added lobe.
    color: Vec3<T>,
}

impl<T: Real> CompensatedLobes<T> {
    /// The chance of drawing from the added lobe: its part of about what comes back.
    #[inline(always)]
    fn chance(&self, wo: Vec3<T>) -> T {
        if self.form == Form::Scaled {
            return T::zero();
        }
        let once = T::of(self.slice.at(wo.z.to_f64()));
        let added = (T::one() - once) * largest(self.color);
        let others = once * largest(self.once.fresnel(wo.z))
            + largest(self.once.diffuse) * self.once.transmitted(wo.z);
        if added > T::zero() { added / (added + others) } else { T::zero() }
    }
}

impl<T: Real> Model<T> for CompensatedLobes<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        let once = <Lobes<T> as Model<T>>::of(row);
        let form = Form::of(row[6]);
        let slice = Albedo::of(Shape::Ggx, Masking::HeightCorrelated).width(once.alpha);
        let average = T::of(slice.average());
        let color = once.f0.map(
            #[inline(always)]
            |f0| form.color(f0 + (once.f90 - f0) / T::of(21.0), average),
        );
        CompensatedLobes { once, form, slice, color }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let value = Lobes::eval(&self.once, wi, wo);
        if super::apart(wi, wo) {
            return value;
        }
        if self.form == Form::Scaled {
            let more = T::of(1.0 / self.slice.at(wo.z.to_f64()) - 1.0);
            return value + self.once.specular(wi, wo).times(self.once.f0) * more;
        }
        value + self.color * missing(&self.slice, wi, wo)
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        if wo.z <= T::zero() {
            return T::zero();
        }
        let chance = self.chance(wo);
        (T::one() - chance) * Lobes::pdf(&self.once, wi, wo) + chance * square_to_cosine_hemisphere_pdf(wi)
    }
}

impl<T: Real> Drawn<T> for CompensatedLobes<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        if !(wo.z > T::zero()) {
            return None;
        }
        let chance = self.chance(wo);
        let wi = if u[2] < chance {
            square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric)
        } else {
            let rest = (u[2] - chance) / (T::one() - chance);
            Lobes::sample(&self.once, wo, [u[0], u[1], rest])
        };
        Some(weighed(self, wi, wo, T::one()))
    }
}
