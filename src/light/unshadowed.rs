//! The radiance that surfaces reflect from lights with nothing in between: the first factor of real-time direct light.
//!
//! Punctual lights, and the diffuse part of area lights with its Fresnel factor, are in closed form (the factor is a
//! polynomial of the cosine: see [`super::polygon`]). The mirrors' part of an area light is that of transformed cosines
//! ([`super::ltc`]), without noise, or an average of `samples` points of the light and, unless the lobe is dim beside it, as many directions of the lobe (balance heuristic); its error falls
//! faster than 1/√samples, since both are scrambled Sobol' points, a scramble of its own for every receiver.
//!
//! E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995.

use super::Light;
use super::irradiance::moments;
use super::ltc;
use super::polygon::doubled;
use super::representative::representative;
use crate::brdf::ggx;
use crate::brdf::metallic_roughness::{Lobes, Materials};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::sampling::sobol::{Scramble, columns, sobol};
use crate::simd::Simd;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// Where surfaces are seen from.
#[derive(Clone, Copy)]
pub enum Viewer<'a, T> {
    Eye(Vec3<T>),
    /// Unit directions to the eye, one for each receiver.
    Directions(&'a [[T; 3]]),
}

/// Oriented points of surfaces, as arrays of equal length.
#[derive(Clone, Copy)]
pub struct Receivers<'a, T> {
    pub points: &'a [[T; 3]],
    /// Unit.
    pub normals: &'a [[T; 3]],
    pub viewer: Viewer<'a, T>,
    /// Rows of the materials; a negative row is no surface. None: one material for all, or one each.
    pub material_ids: Option<&'a [i32]>,
    pub materials: Materials<'a, T>,
}

/// One of them, made ready.
#[derive(Clone, Copy)]
pub struct Receiver<T> {
    pub point: Vec3<T>,
    pub frame: Frame<T>,
    /// In the frame.
    pub wo: Vec3<T>,
    pub lobes: Lobes<T>,
}

impl<T: Real> Receivers<'_, T> {
    /// None where there is no surface.
    #[inline(always)]
    pub fn at(&self, i: usize) -> Option<Receiver<T>> {
        let rows = self.materials.metallic.len();
        let row = match self.material_ids {
            Some(ids) => usize::try_from(ids[i]).ok()?,
            None => i.min(rows - 1),
        };
        let point = Vec3::from(self.points[i]);
        let wo = match self.viewer {
            Viewer::Eye(eye) => (eye - point).normalize(),
            Viewer::Directions(wo) => wo[i].into(),
        };
        let frame = Frame::about(self.normals[i].into());
        let lobes = self.materials.at(row).checked().lobes();
        Some(Receiver { point, frame, wo: frame.local(wo), lobes })
    }
}

/// How the mirrors' part of area lights is found.
#[derive(Clone, Copy)]
pub enum Mirrors<'a> {
    /// See [`digits`].
    Sampled { digits: &'a [[u32; 3]], seed: u64 },
    /// By transformed cosines, and a few samples of lights without an outline.
    Transformed,
    /// By one point of each light, and a few samples of polygons and lights without an outline.
    Representative,
}

/// What a thread works with.
pub struct Desk<S> {
    token: S,
    corners: Vec<Vec3<f64>>,
    scratch: ltc::Scratch,
    few: Vec<[u32; 3]>,
}

impl<S: Simd> Desk<S> {
    /// With the token of the dispatch that it is used in.
    pub fn new(token: S) -> Self {
        Desk { token, corners: Vec::new(), scratch: ltc::Scratch::default(), few: digits(0, 16) }
    }
}

/// Sobol' points before scrambling, in three dimensions: computed once, scrambled for every receiver.
pub fn digits(start: u32, count: u32) -> Vec<[u32; 3]> {
    let table = columns();
    (0..count).map(|i| [0, 1, 2].map(|d| sobol(start.wrapping_add(i), &table[d]))).collect()
}

impl<T: Real> Receiver<T> {
    /// Radiance towards the eye from one light. Enters the level anew, so that it is compiled once a level and precision.
    #[inline(never)]
    pub fn unshadowed<S: Simd>(
        &self,
        light: &Light<T>,
        stream: u64,
        mirrors: Mirrors<'_>,
        desk: &mut Desk<S>,
    ) -> Vec3<T> {
        desk.token.vectorize(
            #[inline(always)]
            || self.unshadowed_here(light, stream, mirrors, desk),
        )
    }

