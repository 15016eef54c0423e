//! How the normals of microscopic mirrors are distributed: density per solid angle, ∫ D cos = 1.
//!
//! GTR is the family D ∝ (alpha² cos² + sin²)^−γ: γ = 2 is GGX, γ = 1 Berry's, with longer tails; larger γ come near to
//! Beckmann's for small alpha.
//!
//! B. Burley, *Physically based shading at Disney*, 2012, appendix B; P. Beckmann, A. Spizzichino, *The scattering of
//! electromagnetic waves from rough surfaces*, 1963.

use crate::math;
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// The constant of GTR: (γ − 1)(alpha² − 1) / (π (1 − alpha^(2 − 2γ))), by its limits at γ = 1 and alpha = 1.
#[inline(always)]
fn scale<T: Real>(alpha: T, gamma: T) -> T {
    let one = T::one();
    let log = T::of(2.0) * math::ln(alpha);
    // With x = (1 − γ) ln alpha²: (eˣ − 1) / x and (e^{ln alpha²} − 1) / ln alpha².
    growth(log) / (growth((one - gamma) * log) * T::PI)
}

/// (eˣ − 1) / x.
#[inline(always)]
fn growth<T: Real>(x: T) -> T {
    let one = T::one();
    if x.abs() < T::of(0.5) {
        // The series, to double's last digit.
        let mut sum = one;
        for k in (2..19).rev() {
            sum = one + sum * x / T::of(f64::from(k));
        }
        sum
    } else {
        (math::exp(x) - one) / x
    }
}

/// Of exponent `gamma`, at a unit normal above the horizon.
#[inline(always)]
pub fn gtr<T: Real>(normal: Vec3<T>, alpha: T, gamma: T) -> T {
    let width = alpha * alpha * normal.z * normal.z + (normal.x * normal.x + normal.y * normal.y);
    scale(alpha, gamma) * math::exp(-gamma * math::ln(width))
}

/// A unit normal by [`gtr`] times the cosine, for γ = 1.
#[inline(always)]
pub fn gtr1_sample<T: Real>(u: [T; 2], alpha: T) -> Vec3<T> {
    let one = T::one();
    let a2 = alpha * alpha;
    let cos2 = (one - math::exp((one - u[0]) * math::ln(a2))) / (one - a2);
    let cos = Lanes::min(Lanes::max(cos2, T::zero()), one).sqrt();
    let sin = Lanes::max(one - cos2, T::zero()).sqrt();
    let (s, c) = math::sin_cos(T::of(2.0) * T::PI * u[1]);
    Vec3::new(sin * c, sin * s, cos)
}
