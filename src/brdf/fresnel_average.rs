//! The part of diffuse light that an interface reflects: twice the integral of F(c) c over [0, 1].
//!
//! In closed form for clear bodies and for Schlick's polynomial; metals, and bodies whose index is near one (where the
//! closed form is a difference of large numbers), by Gauss and Legendre's quadrature of 32 points.
//!
//! W. G. Egan, T. Hilgeman, J. Reichman, *Determination of absorption and scattering coefficients for nonhomogeneous
//! media*, 1973; S. Q. Duntley, *The optical properties of diffusing materials*, 1942.

use super::fresnel::{fresnel_conductor, fresnel_dielectric};
use crate::math;
use std::sync::OnceLock;

const POINTS: usize = 32;

/// Nodes and weights on [0, 1], by Newton's iteration for the roots of Legendre's polynomial.
pub fn gauss_legendre() -> &'static [(f64, f64); POINTS] {
    static NODES: OnceLock<[(f64, f64); POINTS]> = OnceLock::new();
    NODES.get_or_init(|| {
        std::array::from_fn(
            #[inline(always)]
            |i| {
                let n = POINTS as f64;
                let mut x = math::cos(std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5));
                let mut slope = 1.0;
                for _ in 0..8 {
                    let (mut p, mut before) = (1.0, 0.0);
                    for k in 0..POINTS {
                        let k = k as f64;
                        (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
                    }
                    slope = n * (x * p - before) / (x * x - 1.0);
                    x -= p / slope;
                }
                (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
            },
        )
    })
}

#[inline(always)]
fn quadrature(f: impl Fn(f64) -> f64) -> f64 {
    gauss_legendre()
        .iter()
        .map(
            #[inline(always)]
            |&(x, w)| w * f(x),
        )
        .sum()
}

/// Of a clear body of relative index `eta`, in double.
pub fn fresnel_average_dielectric(eta: f64) -> f64 {
    if !(eta > 0.0 && eta.is_finite()) {
        return f64::NAN;
    }
    if eta < 1.0 {
        // What comes out of a body is what goes in, by the square of the index.
        return 1.0 - (1.0 - fresnel_average_dielectric(1.0 / eta)) * eta * eta;
    }
    let n = eta;
    if n < 1.02 {
        // c = b sinh t would resolve the bend at c ~ √(n² − 1); c = x⁴ gathers points there well enough.
        return quadrature(
            #[inline(always)]
            |x| {
                let c = x * x * x * x;
                8.0 * x * x * x * c * fresnel_dielectric(c, n).average()
            },
        );
    }
    let (n2, n4) = (n * n, n * n * n * n);
    let (sum, difference) = (n2 + 1.0, n4 - 1.0);
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
        + n2 * (n2 - 1.0) * (n2 - 1.0) / (sum * sum * sum) * math::ln((n - 1.0) / (n + 1.0))
        - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / (sum * difference)
        + 8.0 * n4 * (n4 + 1.0) / (sum * difference * difference) * math::ln(n)
}

/// Of a metal of index η + ik, in double.
pub fn fresnel_average_conductor(eta: f64, k: f64) -> f64 {
    if !(eta > 0.0 && k >= 0.0) {
        return f64::NAN;
    }
    if eta < 1.0 {
        // Where little is absorbed all is reflected below the critical angle, with a bend there: points gather on both
        // sides of it, and at grazing.
        let critical = ((1.0 - eta) * (1.0 + eta)).sqrt();
        let term = |c: f64| 2.0 * c * fresnel_conductor(c, eta, k).average();
        let below = quadrature(
            #[inline(always)]
            |x| critical * 6.0 * x * (1.0 - x) * term(critical * x * x * (3.0 - 2.0 * x)),
        );
        let rest = 1.0 - critical;
        return below
            + quadrature(
                #[inline(always)]
                |x| rest * 2.0 * x * term(critical + rest * x * x),
            );
    }
    // The bend near grazing is the sharper the larger the index: c = x² resolves it.
    quadrature(
        #[inline(always)]
        |x| 4.0 * x * x * x * fresnel_conductor(x * x, eta, k).average(),
    )
}
