//! One metal for many directions: what [`RoughConductor`] gives, with all that does not depend on them worked out before.
//!
//! Fresnel's equations need of the metal the real part a of √(N² − sin²) alone, N its complex index: the absolute value is
//! 2a² − Re(N² − sin²). Where N² is far from one, as of metals, a is nearly a straight line in cos²; a polynomial of few
//! terms stands for it to the last digit of single precision, and two roots a colour are saved. The quotients of D, of the
//! masking and of Fresnel's factor become one a colour. Within 16 rounding units of the model itself.

use super::microfacets::{Masking, Microfacets, Shape};
use super::rough_conductor::RoughConductor;
use crate::real::{Lanes, Real};
use crate::simd::columns::{BLOCK, GROUPS, Sink, Source};
use crate::simd::{Simd, SimdBase};
use crate::vec::Vec3;

/// Terms of the polynomial.
const TERMS: usize = 6;

#[derive(Clone, Copy, Debug)]
pub struct OneMetal<V> {
    /// a as a polynomial of cos², from the constant term on, and Re N² − 1: of each colour.
    root: [[V; TERMS]; 3],
    real: [V; 3],
    /// The tint times the square of alpha over π.
    scale: [V; 3],
    facets: Microfacets<V>,
}

impl OneMetal<f64> {
    /// None where the polynomial is not exact enough, or the facets are others than those it is written for.
    pub fn of<T: Real>(metal: &RoughConductor<T>) -> Option<Self> {
        let RoughConductor { tint, eta, k, facets } = metal;
        let (ax, ay) = (facets.alpha_x.to_f64(), facets.alpha_y.to_f64());
        let smith = matches!(facets.masking, Masking::HeightCorrelated | Masking::Separable);
        // The squares of narrower lobes leave the range of numbers.
        if facets.shape != Shape::Ggx || !smith || !(ax.min(ay) >= 1e-4) || T::DOUBLE {
            return None;
        }
        let (eta, k, tint) = (eta.to_array(), k.to_array(), tint.to_array());
        let mut found = OneMetal {
            root: [[0.0; TERMS]; 3],
            real: [0.0; 3],
            scale: tint.map(|t| t.to_f64() * ax * ay / std::f64::consts::PI),
            facets: Microfacets {
                alpha_x: ax,
                alpha_y: ay,
                ratio: [ay / ax, ax / ay],
                shape: facets.shape,
                masking: facets.masking,
            },
        };
        for c in 0..3 {
            let (eta, k) = (eta[c].to_f64(), k[c].to_f64());
            // Products of the squares of larger ones leave the range of numbers.
            if !(eta * eta + k * k < 1e4) {
                return None;
            }
            found.real[c] = (eta - k) * (eta + k) - 1.0;
            found.root[c] = fitted(|t| refracted(eta, k, t))?;
        }
        Some(found)
    }

    /// The same metal in every lane.
    #[inline(always)]
    pub fn lanes<T: Real, S: Simd>(&self, s: S) -> OneMetal<T::V8<S>> {
        let zero = <T::V8<S> as SimdBase<S>>::splat(s, T::zero());
        let (mut root, mut real, mut scale) = ([[zero; TERMS]; 3], [zero; 3], [zero; 3]);
        for c in 0..3 {
            (real[c], scale[c]) = (zero.num(self.real[c]), zero.num(self.scale[c]));
            for k in 0..TERMS {
                root[c][k] = zero.num(self.root[c][k]);
            }
        }
        let Microfacets { alpha_x, alpha_y, ratio: [ratio, inverse], shape, masking } = self.facets;
        let (alpha_x, alpha_y) = (zero.num(alpha_x), zero.num(alpha_y));
        let ratio = [zero.num(ratio), zero.num(inverse)];
        OneMetal { root, real, scale, facets: Microfacets { alpha_x, alpha_y, ratio, shape, masking } }
    }
}

impl<V: Lanes> OneMetal<V> {
    /// D / (4 cos θi cos θo) G but for a factor of `scale`, zero unless both directions are above the horizon; and the
    /// cosine at the half vector.
    #[inline(always)]
    fn facets(&self, wi: Vec3<V>, wo: Vec3<V>) -> [V; 2] {
        let (half, zero, one) = (wi + wo, wi.z.num(0.0), wi.z.num(1.0));
        let squared = half.length_squared();
        let across = half.x * half.x * self.facets.ratio[0] + half.y * half.y * self.facets.ratio[1];
        let peak = squared / (self.facets.alpha_x * self.facets.alpha_y * half.z * half.z + across);
        let share = peak * peak / self.facets.four_smith(wi, wo);
        let share = V::select(super::apart(wi, wo), zero, share);
        [share, (squared.sqrt() * zero.num(0.5)).min(one)]
    }

