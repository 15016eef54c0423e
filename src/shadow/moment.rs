//! Moment shadow maps: from four moments of depth, the least share that must lie before the receiver.
//!
//! Of all distributions with the moments b₁ … b₄, one with three depths of which `t` is one has the least share before
//! t (Hamburger's problem). If depth is known to lie in [-1, 1] and one of the others does not, one with four depths,
//! −1 and 1 among them, is the least (Hausdorff's problem; M. Krein, A. Nudelman, *The Markov Moment Problem*, 1977).
//!
//! The other depths z of Hamburger's are the roots of (1, z, z²) B⁻¹ (1, t, t²)ᵀ, where B is the matrix of moments; the
//! free depth of Hausdorff's is E[q(z) z] / E[q(z)] with q(z) = (z + 1)(1 − z)(z − t). Weights are means of Lagrange's
//! polynomials.
//!
//! C. Peters, R. Klein, *Moment Shadow Mapping*, I3D 2015. C. Peters et al., *Improved Moment Shadow Maps for
//! Translucent Occluders, Soft Shadows and Single Scattering*, JCGT 2017 (bias, soft shadows).

use crate::real::{Lanes, Real};

/// What is known of depth: nothing, or that it lies in [-1, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    Hamburger,
    Hausdorff,
}

/// Moments drawn by a share `alpha` towards a distribution that is far from any degenerate one, of second and fourth
/// moment `target`: rounding no longer makes them moments of nothing.
#[inline(always)]
pub fn biased<T: Real>(b: [T; 4], alpha: T, target: T) -> [T; 4] {
    let keep = T::one() - alpha;
    [b[0] * keep, b[1] * keep + alpha * target, b[2] * keep, b[3] * keep + alpha * target]
}

/// The distribution with the least share before `t`: up to three depths beside t (in order), and their weights. Those
/// that are not needed have weight 0.
#[derive(Clone, Copy)]
pub struct Extremal<T> {
    pub depths: [T; 3],
    pub weights: [T; 3],
}

impl<T: Real> Extremal<T> {
    /// The share before `t`, and the mean of its depths times that share.
    #[inline(always)]
    pub fn before(&self, t: T) -> (T, T) {
        let (mut share, mut depth) = (T::zero(), T::zero());
        for k in 0..3 {
            if self.depths[k] < t {
                share += self.weights[k];
                depth += self.weights[k] * self.depths[k];
            }
        }
        (share, depth)
    }
}

/// The extremal distribution of moments about a depth t.
#[inline(always)]
pub fn extremal<T: Real>(b: [T; 4], t: T, support: Support) -> Extremal<T> {
    let one = T::one();
    let [low, high] = roots(b, t);
    if support == Support::Hausdorff && (low < -one || high > one) {
        return bounded(b, t);
    }
    Extremal {
        depths: [low, high, high],
        weights: [lagrange(b, low, t, high), lagrange(b, high, t, low), T::zero()],
    }
}

/// E[(z − u)(z − v)] / ((x − u)(x − v)).
#[inline(always)]
fn lagrange<T: Real>(b: [T; 4], x: T, u: T, v: T) -> T {
    let share = (b[1] - b[0] * (u + v) + u * v) / ((x - u) * (x - v));
    unit(share)
}

/// E[(z − u)(z − v)(z − w)] / ((x − u)(x − v)(x − w)).
#[inline(always)]
fn lagrange_3<T: Real>(b: [T; 4], x: T, u: T, v: T, w: T) -> T {
    let (s, p, o) = (u + v + w, u * v + u * w + v * w, u * v * w);
    unit((b[2] - s * b[1] + p * b[0] - o) / ((x - u) * (x - v) * (x - w)))
}

/// Into [0, 1]; NaN stays.
#[inline(always)]
fn unit<T: Real>(x: T) -> T {
    if x.is_nan() { x } else { Lanes::min(Lanes::max(x, T::zero()), T::one()) }
}

/// The two other depths of Hamburger's distribution.
#[inline(always)]
fn roots<T: Real>(b: [T; 4], t: T) -> [T; 2] {
    let one = T::one();
    // B = L D Lᵀ, with d1 the variance, d2 what is left of the variance of the square.
    let tiny = T::EPSILON * T::EPSILON;
    let d1 = Lanes::max(b[1] - b[0] * b[0], tiny);
    let l = (b[2] - b[0] * b[1]) / d1;
    let d2 = Lanes::max(b[3] - b[1] * b[1] - l * l * d1, tiny);
    // c = B⁻¹ (1, t, t²).
    let y1 = t - b[0];
    let y2 = t * t - b[1] - l * y1;
    // Scaled by d2, which leaves the roots as they are.
    let c2 = y2;
    let c1 = y1 * (d2 / d1) - l * c2;
    let c0 = d2 - b[0] * c1 - b[1] * c2;
    let half = T::of(0.5) * c1;
    let root = Lanes::max(half * half - c0 * c2, T::zero()).sqrt();
    // The root of larger size first, without cancellation; the other by their product.
    let q = -(half + Lanes::copysign(root, half));
    let (u, v) = (limited(q / c2), limited(c0 / q));
    if u.is_nan() || v.is_nan() {
        return [b[0] - one, b[0] + one];
    }
    if u < v { [u, v] } else { [v, u] }
}

/// Where a depth vanishes to infinity its weight vanishes too: far away is far enough.
#[inline(always)]
fn limited<T: Real>(x: T) -> T {
    let far = T::of(1e4);
    if x.is_nan() { x } else { Lanes::min(Lanes::max(x, -far), far) }
}

/// Hausdorff's distribution over {-1, t, z, 1}.
#[inline(always)]
fn bounded<T: Real>(b: [T; 4], t: T) -> Extremal<T> {
    let (zero, one) = (T::zero(), T::one());
    // q(z) = (1 − z²)(z − t) = −t + z + t z² − z³.
    let mean = -t + b[0] + t * b[1] - b[2];
    let with_z = -t * b[0] + b[1] + t * b[2] - b[3];
    let free = with_z / mean;
    let free = if free.is_nan() { b[0] } else { Lanes::min(Lanes::max(free, -one), one) };
    let first = if t > -one { lagrange_3(b, -one, t, free, one) } else { zero };
    let last = if t < one { lagrange_3(b, one, t, free, -one) } else { zero };
    let middle =
        if free > -one && free < one && free != t { lagrange_3(b, free, t, -one, one) } else { zero };
    Extremal { depths: [-one, free, one], weights: [first, middle, last] }
}

/// The least share before `t`, and so one less the most that is lit; moments are drawn by `alpha` towards `target`. In double,
/// whatever the moments': three differences in a row leave little of single precision.
#[inline(always)]
pub fn moment_bound<T: Real>(m: [T; 4], t: T, support: Support, alpha: f64, target: f64) -> T {
    let (m, t) = ([m[0].to_f64(), m[1].to_f64(), m[2].to_f64(), m[3].to_f64()], t.to_f64());
    if (m[0] + m[1] + m[2] + m[3] + t).is_nan() {
        return T::NAN;
    }
    T::of(unit(extremal(biased(m, alpha, target), t, support).before(t).0))
}
