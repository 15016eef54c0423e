//! The light that one point of a surface reflects, nothing in between, by any model under any light.

use crate::brdf::Bsdf;
use crate::brdf::metallic_roughness::Lobes;
use crate::brdf::specular_glossiness::SpecularGlossiness;
use crate::environment::panorama::Panorama;
use crate::light::Light;
use crate::light::unshadowed::{Desk, Mirrors, Receiver};
use crate::real::{Lanes, Real};
use crate::sampling::sobol::Scramble;
use crate::simd::Simd;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// How light from areas is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// An average over points of the light and directions of the lobe; of GGX's under Schlick's Fresnel the diffuse part
    /// is in closed form.
    Sampling,
    /// The diffuse part in closed form, the mirrors' by transformed cosines.
    Ltc,
    /// The diffuse part in closed form, the mirrors' from one point of the light.
    Representative,
    /// All of the light as if it came from its middle.
    Point,
}

/// A share in [0, 1]: what roundings put beyond is brought back, what is farther is NaN.
#[inline(always)]
pub fn share<V: Lanes>(x: V) -> V {
    let (zero, one, slack) = (x.num(0.0), x.num(1.0), x.num(1e-5));
    let held = V::select(one.less(x), one, V::select(x.less(zero), zero, x));
    let near = (x - held).less_eq(slack) & (held - x).less_eq(slack);
    V::select(near, held, x.like(V::Elem::NAN))
}

/// A point of a surface as it is seen.
#[derive(Clone, Copy)]
pub struct Site<'a, T> {
    pub point: Vec3<T>,
    /// Unit, of the face, on the side that is seen.
    pub normal: Vec3<T>,
    /// About the shading normal: on the side that is seen, or out of a body that light passes.
    pub frame: Frame<T>,
    /// In the frame.
    pub wo: Vec3<T>,
    pub bsdf: &'a Bsdf<T>,
}

/// The lobes of a model whose mirrors are GGX's under Schlick's Fresnel, or that has none.
#[inline(always)]
pub fn lobes<T: Real>(bsdf: &Bsdf<T>) -> Option<Lobes<T>> {
    let (zero, one) = (T::zero(), T::one());
    match bsdf {
        Bsdf::MetallicRoughness(lobes) => Some(*lobes),
        Bsdf::SpecularGlossiness(SpecularGlossiness(lobes)) => Some(*lobes),
        Bsdf::Diffuse(m) => Some(Lobes {
            diffuse: m.albedo,
            base_f0: zero,
            base_f90: zero,
            f0: Vec3::splat(zero),
            f90: zero,
            alpha: one,
        }),
        _ => None,
    }
}

/// What light comes from.
#[derive(Clone, Copy)]
pub enum Source<'a, T> {
    Light(&'a Light<T>),
    Sky(&'a Panorama<T>),
}

impl<T: Real> Source<'_, T> {
    /// A direction drawn towards it, the radiance from there, the density.
    #[inline(always)]
    fn look(&self, from: Vec3<T>, u: [T; 2]) -> Option<(Vec3<T>, Vec3<T>, T)> {
        match self {
            Source::Light(light) => {
                let s = light.sight(from, u)?;
                Some((s.wi, light.shown(from, &s), s.pdf))
            }
            Source::Sky(sky) => {
                let draw = sky.sample(u);
                if draw.pdf > T::zero() { Some((draw.wi, draw.radiance, draw.pdf)) } else { None }
            }
        }
    }

    /// The radiance that comes along a direction, and the density of drawing it.
    #[inline(always)]
    fn meet(&self, from: Vec3<T>, wi: Vec3<T>) -> Option<(Vec3<T>, T)> {
        match self {
            Source::Light(light) => {
                let s = light.meet(from, wi)?;
                Some((light.shown(from, &s), s.pdf))
            }
            Source::Sky(sky) => Some(sky.eval_and_pdf(wi)),
        }
    }
}

/// What the samples of one light share.
pub struct Sampling<'a> {
    pub digits: &'a [[u32; 3]],
    pub seed: u64,
}

