//! The artist's model of film: one set of parameters of [0, 1] from cloth to car paint, metal and glass.
//!
//! `Form::Y2012` is the BRDF as its appendix lists it: a diffuser with a retro-reflective term of the roughness, an
//! approximate subsurface form, sheen, anisotropic GGX with Smith's separable masking, and a clear coat of GTR of γ = 1.
//! `Form::Y2015` has the diffuser of the later notes (Lambert's under Schlick's Fresnel, and the retro-reflection apart),
//! exact Fresnel of the index for the dielectric part, and glass: `spec_trans` mixes in rough refraction, tinted by the
//! root of the base colour. Neither conserves energy strictly; at grazing angles 2012 gives back more than came.
//!
//! B. Burley, *Physically based shading at Disney*, 2012; B. Burley, *Extending the Disney BRDF to a BSDF with integrated
//! subsurface scattering*, 2015.

use super::fresnel::{fresnel_dielectric, schlick_weight};
use super::microfacets::{Masking, Microfacets, Shape};
use super::model::{Draw, Drawn, Model, Row, triple, weighed};
use super::ndf::{gtr, gtr1_sample};
use super::rough_dielectric::RoughDielectric;
use crate::math::exact::largest;
use crate::real::{Lanes, Real};
use crate::sampling::cosine_hemisphere::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};
use crate::sampling::disk::Method;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Principled<T> {
    pub base: Vec3<T>,
    pub metallic: T,
    pub roughness: T,
    pub specular: T,
    pub specular_tint: T,
    pub sheen: T,
    pub sheen_tint: T,
    pub clearcoat: T,
    pub coat_alpha: T,
    pub subsurface: T,
    pub spec_trans: T,
    pub later: bool,
    pub glass: RoughDielectric<T>,
}

#[inline(always)]
fn mix<T: Real>(a: T, b: T, t: T) -> T {
    a + (b - a) * t
}

