//! Deferred shading: what the surfaces of a G-buffer send to the eye, by their materials and the lights of a scene.
//!
//! Every material is a [`Bsdf`], the one that paths are traced with; every light is a [`Light`]. Beams of punctual lights
//! are exact; area lights take the method that their material asks for ([`Method`]), panoramas samples. Eight surfaces of
//! metallic-roughness (or its like) are shaded at once where all lights are punctual.
//!
//! Of each light a fraction may arrive: what a shadow technique found. Light from below the face itself does not arrive,
//! whatever the shading normal says.
//!
//! M. Deering and others, *The triangle processor and normal vector shader*, 1988.

use super::lanes::{self, LANES};
pub use super::lit::Method;
use super::lit::{Sampling, Site, Source, lobes, share};
use crate::brdf::{Bsdf, Row};
use crate::dispatch;
use crate::environment::panorama::Panorama;
use crate::light::Light;
use crate::light::unshadowed::{Desk, Viewer, digits};
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::simd::Simd;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// Oriented points of surfaces, as arrays of equal length, and the tables of their materials.
#[derive(Clone, Copy)]
pub struct Surfaces<'a, T> {
    pub points: &'a [[T; 3]],
    /// Unit shading normals, on the side that is seen.
    pub normals: &'a [[T; 3]],
    /// Unit normals of the faces, on the side that is seen; None: the shading normals.
    pub faces: Option<&'a [[T; 3]]>,
    /// Whether the side that is seen is the inside of a body; None: never.
    pub inside: Option<&'a [bool]>,
    /// By which the materials' colours are multiplied.
    pub colors: Option<&'a [[T; 3]]>,
    pub viewer: Viewer<'a, T>,
    /// Rows of the tables; a negative one is no surface. None: row 0 for all.
    pub material_ids: Option<&'a [i32]>,
    pub kinds: &'a [i32],
    pub rows: &'a [Row<T>],
    /// How each material finds the light from areas, and by how many samples.
    pub methods: &'a [(Method, u32)],
}

/// What shines.
#[derive(Clone, Copy)]
pub struct Lights<'a, T> {
    pub lights: &'a [Light<T>],
    /// Of each light the fraction that arrives at each surface; None: all.
    pub fractions: &'a [Option<&'a [T]>],
    pub sky: Option<&'a Panorama<T>>,
    pub seed: u64,
}

impl<T: Real> Surfaces<'_, T> {
    /// The row of a surface's material; None where there is no surface.
    #[inline(always)]
    pub fn row(&self, i: usize) -> Option<usize> {
        match self.material_ids {
            Some(ids) => {
                if ids[i] < 0 {
                    None
                } else {
                    Some(ids[i] as usize)
                }
            }
            None => Some(0),
        }
    }

    #[inline(always)]
    pub fn color(&self, i: usize) -> Vec3<T> {
        match self.colors {
            Some(colors) => Vec3::new(share(colors[i][0]), share(colors[i][1]), share(colors[i][2])),
            None => Vec3::splat(T::one()),
        }
    }

    #[inline(always)]
    fn site<'a>(&self, i: usize, bsdf: &'a Bsdf<T>) -> Site<'a, T> {
        let (point, shading) = (Vec3::from(self.points[i]), Vec3::from(self.normals[i]));
        let normal = if let Some(faces) = self.faces { faces[i].into() } else { shading };
        let wo = match self.viewer {
            Viewer::Eye(eye) => (eye - point).normalize(),
            Viewer::Directions(wo) => wo[i].into(),
        };
        let inside = if let Some(inside) = self.inside { inside[i] } else { false };
        let frame = Frame::about(if inside && bsdf.transmits() { -shading } else { shading });
        Site { point, normal, frame, wo: frame.local(wo), bsdf }
    }
}

/// Radiance towards the eye; zero where there is no surface.
pub fn shade<T: Real>(
    watch: &mut dyn Watch,
    surfaces: &Surfaces<'_, T>,
    lights: &Lights<'_, T>,
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    let mut most = 0;
    for &(_, samples) in surfaces.methods {
        most = samples.max(most);
    }
    let digits = digits(0, most);
    let areas = lights.lights.iter().filter(|l| l.has_area()).count() + usize::from(lights.sky.is_some());
    // Some milliseconds.
    let piece = (1 << 17) / (8 + lights.lights.len() + areas * (8 + 4 * digits.len()));
    parallel::for_each(
        watch,
        out,
        piece.clamp(16, 1 << 13),
        |first, out| dispatch!(s => body(s, surfaces, lights, &digits, first, out)),
    )
}

#[inline(always)]
fn body<T: Real, S: Simd>(
    s: S,
    surfaces: &Surfaces<'_, T>,
    lights: &Lights<'_, T>,
    digits: &[[u32; 3]],
    first: usize,
    out: &mut [[T; 3]],
) {
    let mut desk = Desk::new(s);
    // Models by row, made once where nothing colours them, and those of them that lanes know.
    let count = surfaces.rows.len();
    let (mut models, mut table) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for row in 0..count {
        let model = Bsdf::of(surfaces.kinds[row], &surfaces.rows[row]);
        table.push(if let Some(bsdf) = &model { lobes(bsdf) } else { None });
        models.push(model);
    }
    let (mut beams, mut others) = (0, usize::from(lights.sky.is_some()));
    for light in lights.lights {
        if lanes::fits(light) {
            beams += 1;
        } else {
            others += 1;
        }
    }
    let mut at = 0;
    while at < out.len() {
        let (start, count) = (first + at, LANES.min(out.len() - at));
        let group = if beams > 0 && count == LANES {
            lanes::eight_lit(s, surfaces, lights, &table, start)
        } else {
            None
        };
        for k in 0..count {
            let i = start + k;
            let Some(row) = surfaces.row(i) else {
                out[at + k] = [T::zero(); 3];
                continue;
            };
            if let Some(faces) = surfaces.faces
                && !(Vec3::from(faces[i]).length_squared() > T::zero())
            {
                out[at + k] = [T::NAN; 3];
                continue;
            }
            if let Some(group) = &group
                && others == 0
            {
                out[at + k] = group[k];
                continue;
            }
            let mut sum = match &group {
                Some(group) => Vec3::from(group[k]),
                None => Vec3::splat(T::zero()),
            };
            let own = if surfaces.colors.is_some() {
                Bsdf::tinted(surfaces.kinds[row], &surfaces.rows[row], surfaces.color(i))
            } else {
                None
            };
            let Some(bsdf) = own.as_ref().or(models[row].as_ref()) else {
                out[at + k] = [T::NAN; 3];
                continue;
            };
            let site = surfaces.site(i, bsdf);
            let (method, samples) = surfaces.methods[row];
            let sampling = Sampling { digits: &digits[..samples as usize], seed: lights.seed };
            for l in 0..lights.lights.len() + usize::from(lights.sky.is_some()) {
                let (source, fraction) = match (lights.lights.get(l), lights.sky) {
                    (Some(light), _) if group.is_some() && lanes::fits(light) => continue,
                    (Some(light), _) => (Source::Light(light), lights.fractions[l]),
                    (None, Some(sky)) => (Source::Sky(sky), None),
                    (None, None) => continue,
                };
                let stream = (l as u64) << 40 | i as u64;
                let arriving = site.under(source, method, stream, &sampling, &mut desk);
                sum = sum
                    + match fraction {
                        Some(fraction) => arriving * share(fraction[i]),
                        None => arriving,
                    };
            }
            out[at + k] = sum.to_array();
        }
        at += LANES;
    }
}