    /// The BRDF of a colour, from what [`OneMetal::facets`] gave.
    #[inline(always)]
    fn color(&self, k: usize, [share, c]: [V; 2]) -> V {
        let (c2, one) = (c * c, c.num(1.0));
        let s2 = (one - c) * (one + c);
        let [a, b, d, e, f, g] = self.root[k];
        // In pairs, so that little waits for what came before.
        let (c4, first, second, third) = (c2 * c2, a + b * c2, d + e * c2, f + g * c2);
        let a = first + c4 * (second + c4 * third);
        let near = (a + a) * a - self.real[k];
        let twice = (c + c) * a;
        let across = c2 * (near - c2) + s2 * s2;
        (near - twice) * across * (self.scale[k] * share) / ((near + twice) * (across + twice * s2))
    }
}

impl OneMetal<f64> {
    /// The BRDF over arrays. Facets first, then one colour after the other: short loops, of which the processor has many
    /// rounds under way at once.
    #[inline(always)]
    pub fn eval<T: Real, S: Simd>(&self, s: S, wi: &[[T; 3]], wo: &[[T; 3]], out: &mut [[T; 3]]) {
        let (metal, n, mut at) = (self.lanes::<T, S>(s), out.len(), 0);
        let (mut wi, mut wo, mut out) = (Source::over(wi, 0), Source::over(wo, 0), Sink::over(s, out));
        let mut found = [[metal.real[0]; 2]; GROUPS];
        while at < n {
            wi.load(at);
            wo.load(at);
            for group in 0..GROUPS {
                found[group] = metal.facets(wi.lanes(s, group).into(), wo.lanes(s, group).into());
            }
            for k in 0..3 {
                for group in 0..GROUPS {
                    out.put(s, k, group, metal.color(k, found[group]));
                }
            }
            out.store(at);
            at += BLOCK;
        }
    }
}

/// Re √(N² − 1 + t).
fn refracted(eta: f64, k: f64, t: f64) -> f64 {
    let (real, imaginary) = ((eta - k) * (eta + k) - 1.0 + t, 2.0 * eta * k);
    let larger = (0.5 * ((real * real + imaginary * imaginary).sqrt() + real.abs())).sqrt();
    if real < 0.0 { 0.5 * imaginary / larger } else { larger }
}

/// The polynomial through the values at Chebyshev's points of [0, 1]; None where it is off by more than half a rounding
/// unit of single precision.
fn fitted(f: impl Fn(f64) -> f64) -> Option<[f64; TERMS]> {
    let mut points = [0.0; TERMS];
    for (k, p) in points.iter_mut().enumerate() {
        let angle = std::f64::consts::PI * (k as f64 + 0.5) / TERMS as f64;
        *p = 0.5 + 0.5 * crate::math::cos(angle);
    }
    // Newton's divided differences, then powers.
    let mut slopes = points.map(&f);
    for order in 1..TERMS {
        for k in (order..TERMS).rev() {
            slopes[k] = (slopes[k] - slopes[k - 1]) / (points[k] - points[k - order]);
        }
    }
    let mut terms = [0.0; TERMS];
    for k in (0..TERMS).rev() {
        for t in (1..TERMS).rev() {
            terms[t] = terms[t - 1] - points[k] * terms[t];
        }
        terms[0] = slopes[k] - points[k] * terms[0];
    }
    let close = (0..=16).all(|i| {
        let t = f64::from(i) / 16.0;
        let p = terms.iter().rev().fold(0.0, |sum, c| sum * t + c);
        (p - f(t)).abs() <= 3e-8 * f(t)
    });
    close.then_some(terms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metals_have_their_polynomial_and_glass_has_none() {
        for (eta, k) in [(0.2004, 3.9129), (0.924, 2.4528), (1.1022, 2.1421), (3.1, 3.3), (0.05, 9.0)] {
            let terms = fitted(|t| refracted(eta, k, t)).expect("far from one");
            let at = terms.iter().rev().fold(0.0, |sum, c| sum * 0.3 + c);
            assert!((at / refracted(eta, k, 0.3) - 1.0).abs() < 3e-8);
        }
        assert!(fitted(|t| refracted(0.9, 0.01, t)).is_none());
    }
}