impl<T: Real> Principled<T> {
    /// The hue: the base colour at a luminance of one.
    #[inline(always)]
    fn hue(&self) -> Vec3<T> {
        let c = self.base;
        let bright = T::of(0.3) * c.x + T::of(0.6) * c.y + T::of(0.1) * c.z;
        if bright > T::zero() { c * (T::one() / bright) } else { Vec3::splat(T::one()) + c * T::zero() }
    }
    /// The tint of the dielectric's mirrors.
    #[inline(always)]
    pub fn tint(&self) -> Vec3<T> {
        self.hue().map(
            #[inline(always)]
            |h| mix(T::one(), h, self.specular_tint),
        )
    }
    /// What the dielectric's mirrors reflect, and the metal's.
    #[inline(always)]
    pub fn two_mirrors(&self, cos_half: T) -> [Vec3<T>; 2] {
        let (one, weight) = (T::one(), schlick_weight(cos_half));
        let f = if self.later { fresnel_dielectric(cos_half, self.glass.eta).average() } else { one };
        let strength = self.specular * T::of(0.08);
        let dielectric = self.tint().map(
            #[inline(always)]
            |t| if self.later { mix(t, one, weight) * f } else { mix(strength * t, one, weight) },
        );
        let metal = self.base.map(
            #[inline(always)]
            |c| mix(c, one, weight),
        );
        [dielectric, metal]
    }
    /// The mirrors' colour along the normal, of 2012; of 2015 the metal's part and the tint of the dielectric's.
    #[inline(always)]
    pub fn mirrors(&self, cos_half: T) -> Vec3<T> {
        let (one, weight) = (T::one(), schlick_weight(cos_half));
        if self.later {
            let [dielectric, metal] = self.two_mirrors(cos_half);
            return dielectric.zip(
                metal,
                #[inline(always)]
                |d, m| mix(d, m, self.metallic),
            );
        }
        self.tint().zip(
            self.base,
            #[inline(always)]
            |t, c| {
                let f0 = mix(self.specular * T::of(0.08) * t, c, self.metallic);
                mix(f0, one, weight)
            },
        )
    }
    /// The diffuser with sheen, both directions above the horizon.
    #[inline(always)]
    fn body(&self, wi: Vec3<T>, wo: Vec3<T>, cos_half: T) -> Vec3<T> {
        let (one, half) = (T::one(), T::of(0.5));
        let (fi, fo, fh) = (schlick_weight(wi.z), schlick_weight(wo.z), schlick_weight(cos_half));
        let turned = cos_half * cos_half * self.roughness;
        let retro = turned + turned;
        let diffuse = if self.later {
            (one - half * fi) * (one - half * fo) + retro * (fi + fo + fi * fo * (retro - one))
        } else {
            let f90 = half + retro;
            mix(one, f90, fi) * mix(one, f90, fo)
        };
        let flat = mix(one, turned, fi) * mix(one, turned, fo);
        let under = T::of(1.25) * (flat * (one / (wi.z + wo.z) - half) + half);
        let diffuse = mix(diffuse, under, self.subsurface) / T::PI;
        self.base.zip(
            self.hue(),
            #[inline(always)]
            |c, h| c * diffuse + fh * self.sheen * mix(one, h, self.sheen_tint),
        )
    }
    /// The coat: a distribution of long tails, narrow masking of a fixed width.
    #[inline(always)]
    fn coat(&self, wi: Vec3<T>, wo: Vec3<T>, half: Vec3<T>, cos_half: T) -> T {
        let smooth = Microfacets::ggx(T::of(0.25), Masking::Separable);
        let fresnel = mix(T::of(0.04), T::one(), schlick_weight(cos_half));
        // At full strength a quarter of a lobe, as the source has it.
        let v = T::of(0.25) * smooth.visibility(wi, wo, half);
        self.clearcoat * gtr(half, self.coat_alpha, T::one()) * fresnel * v
    }
    /// About what the diffuser, the mirrors, the coat and the glass give back.
    #[inline(always)]
    pub fn parts(&self, wo: Vec3<T>) -> [T; 4] {
        let (zero, one) = (T::zero(), T::one());
        let rest = one - self.metallic;
        let glass = self.through();
        if wo.z < zero {
            return [zero, zero, zero, if glass > zero { one } else { zero }];
        }
        let shine = largest(self.mirrors(wo.z));
        let body = largest(self.base) * rest * (one - glass);
        let coat = T::of(0.25) * self.clearcoat * mix(T::of(0.04), one, schlick_weight(wo.z));
        // Facets let light pass where the flat interface lets none.
        let glass = glass * (one - shine * T::of(0.5));
        [body, shine, coat, glass]
    }
    /// Chances of drawing from each of them.
    #[inline(always)]
    fn chances(&self, wo: Vec3<T>) -> [T; 4] {
        let [body, shine, coat, glass] = self.parts(wo);
        let sum = body + shine + coat + glass;
        let scale = if sum > T::zero() { T::one() / sum } else { T::zero() };
        [body * scale, shine * scale, coat * scale, glass * scale]
    }
}

impl<T: Real> Model<T> for Principled<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        let one = T::one();
        let base = triple(row, 0);
        let (roughness, least) = (row[4], T::of(1e-3));
        let aspect = (one - row[7] * T::of(0.9)).sqrt();
        let squared = roughness * roughness;
        let (ax, ay) = (Lanes::max(squared / aspect, least), Lanes::max(squared * aspect, least));
        let facets = Microfacets {
            alpha_x: ax,
            alpha_y: ay,
            ratio: [ay / ax, ax / ay],
            shape: Shape::Ggx,
            masking: Masking::Separable,
        };
        Principled {
            base,
            metallic: row[3],
            roughness,
            specular: row[5],
            specular_tint: row[6],
            sheen: row[8],
            sheen_tint: row[9],
            clearcoat: row[10],
            coat_alpha: mix(T::of(0.1), least, row[11]),
            subsurface: row[12],
            spec_trans: row[13],
            later: row[15] > T::of(0.5),
            glass: RoughDielectric {
                tint: base.map(
                    #[inline(always)]
                    |c| c.sqrt(),
                ),
                eta: row[14],
                facets,
            },
        }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let (zero, one) = (T::zero(), T::one());
        let none = Vec3::splat(zero);
        let clear = if self.later { one - self.spec_trans } else { one };
        let through = self.through();
        if wi.z * wo.z < zero || wo.z < zero {
            // From below, glass is seen alone; what it reflects there is of the glass too.
            return if through > zero { self.glass.eval(wi, wo) * through } else { none };
        }
        if super::apart(wi, wo) {
            return none;
        }
        let sum = wi + wo;
        let length = sum.length();
        let half = sum * (one / length);
        let cos_half = Lanes::min(length * T::of(0.5), one);
        let facets = &self.glass.facets;
        let mirrors = self.mirrors(cos_half) * (facets.distribution(sum) * facets.visibility(wi, wo, sum));
        let body = self.body(wi, wo, cos_half) * ((one - self.metallic) * clear);
        let coat = if self.clearcoat > zero { self.coat(wi, wo, half, cos_half) } else { zero };
        body + mirrors + Vec3::splat(coat)
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        let zero = T::zero();
        let [body, shine, coat, glass] = self.chances(wo);
        if wi.z * wo.z < zero || wo.z < zero {
            let through = if glass > zero { glass * self.glass.pdf(wi, wo) } else { zero };
            // What mirrors send below the horizon is drawn as well.
            return if wo.z < zero { through } else { through + self.mirrored(wi, wo, shine, coat) };
        }
        if wo.z <= zero {
            return zero;
        }
        let through = if glass > zero { glass * self.glass.pdf(wi, wo) } else { zero };
        body * square_to_cosine_hemisphere_pdf(wi) + self.mirrored(wi, wo, shine, coat) + through
    }
}