impl<T: Real> Site<'_, T> {
    /// Whether a direction, in the frame and in the world, lies on one side by both normals.
    #[inline(always)]
    fn agrees(&self, local: Vec3<T>, world: Vec3<T>) -> bool {
        let (zero, same, seen) = (T::zero(), local.z * self.wo.z, world.dot(self.normal));
        (same > zero && seen > zero) || (same < zero && seen < zero)
    }

    /// Whether anything can be seen of it; a NaN can.
    #[inline(always)]
    fn is_seen(&self) -> bool {
        self.bsdf.transmits() || !(self.wo.z <= T::zero())
    }

    /// What a source sends to the eye by this surface.
    #[inline(always)]
    pub fn under<S: Simd>(
        &self,
        source: Source<'_, T>,
        method: Method,
        stream: u64,
        sampling: &Sampling<'_>,
        desk: &mut Desk<S>,
    ) -> Vec3<T> {
        let none = (self.point + self.wo) * T::zero();
        if !self.is_seen() {
            return none;
        }
        // Towards the middle of an area, evenly drawn.
        let mut middle = None;
        if let Source::Light(light) = source {
            if light.has_outline() {
                middle = light.middle(self.point);
            }
            let mut single = !light.has_area();
            let mut beam = None;
            if single {
                if let Some(b) = light.beam(self.point) {
                    beam = Some((b.wi, b.irradiance));
                }
            } else if method == Method::Point && light.has_outline() {
                single = true;
                if let Some(s) = middle {
                    beam = Some((s.wi, light.radiance() * (T::one() / s.pdf)));
                }
            }
            if single {
                let Some((wi, irradiance)) = beam else { return none };
                let local = self.frame.local(wi);
                let nan = (self.wo + local) * T::zero();
                if !self.agrees(local, wi) {
                    return nan;
                }
                return self.bsdf.eval(local, self.wo).times(irradiance) * local.z.abs() + nan;
            }
            if let Some(lobes) = lobes(self.bsdf) {
                let receiver = Receiver { point: self.point, frame: self.frame, wo: self.wo, lobes };
                let mirrors = match method {
                    Method::Ltc => Mirrors::Transformed,
                    Method::Representative => Mirrors::Representative,
                    _ => Mirrors::Sampled { digits: sampling.digits, seed: sampling.seed },
                };
                return receiver.unshadowed(light, stream, mirrors, desk);
            }
        }
        let brightest = if let Some(s) = middle { s.pdf } else { T::zero() };
        self.sampled(source, stream, sampling, brightest)
    }

    /// An average over directions drawn for the source and, unless the lobe is dim beside the source's density
    /// `brightest` (by the density alone, so without bias), for the model; what is specular is found by the model alone.
    #[inline(never)]
    fn sampled(&self, source: Source<'_, T>, stream: u64, sampling: &Sampling<'_>, brightest: T) -> Vec3<T> {
        let (zero, one) = (T::zero(), T::one());
        let mut sum = (self.point + self.wo) * zero;
        if sampling.digits.is_empty() {
            return sum;
        }
        let mut scramble = [Scramble::new(sampling.seed, stream, 0); 5];
        for d in 1..5 {
            scramble[d] = Scramble::new(sampling.seed, stream, d as u32);
        }
        let smooth = self.bsdf.is_smooth();
        let peak = self.bsdf.pdf(Vec3::new(-self.wo.x, -self.wo.y, self.wo.z), self.wo);
        let both = smooth
            || self.bsdf.transmits()
            || matches!(self.bsdf, Bsdf::Plastic(_))
            || !(peak < T::of(0.25) * brightest);
        for x in sampling.digits {
            if !smooth
                && let Some((wi, radiance, pdf)) =
                    source.look(self.point, [scramble[0].fraction(x[0]), scramble[1].fraction(x[1])])
            {
                let local = self.frame.local(wi);
                if self.agrees(local, wi) {
                    let lobe = if both { self.bsdf.pdf(local, self.wo) } else { zero };
                    let f = self.bsdf.eval(local, self.wo);
                    sum = sum + f.times(radiance) * (local.z.abs() / (pdf + lobe));
                }
            }
            if !both {
                continue;
            }
            let u = [scramble[2].fraction(x[0]), scramble[3].fraction(x[1]), scramble[4].fraction(x[2])];
            let Some(draw) = self.bsdf.sample(self.wo, u) else { continue };
            let wi = self.frame.world(draw.wi);
            if !(draw.pdf > zero && self.agrees(draw.wi, wi)) {
                continue;
            }
            if let Some((radiance, pdf)) = source.meet(self.point, wi) {
                let share = if draw.specular { one } else { draw.pdf / (draw.pdf + pdf) };
                sum = sum + draw.weight.times(radiance) * share;
            }
        }
        sum * (one / T::of(sampling.digits.len() as f64))
    }
}
