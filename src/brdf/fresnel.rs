//! Fresnel reflectance: exact for clear bodies and for metals, and Schlick's polynomial.
//!
//! η is the index of the body that light meets over that of the one it comes from; of a metal η + ik. Every numerator
//! is written without the difference of nearly equal numbers that the textbook has, so that η = 1 ± 10⁻⁷ keeps its
//! digits. Schlick's polynomial is within 0.036 of glass of 1.5, coarser for metals beyond 60°.
//!
//! C. Schlick, *An inexpensive BRDF model for physically-based rendering*, 1994; M. Born, E. Wolf, *Principles of
//! optics*, 1999, sections 1.5 and 14.2; W. G. Egan, T. Hilgeman, J. Reichman, *Determination of absorption and
//! scattering coefficients for nonhomogeneous media*, 1973 (the average over the hemisphere).

use crate::real::{Lanes, Real};

/// Reflectances of light polarised across and in the plane of incidence, and the cosine of the refracted ray.
#[derive(Clone, Copy, Debug)]
pub struct Fresnel<V> {
    pub s: V,
    pub p: V,
    /// 0 where all is reflected, and for metals.
    pub cos_t: V,
}

impl<V: Lanes> Fresnel<V> {
    /// Of unpolarised light.
    #[inline(always)]
    pub fn average(&self) -> V {
        (self.s + self.p) * self.s.num(0.5)
    }
}

/// (1 − c)⁵, the weight of `f90`.
#[inline(always)]
pub fn schlick_weight<V: Lanes>(cos_theta: V) -> V {
    let x = cos_theta.num(1.0) - cos_theta;
    let squared = x * x;
    squared * squared * x
}

#[inline(always)]
pub fn fresnel_schlick<V: Lanes>(cos_theta: V, f0: V, f90: V) -> V {
    f0 + (f90 - f0) * schlick_weight(cos_theta)
}

/// At the interface of two clear bodies; cos θ in [0, 1].
#[inline(always)]
pub fn fresnel_dielectric<V: Lanes>(cos_theta: V, eta: V) -> Fresnel<V> {
    let (zero, one) = (eta.num(0.0), eta.num(1.0));
    let c = cos_theta;
    // η² − 1, and η cos θt squared.
    let more = (eta - one) * (eta + one);
    let squared = more + c * c;
    let total = squared.less_eq(zero);
    let g = V::select(total, zero, squared).sqrt();
    let (s, p) = (c + g, eta * eta * c + g);
    let s = more / (s * s);
    let p = more * (c * c * (eta * eta + one) - one) / (p * p);
    // At grazing incidence on η = 1 both are 0/0: nothing is there to reflect.
    let through = squared.less_eq(zero) & more.equal(zero);
    let clean = |r: V| V::select(through, zero, V::select(total, one, r * r));
    Fresnel { s: clean(s), p: clean(p), cos_t: g / eta }
}

/// One less the reflectance of unpolarised light at the interface of two clear bodies, without that difference: it keeps
/// its digits where nearly all is reflected.
#[inline(always)]
pub fn dielectric_transmittance<V: Lanes>(cos_theta: V, eta: V) -> V {
    let (zero, two, c) = (eta.num(0.0), eta.num(2.0), cos_theta);
    let squared = (eta - eta.num(1.0)) * (eta + eta.num(1.0)) + c * c;
    let g = V::select(squared.less_eq(zero), zero, squared).sqrt();
    // 1 − ((a − b) / (a + b))² = 4ab / (a + b)², of (c, g) and of (η c, g / η).
    let (s, p) = (c + g, eta * c + g / eta);
    let passed = two * ((c / s) * (g / s) + (c / p) * (g / p));
    // At grazing incidence on η = 1 all of it is 0/0: nothing is there to reflect.
    let closed = V::select(eta.equal(eta.num(1.0)), eta.num(1.0), zero);
    V::select(squared.less_eq(zero), closed, passed)
}

/// Of the refracted wave in a metal, whose index cosine is a + ib: a² + b², and 2 c a.
#[inline(always)]
fn in_metal<V: Lanes>(c: V, eta: V, k: V) -> (V, V) {
    let (one, two, half) = (eta.num(1.0), eta.num(2.0), eta.num(0.5));
    // (a + ib)² = (η + ik)² − sin²; a² + b² is its absolute value.
    let real = (eta - k) * (eta + k) - (one - c) * (one + c);
    let imaginary = two * eta * k;
    let sum = (real * real + imaginary * imaginary).sqrt();
    // The root of the smaller part comes from the product where the sum would cancel.
    let larger = (half * (sum + real.abs())).sqrt();
    let smaller = half * imaginary / larger;
    let a = V::select(real.less(real.num(0.0)), smaller, larger);
    (sum, two * c * a)
}

/// At a metal of index η + ik; cos θ in [0, 1].
#[inline(always)]
pub fn fresnel_conductor<V: Lanes>(cos_theta: V, eta: V, k: V) -> Fresnel<V> {
    let c2 = cos_theta * cos_theta;
    let s2 = (eta.num(1.0) - cos_theta) * (eta.num(1.0) + cos_theta);
    let (sum, twice) = in_metal(cos_theta, eta, k);
    let s = (sum + c2 - twice) / (sum + c2 + twice);
    let (t1, t2) = (c2 * sum + s2 * s2, twice * s2);
    let p = s * ((t1 - t2) / (t1 + t2));
    Fresnel { s, p, cos_t: eta.num(0.0) }
}

/// The same of unpolarised light by one division: (1 + (t1 − t2) / (t1 + t2)) / 2 = t1 / (t1 + t2).
#[inline(always)]
pub fn fresnel_metal<V: Lanes>(cos_theta: V, eta: V, k: V) -> V {
    let c2 = cos_theta * cos_theta;
    let s2 = (eta.num(1.0) - cos_theta) * (eta.num(1.0) + cos_theta);
    let (sum, twice) = in_metal(cos_theta, eta, k);
    let (near, across) = (sum + c2, c2 * sum + s2 * s2);
    (near - twice) * across / ((near + twice) * (across + twice * s2))
}

/// NaN unless in [0, 1].
#[inline(always)]
pub fn cosine<V: Lanes>(c: V) -> V {
    super::in_unit(c)
}

/// The largest index and extinction, and one over the smallest index: their fourth powers are numbers in single.
const LARGEST: f64 = 1e9;

/// NaN unless positive and at most 1e9.
#[inline(always)]
pub fn index<V: Lanes>(eta: V) -> V {
    let inside = eta.num(0.0).less(eta) & eta.less_eq(eta.num(LARGEST));
    V::select(inside, eta, eta.like(V::Elem::NAN))
}

/// NaN unless in [0, 1e9].
#[inline(always)]
pub fn extinction<V: Lanes>(k: V) -> V {
    let inside = k.num(0.0).less_eq(k) & k.less_eq(k.num(LARGEST));
    V::select(inside, k, k.like(V::Elem::NAN))
}