impl<T: Real> Principled<T> {
    /// The share of glass.
    #[inline(always)]
    pub fn through(&self) -> T {
        if self.later { (T::one() - self.metallic) * self.spec_trans } else { T::zero() }
    }
    /// As [`RoughDielectric::directed`].
    #[inline(always)]
    pub fn directed(&self, wo: Vec3<T>, u: [T; 3]) -> Result<(Vec3<T>, T), Option<Draw<T>>> {
        let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
        let [body, shine, coat, glass] = self.chances(wo);
        if !(wo.z > zero) && !(glass > zero) {
            return Err(None);
        }
        let mirrored = |half: Vec3<T>| half * (two * wo.dot(half)) - wo;
        let pair = [u[0], u[1]];
        let wi = if u[2] < body {
            square_to_cosine_hemisphere(pair, Method::Concentric)
        } else if u[2] < body + shine {
            mirrored(self.glass.facets.sample(wo, pair))
        } else if u[2] < body + shine + coat {
            let half = gtr1_sample(pair, self.coat_alpha);
            if !(wo.dot(half) > zero) {
                // A facet that looks away: what it would send below the horizon is no light of the glass.
                return Err(Some(Draw::none(mirrored(half))));
            }
            mirrored(half)
        } else if glass > zero {
            let first = body + shine + coat;
            let choice = Lanes::min((u[2] - first) / glass, one - T::EPSILON);
            let (wi, eta) = match self.glass.directed(wo, [u[0], u[1], choice]) {
                Ok(found) => found,
                Err(Some(draw)) if draw.specular => {
                    let through = self.through();
                    let weight = draw.weight * (through / glass);
                    return Err(Some(Draw { weight, pdf: draw.pdf * glass, ..draw }));
                }
                Err(draw) => return Err(draw),
            };
            if !(self.glass.pdf(wi, wo) > zero) {
                return Err(Some(Draw { eta, ..Draw::none(wi) }));
            }
            wi
        } else {
            square_to_cosine_hemisphere(pair, Method::Concentric)
        };
        // Mirrors as well may send a draw to where glass lets light pass.
        let crosses = glass > zero && wi.z * wo.z < zero;
        Ok((wi, if crosses { self.glass.across(wo) } else { one }))
    }
}

impl<T: Real> Drawn<T> for Principled<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        match self.directed(wo, u) {
            Ok((wi, eta)) => Some(weighed(self, wi, wo, eta)),
            Err(draw) => draw,
        }
    }
}

impl<T: Real> Principled<T> {
    /// The density of directions that mirrors and coat send light in, the horizon or not, for `wo` above it.
    #[inline(always)]
    fn mirrored(&self, wi: Vec3<T>, wo: Vec3<T>, shine: T, coat: T) -> T {
        let (zero, quarter) = (T::zero(), T::of(0.25));
        let half = wi + wo;
        if half.z <= zero {
            return zero;
        }
        let unit = half.normalize();
        // Against the beam rounding alone decides on the half vector and its cosine.
        let cos_half = wo.dot(unit);
        let coated = if coat > zero && cos_half > zero {
            coat * quarter * gtr(unit, self.coat_alpha, T::one()) * unit.z / cos_half
        } else {
            zero
        };
        shine * quarter * self.glass.facets.density_over_cosine(wo, half) + coated
    }
}