    #[inline(always)]
    fn unshadowed_here<S: Simd>(
        &self,
        light: &Light<T>,
        stream: u64,
        mirrors: Mirrors<'_>,
        desk: &mut Desk<S>,
    ) -> Vec3<T> {
        if light.has_area() {
            if let (Light::Textured(_), Mirrors::Sampled { digits, seed }) = (light, mirrors)
                && !digits.is_empty()
            {
                return self.sampled(light, stream, seed, digits, true);
            }
            let mirrored = match mirrors {
                Mirrors::Transformed if light.has_outline() => self.transformed(light, desk),
                Mirrors::Representative
                    if light.has_outline() && !matches!(light, Light::Polygon(_) | Light::Textured(_)) =>
                {
                    self.represented(light)
                }
                Mirrors::Transformed | Mirrors::Representative => {
                    self.sampled(light, stream, 0, &desk.few, false)
                }
                Mirrors::Sampled { digits, seed } => self.sampled(light, stream, seed, digits, false),
            };
            self.diffuse(light, desk) + mirrored
        } else {
            match self.beam(light) {
                Some((radiance, ..)) => radiance,
                None => Vec3::splat(T::zero()),
            }
        }
    }

    /// Radiance from a punctual light, with the direction to it and its distance; none from below the horizon.
    #[inline(always)]
    pub fn beam(&self, light: &Light<T>) -> Option<(Vec3<T>, Vec3<T>, T)> {
        let beam = light.beam(self.point)?;
        let wi = self.frame.local(beam.wi);
        let f = self.lobes.eval(wi, self.wo);
        (!(wi.z <= T::zero())).then(|| (f.times(beam.irradiance) * wi.z, beam.wi, beam.distance))
    }

    /// The diffuse part: base/π (1 − F(wo)) ∫ (1 − F(c)) c dω, with (1 − c)⁵ c written in powers of c.
    #[inline(always)]
    fn diffuse<S: Simd>(&self, light: &Light<T>, desk: &mut Desk<S>) -> Vec3<T> {
        // Metals have none; NaN goes on.
        if self.wo.z <= T::zero() || self.lobes.diffuse == Vec3::splat(T::zero()) {
            return (self.point + self.frame.z + self.wo) * T::zero();
        }
        let m = moments(light, self.point, self.frame.z);
        let grazing = m[1] - 5.0 * m[2] + 10.0 * m[3] - 10.0 * m[4] + 5.0 * m[5] - m[6];
        let (f0, f90) = (self.lobes.base_f0.to_f64(), self.lobes.base_f90.to_f64());
        let through = (1.0 - f0) * m[1] - (f90 - f0) * grazing;
        // Rounding may leave less than nothing; NaN goes on.
        let through = if through < 0.0 { 0.0 } else { through };
        let factor = T::of(through) * self.lobes.transmitted(self.wo.z) / T::PI;
        let mut radiance = light.radiance();
        if let Light::Textured(shown) = light {
            let point = doubled(self.point);
            if ltc::outline(light, point, &mut desk.corners) {
                let frame = self.doubled_frame();
                let scratch = &mut desk.scratch;
                radiance = ltc::diffuse_picture(shown, point, &desk.corners, &frame, scratch).map(T::of);
            }
        }
        self.lobes.diffuse.times(radiance) * factor
    }

    #[inline(always)]
    fn doubled_frame(&self) -> Frame<f64> {
        Frame { x: doubled(self.frame.x), y: doubled(self.frame.y), z: doubled(self.frame.z) }
    }

    /// Whether directions of the mirrors' lobe are worth drawing beside points of the light: unless the lobe is dim
    /// and wide beside it, so that the balance heuristic would hardly count them. Depends on no sample, hence no bias.
    #[inline(always)]
    pub fn lobe_matters(&self, light: &Light<T>) -> bool {
        if !self.lobes.is_specular() || self.wo.z <= T::zero() {
            return false;
        }
        let peak = ggx::ggx_pdf(Vec3::new(-self.wo.x, -self.wo.y, self.wo.z), self.wo, self.lobes.alpha);
        !light.middle(self.point).is_some_and(|s| peak < T::of(0.25) * s.pdf)
    }

    /// The mirrors' part of a light with an outline, by transformed cosines.
    #[inline(always)]
    fn transformed<S: Simd>(&self, light: &Light<T>, desk: &mut Desk<S>) -> Vec3<T> {
        let point = doubled(self.point);
        if !self.lobes.is_specular()
            || self.wo.z <= T::zero()
            || !ltc::outline(light, point, &mut desk.corners)
        {
            // NaN goes on.
            return (self.point + self.wo) * T::zero();
        }
        let frame = self.doubled_frame();
        let (wo, alpha) = (doubled(self.wo), self.lobes.alpha.to_f64());
        let Desk { token, corners, scratch, .. } = desk;
        let (s, table, mut radiance) = (*token, ltc::shipped(), light.radiance());
        let parts = if let Light::Textured(shown) = light {
            let (parts, seen) =
                ltc::mirrored_picture(s, table, shown, point, corners, &frame, wo, alpha, scratch);
            radiance = seen.map(T::of);
            parts
        } else {
            ltc::mirrored(s, table, corners, &frame, wo, alpha, scratch)
        };
        let [base, edge] = [T::of(parts[0]), T::of(parts[1])];
        self.lobes.f0.map(|f0| f0 * base + (self.lobes.f90 - f0) * edge).times(radiance)
    }

