//! Point and directional lights on GGX under Schlick's Fresnel, and on Lambert's diffuser, eight surfaces at once.

use super::lit::{lobes, share};
use super::shade::{Lights, Surfaces};
use crate::brdf::Bsdf;
use crate::brdf::metallic_roughness::Lobes;
use crate::light::Light;
use crate::light::unshadowed::Viewer;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

pub const LANES: usize = 8;

/// Whether a light is summed here.
#[inline(always)]
pub fn fits<T: Real>(light: &Light<T>) -> bool {
    matches!(light, Light::Point { .. } | Light::Directional { .. })
}

#[inline(always)]
fn all<T: Real, S: Simd>(s: S, x: T) -> T::V8<S> {
    SimdBase::splat(s, x)
}

#[inline(always)]
fn all3<T: Real, S: Simd>(s: S, v: Vec3<T>) -> Vec3<T::V8<S>> {
    Vec3::new(all(s, v.x), all(s, v.y), all(s, v.z))
}

/// Eight vectors in a row.
#[inline(always)]
fn load3<T: Real, S: Simd>(s: S, v: &[[T; 3]; LANES]) -> Vec3<T::V8<S>> {
    let (mut x, mut y, mut z) = ([T::zero(); LANES], [T::zero(); LANES], [T::zero(); LANES]);
    for k in 0..LANES {
        (x[k], y[k], z[k]) = (v[k][0], v[k][1], v[k][2]);
    }
    Vec3::new(
        SimdBase::load_array_ref(s, &x),
        SimdBase::load_array_ref(s, &y),
        SimdBase::load_array_ref(s, &z),
    )
}

#[inline(always)]
fn eight<V>(all: &[V], first: usize) -> &[V; LANES] {
    all[first..].first_chunk().expect("eight surfaces")
}

/// The lobes of eight surfaces from `first` on; None if a material has others.
#[inline(always)]
fn gather<T: Real, S: Simd>(
    s: S,
    surfaces: &Surfaces<'_, T>,
    table: &[Option<Lobes<T>>],
    first: usize,
) -> Option<Lobes<T::V8<S>>> {
    let mut rows = [0; LANES];
    for k in 0..LANES {
        // Where there is no surface any row serves.
        rows[k] = surfaces.row(first + k).unwrap_or(0);
    }
    let mut same = surfaces.colors.is_none();
    for k in 1..LANES {
        same = same && rows[k] == rows[0];
    }
    if same {
        let l = table[rows[0]].as_ref()?;
        return Some(Lobes {
            diffuse: all3(s, l.diffuse),
            base_f0: all(s, l.base_f0),
            base_f90: all(s, l.base_f90),
            f0: all3(s, l.f0),
            f90: all(s, l.f90),
            alpha: all(s, l.alpha),
        });
    }
    let zero = [T::zero(); LANES];
    let (mut diffuse, mut f0) = ([[T::zero(); 3]; LANES], [[T::zero(); 3]; LANES]);
    let (mut base_f0, mut base_f90, mut f90, mut alpha) = (zero, zero, zero, zero);
    for k in 0..LANES {
        let row = rows[k];
        let own = if surfaces.colors.is_some() {
            table[row].as_ref()?;
            lobes(&Bsdf::tinted(surfaces.kinds[row], &surfaces.rows[row], surfaces.color(first + k))?)?
        } else {
            table[row]?
        };
        (diffuse[k], f0[k]) = (own.diffuse.to_array(), own.f0.to_array());
        (base_f0[k], base_f90[k], f90[k], alpha[k]) = (own.base_f0, own.base_f90, own.f90, own.alpha);
    }
    Some(Lobes {
        diffuse: load3(s, &diffuse),
        base_f0: SimdBase::load_array_ref(s, &base_f0),
        base_f90: SimdBase::load_array_ref(s, &base_f90),
        f0: load3(s, &f0),
        f90: SimdBase::load_array_ref(s, &f90),
        alpha: SimdBase::load_array_ref(s, &alpha),
    })
}

/// What the lights that fit send to the eye by eight surfaces from `first` on; None if a material has other lobes. Where
/// there is no surface the numbers mean nothing.
#[inline(always)]
pub fn eight_lit<T: Real, S: Simd>(
    s: S,
    surfaces: &Surfaces<'_, T>,
    lights: &Lights<'_, T>,
    table: &[Option<Lobes<T>>],
    first: usize,
) -> Option<[[T; 3]; LANES]> {
    let lobes = gather(s, surfaces, table, first)?;
    let point = load3(s, eight(surfaces.points, first));
    let frame = Frame::about(load3(s, eight(surfaces.normals, first)));
    let wo = match surfaces.viewer {
        Viewer::Eye(eye) => (all3(s, eye) - point).normalize(),
        Viewer::Directions(wo) => load3(s, eight(wo, first)),
    };
    let wo = frame.local(wo);
    let (zero, one) = (all(s, T::zero()), all(s, T::one()));
    // NaN goes on.
    let mut sum = (point + wo) * zero;
    for (light, fraction) in lights.lights.iter().zip(lights.fractions) {
        let (wi, irradiance, shines) = match light {
            Light::Point { position, intensity } => {
                let to = all3(s, *position) - point;
                let squared = to.length_squared();
                let inverse = one / squared.sqrt();
                let irradiance = all3(s, *intensity) * inverse * inverse;
                // None from so near that no number holds it.
                let held = irradiance.x + irradiance.y + irradiance.z;
                (to * inverse, irradiance, zero.less(squared) & held.less(all(s, T::INFINITY)))
            }
            Light::Directional { direction, irradiance } => {
                (all3(s, -*direction), all3(s, *irradiance), zero.less(one))
            }
            _ => continue,
        };
        let local = frame.local(wi);
        let mut shines = shines & zero.less(local.z) & zero.less(wo.z);
        if let Some(faces) = surfaces.faces {
            shines = shines & zero.less(wi.dot(load3(s, eight(faces, first))));
        }
        if T::V8::<S>::bits(shines) == 0 {
            continue;
        }
        let mut cosine = local.z;
        if let Some(fraction) = fraction {
            let fraction: T::V8<S> = SimdBase::load_array_ref(s, eight(fraction, first));
            cosine = share(fraction) * cosine;
        }
        let f = lobes.eval(local, wo).times(irradiance) * Lanes::select(shines, cosine, zero);
        sum = sum
            + f.map(
                #[inline(always)]
                |x| Lanes::select(shines, x, zero),
            );
    }
    let (x, y, z) = (sum.x.as_slice(), sum.y.as_slice(), sum.z.as_slice());
    let mut out = [[T::zero(); 3]; LANES];
    for k in 0..LANES {
        out[k] = [x[k], y[k], z[k]];
    }
    Some(out)
}
