//! The artist's model of film with the light that its mirrors and its glass lose between facets.
//!
//! Of the three that share the facets each gets back what it alone would miss: metal and dielectric mirrors as
//! [`super::kulla_conty`] does it, by their average reflectances, glass as [`super::compensated_glass`]. `Scaled`
//! multiplies each one's single bounce instead. Nothing else of the model changes: what its diffuser, its sheen and its
//! coat give back beyond what came stays.

use super::compensated_glass::Missing;
use super::kulla_conty::{Albedo, Form, Slice, missing};
use super::microfacets::{Masking, Shape};
use super::model::{Draw, Drawn, Model, Row, weighed};
use super::principled::Principled;
use crate::math::exact::largest;
use crate::real::{Lanes, Real};
use crate::sampling::cosine_hemisphere::square_to_cosine_hemisphere;
use crate::sampling::disk::Method;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct CompensatedPrincipled<T> {
    pub once: Principled<T>,
    form: Form,
    slice: Slice<'static>,
    /// Of the mirrors' added lobe.
    color: Vec3<T>,
    glass: Option<Missing<T>>,
}

/// The chances of the mirrors' added lobe, and of the glass's.
type Chances<T> = [T; 2];

impl<T: Real> CompensatedPrincipled<T> {
    /// What mirrors of a reflectance of one miss; nothing from below.
    #[inline(always)]
    fn lost(&self, wo: Vec3<T>) -> T {
        if wo.z > T::zero() { T::of((1.0 - self.slice.at(wo.z.to_f64())).max(0.0)) } else { T::zero() }
    }
    #[inline(always)]
    fn lost_in_glass(&self, wo: Vec3<T>) -> T {
        match &self.glass {
            Some(glass) => glass.at(wo.z),
            None => T::zero(),
        }
    }
    /// By the part of about what comes back.
    #[inline(always)]
    fn chances(&self, wo: Vec3<T>) -> Chances<T> {
        let (zero, one) = (T::zero(), T::one());
        if self.form == Form::Scaled {
            return [zero; 2];
        }
        let (lost, in_glass, through) = (self.lost(wo), self.lost_in_glass(wo), self.once.through());
        let (mirrors, glass) = (lost * largest(self.color), in_glass * through);
        let [body, shine, coat, clear] = self.once.parts(wo);
        let clear = if wo.z < zero { through } else { clear };
        let others = body + shine * (one - lost) + coat + clear * (one - in_glass);
        let sum = mirrors + glass + others;
        let scale = if sum > zero { one / sum } else { zero };
        [mirrors * scale, glass * scale]
    }
    /// Directions above the horizon: what scaling adds to the mirrors.
    #[inline(always)]
    fn scaled(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let (one, half, p) = (T::one(), wi + wo, &self.once);
        let cos_half = Lanes::min(half.length() * T::of(0.5), one);
        let more = T::of(1.0 / self.slice.at(wo.z.to_f64()) - 1.0);
        let through = p.through();
        let clear = if p.later { one - p.spec_trans } else { one };
        let [dielectric, metal] = p.two_mirrors(cos_half);
        let [normal, _] = p.two_mirrors(one);
        let in_glass = self.lost_in_glass(wo);
        let glass = through * in_glass / (one - in_glass);
        let opaque = (one - p.metallic) * clear;
        let dielectric = dielectric.zip(
            normal,
            #[inline(always)]
            |f, f0| f * (opaque * f0 * more + glass),
        );
        let facets = &p.glass.facets;
        let shape = facets.distribution(half) * facets.visibility(wi, wo, half);
        (dielectric + metal.times(p.base) * (p.metallic * more)) * shape
    }
}

impl<T: Real> Model<T> for CompensatedPrincipled<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        let (one, part) = (T::one(), T::one() / T::of(21.0));
        let once = Principled::of(row);
        let (form, passes, grazing) = (Form::of(row[16]), row[17], row[18]);
        let facets = &once.glass.facets;
        let slice = Albedo::of(Shape::Ggx, Masking::Separable).width(facets.mean_width());
        let through = once.through();
        let eta = once.glass.eta;
        let glass = if through > T::zero() { Missing::of(facets, eta, passes) } else { None };
        let average = T::of(slice.average());
        let clear = if once.later { one - once.spec_trans } else { one };
        let opaque = (one - once.metallic) * clear;
        // Fresnel's average of the index; Schlick's is that along the normal and a part of the rest.
        let reflected = if eta < one { one - passes * eta * eta } else { one - passes };
        let dielectric = once.tint().map(
            #[inline(always)]
            |t| {
                let later = t * reflected + (one - t) * grazing;
                let f0 = once.specular * T::of(0.08) * t;
                // Hues of dark colours are above one.
                Lanes::min(if once.later { later } else { f0 + (one - f0) * part }, one)
            },
        );
        let color = dielectric.zip(
            once.base,
            #[inline(always)]
            |d, c| {
                let metal = form.color(c + (one - c) * part, average);
                opaque * form.color(d, average) + once.metallic * metal
            },
        );
        CompensatedPrincipled { once, form, slice, color, glass }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let (zero, one) = (T::zero(), T::one());
        let once = self.once.eval(wi, wo);
        let cross = wi.z * wo.z;
        if cross == zero {
            return once;
        }
        let above = wi.z > zero && wo.z > zero;
        if self.form == Form::Scaled {
            return if above {
                once + self.scaled(wi, wo)
            } else {
                once * (one / (one - self.lost_in_glass(wo)))
            };
        }
        let mirrors = if above { self.color * missing(&self.slice, wi, wo) } else { Vec3::splat(zero) };
        let Some(glass) = &self.glass else { return once + mirrors };
        let lobe = glass.lobe(wi, wo) * self.once.through();
        let tint = if cross < zero { self.once.glass.tint } else { Vec3::splat(one) };
        once + mirrors + tint * lobe
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        let (zero, one) = (T::zero(), T::one());
        let once = self.once.pdf(wi, wo);
        if wi.z * wo.z == zero {
            return once;
        }
        let [mirrors, in_glass] = self.chances(wo);
        let above = wi.z > zero && wo.z > zero;
        let off = if above { mirrors * wi.z / T::PI } else { zero };
        let glass = match &self.glass {
            Some(glass) => in_glass * glass.pdf(wi, wo),
            None => zero,
        };
        (one - mirrors - in_glass) * once + off + glass
    }
}

impl<T: Real> Drawn<T> for CompensatedPrincipled<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        let one = T::one();
        let [mirrors, in_glass] = self.chances(wo);
        let added = mirrors + in_glass;
        let found = if u[2] < added {
            let (wi, crosses) = match &self.glass {
                Some(glass) if u[2] >= mirrors => {
                    glass.directed(wo, [u[0], u[1], (u[2] - mirrors) / in_glass])
                }
                _ => (square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric), false),
            };
            Ok((wi, if crosses { self.once.glass.across(wo) } else { one }))
        } else {
            let rest = Lanes::min((u[2] - added) / (one - added), one - T::EPSILON);
            self.once.directed(wo, [u[0], u[1], rest])
        };
        match found {
            Ok((wi, eta)) => Some(weighed(self, wi, wo, eta)),
            // Straight through.
            Err(Some(draw)) if draw.specular => {
                let chance = one - added;
                Some(Draw { weight: draw.weight * (one / chance), pdf: draw.pdf * chance, ..draw })
            }
            Err(draw) => draw,
        }
    }
}