    /// The mirrors' part, from one point that stands for the light.
    #[inline(always)]
    fn represented(&self, light: &Light<T>) -> Vec3<T> {
        let none = (self.point + self.wo) * T::zero();
        if !self.lobes.is_specular() || self.wo.z <= T::zero() {
            return none;
        }
        let mirror = self.frame.world(Vec3::new(-self.wo.x, -self.wo.y, self.wo.z));
        let Some(point) = representative(light, self.point, mirror) else { return none };
        let wi = self.frame.local(point.wi);
        if !(wi.z > T::zero()) {
            return none;
        }
        let alpha = self.lobes.alpha;
        let share = alpha / Lanes::min(alpha + point.wider, T::one());
        let factor = share * share * point.solid_angle * wi.z;
        let reflected = (self.lobes.specular(wi, self.wo) * factor).map(
            // By a light that is near and wide the lobe is widened and dimmed too little: never more than all comes back.
            #[inline(always)]
            |r| if r > T::one() { T::one() } else { r },
        );
        reflected.times(light.radiance())
    }

    /// The density of the lobe's draws, where there are any.
    #[inline(always)]
    fn lobe_pdf(&self, wi: Vec3<T>, drawn: bool) -> T {
        if drawn { ggx::ggx_pdf(wi, self.wo, self.lobes.alpha) } else { T::zero() }
    }

    /// The mirrors' part, or the whole, for a direction.
    #[inline(always)]
    fn value(&self, wi: Vec3<T>, whole: bool) -> Vec3<T> {
        if whole { self.lobes.eval(wi, self.wo) } else { self.lobes.specular(wi, self.wo) }
    }

    /// The mirrors' part, or the whole, by sampling the light and the lobe.
    #[inline(never)]
    fn sampled(&self, light: &Light<T>, stream: u64, seed: u64, digits: &[[u32; 3]], whole: bool) -> Vec3<T> {
        let none = (self.point + self.wo) * T::zero();
        if !(whole || self.lobes.is_specular()) || self.wo.z <= T::zero() || digits.is_empty() {
            return none;
        }
        let scramble = [
            Scramble::new(seed, stream, 0),
            Scramble::new(seed, stream, 1),
            Scramble::new(seed, stream, 2),
            Scramble::new(seed, stream, 3),
        ];
        let (mut sum, both) = (none, self.lobe_matters(light));
        for x in digits {
            let sighting = light.sight(self.point, [scramble[0].fraction(x[0]), scramble[1].fraction(x[1])]);
            if let Some(s) = sighting {
                let wi = self.frame.local(s.wi);
                if wi.z > T::zero() {
                    let weight = wi.z / (s.pdf + self.lobe_pdf(wi, both));
                    sum = sum + self.value(wi, whole).times(light.shown(self.point, &s)) * weight;
                }
            }
            if !both {
                continue;
            }
            let u = [scramble[2].fraction(x[0]), scramble[3].fraction(x[1])];
            let wi = ggx::ggx_sample(self.wo, u, self.lobes.alpha);
            if wi.z > T::zero()
                && let Some(s) = light.meet(self.point, self.frame.world(wi))
            {
                let weight = wi.z / (s.pdf + self.lobe_pdf(wi, both));
                sum = sum + self.value(wi, whole).times(light.shown(self.point, &s)) * weight;
            }
        }
        sum * (T::one() / T::of(digits.len() as f64))
    }
}

/// Radiance towards the eye from all lights; zero where there is no surface.
pub fn unshadowed_many<T: Real>(
    watch: &mut dyn Watch,
    receivers: &Receivers<'_, T>,
    lights: &[Light<T>],
    mirrors: Mirrors<'_>,
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    let samples = if let Mirrors::Sampled { digits, .. } = mirrors { digits.len() } else { 0 };
    // About a microsecond for every light and ten samples.
    let piece = (4096 / (1 + lights.len() * (1 + samples / 16))).max(64);
    parallel::for_each(watch, out, piece, |first, out| {
        dispatch!(s => {
            let mut desk = Desk::new(s);
            for (i, out) in (first..).zip(out.iter_mut()) {
                // By hand: a closure would be called outside the dispatch.
                let mut sum = Vec3::splat(T::zero());
                if let Some(r) = receivers.at(i) {
                    for (k, light) in lights.iter().enumerate() {
                        let stream = (k as u64) << 40 | i as u64;
                        sum = sum + r.unshadowed(light, stream, mirrors, &mut desk);
                    }
                    // NaN goes on, also where no light would look at it.
                    let nan = (r.point + r.frame.z + r.wo).dot(Vec3::splat(T::zero()));
                    sum = sum + Vec3::splat(nan);
                }
                *out = sum.to_array();
            }
        })
    })
}
