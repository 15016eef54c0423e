//! The other workflow of real-time materials: a diffuse colour, a colour of the mirrors, and a glossiness; and the
//! way between it and [`super::metallic_roughness`].
//!
//! Mirrors are GGX of alpha = (1 − glossiness)² under Schlick's Fresnel from the specular colour to one. What they let in
//! comes out diffuse as in the other workflow, by the brightest channel of the specular colour.
//!
//! Khronos, *KHR_materials_pbrSpecularGlossiness*, 2017, with the conversion of its appendix.

use super::metallic_roughness::{Lobes, MIN_ALPHA};
use super::model::{Draw, Drawn, Model, Row, triple};
use crate::math::exact::largest;
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct SpecularGlossiness<T>(pub Lobes<T>);

impl<V: Lanes> Model<V> for SpecularGlossiness<V> {
    #[inline(always)]
    fn of(row: &Row<V>) -> Self {
        let (one, f0) = (row[6].num(1.0), triple(row, 3));
        let roughness = one - row[6];
        SpecularGlossiness(Lobes {
            diffuse: triple(row, 0),
            base_f0: f0.x.max(f0.y).max(f0.z),
            base_f90: one,
            f0,
            f90: one,
            alpha: (roughness * roughness).max(one.num(MIN_ALPHA)),
        })
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<V>, wo: Vec3<V>) -> Vec3<V> {
        self.0.eval(wi, wo)
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<V>, wo: Vec3<V>) -> V {
        self.0.pdf(wi, wo)
    }
}

impl<T: Real> Drawn<T> for SpecularGlossiness<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        Drawn::sample(&self.0, wo, u)
    }
}

/// Reflectance of a dielectric along the normal.
const DIELECTRIC: f64 = 0.04;

/// How bright a colour looks, as the source weighs it.
#[inline(always)]
fn brightness<T: Real>(c: Vec3<T>) -> T {
    let squares = T::of(0.299) * c.x * c.x + T::of(0.587) * c.y * c.y + T::of(0.114) * c.z * c.z;
    squares.sqrt()
}

/// Base colour and metallic of the diffuse and specular colours that come nearest.
#[inline(always)]
pub fn to_metallic_roughness<T: Real>(diffuse: Vec3<T>, specular: Vec3<T>) -> (Vec3<T>, T) {
    let (zero, one, f0) = (T::zero(), T::one(), T::of(DIELECTRIC));
    let rest = one - largest(specular);
    let (bright, shine) = (brightness(diffuse), brightness(specular));
    // The share m for which a base colour c gives both: bright · rest = c (1 − f0)(1 − m), shine = f0 (1 − m) + c m.
    let metallic = if shine < f0 {
        shine * zero
    } else {
        let b = bright * rest / (one - f0) + shine - (f0 + f0);
        let squared = b * b - T::of(4.0) * f0 * (f0 - shine);
        ((Lanes::max(squared, zero).sqrt() - b) / (f0 + f0)).clamp01()
    };
    let epsilon = T::of(1e-6);
    let plain = diffuse * (rest / ((one - f0) * Lanes::max(one - metallic, epsilon)));
    let metal = (specular + -Vec3::splat(f0 * (one - metallic))) * (one / Lanes::max(metallic, epsilon));
    let share = metallic * metallic;
    (
        plain.zip(
            metal,
            #[inline(always)]
            |p, m| (p + (m - p) * share).clamp01(),
        ),
        metallic,
    )
}

/// Diffuse and specular colours of a base colour and metallic.
#[inline(always)]
pub fn to_specular_glossiness<T: Real>(base: Vec3<T>, metallic: T) -> (Vec3<T>, Vec3<T>) {
    let (one, f0) = (T::one(), T::of(DIELECTRIC));
    let specular = base.map(
        #[inline(always)]
        |c| f0 + (c - f0) * metallic,
    );
    // The diffuse colour loses what the mirrors take by their brightest channel, a dielectric's base by 4 %.
    let rest = Lanes::max(one - largest(specular), T::of(1e-6));
    (
        base.map(
            #[inline(always)]
            |c| (c * (one - f0) * (one - metallic) / rest).clamp01(),
        ),
        specular,
    )
}
