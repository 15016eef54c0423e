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
pub fn biased<V: Lanes>(b: [V; 4], alpha: V, target: V) -> [V; 4] {
    let keep = alpha.num(1.0) - alpha;
    [b[0] * keep, b[1] * keep + alpha * target, b[2] * keep, b[3] * keep + alpha * target]
}

/// The distribution with the least share before `t`: up to three depths beside t (in order), and their weights. Those
/// that are not needed have weight 0.
#[derive(Clone, Copy)]
pub struct Extremal<V> {
    pub depths: [V; 3],
    pub weights: [V; 3],
}

impl<V: Lanes> Extremal<V> {
    /// The share before `t`, and the mean of its depths times that share.
    #[inline(always)]
    pub fn before(&self, t: V) -> (V, V) {
        let zero = t.num(0.0);
        let (mut share, mut depth) = (zero, zero);
        for k in 0..3 {
            let before = self.depths[k].less(t);
            share = share + V::select(before, self.weights[k], zero);
            depth = depth + V::select(before, self.weights[k] * self.depths[k], zero);
        }
        (share, depth)
    }
}

/// The extremal distribution of moments about a depth t.
#[inline(always)]
pub fn extremal<V: Lanes>(b: [V; 4], t: V, support: Support) -> Extremal<V> {
    let (zero, one) = (t.num(0.0), t.num(1.0));
    let [low, high] = roots(b, t);
    let free = Extremal {
        depths: [low, high, high],
        weights: [lagrange(b, low, t, high), lagrange(b, high, t, low), zero],
    };
    let out = low.less(-one) | one.less(high);
    if support == Support::Hamburger || V::bits(out) == 0 {
        return free;
    }
    let mut found = bounded(b, t);
    for k in 0..3 {
        found.depths[k] = V::select(out, found.depths[k], free.depths[k]);
        found.weights[k] = V::select(out, found.weights[k], free.weights[k]);
    }
    found
}

/// E[(z − u)(z − v)] / ((x − u)(x − v)).
#[inline(always)]
fn lagrange<V: Lanes>(b: [V; 4], x: V, u: V, v: V) -> V {
    let share = (b[1] - b[0] * (u + v) + u * v) / ((x - u) * (x - v));
    unit(share)
}

/// E[(z − u)(z − v)(z − w)] / ((x − u)(x − v)(x − w)).
#[inline(always)]
fn lagrange_3<V: Lanes>(b: [V; 4], x: V, u: V, v: V, w: V) -> V {
    let (s, p, o) = (u + v + w, u * v + u * w + v * w, u * v * w);
    unit((b[2] - s * b[1] + p * b[0] - o) / ((x - u) * (x - v) * (x - w)))
}

/// Into [-`most`, `most`]; NaN stays.
#[inline(always)]
fn limited<V: Lanes>(x: V, most: V) -> V {
    V::select(x.equal(x), x.max(-most).min(most), x)
}

/// Into [0, 1]; NaN stays.
#[inline(always)]
fn unit<V: Lanes>(x: V) -> V {
    V::select(x.equal(x), x.max(x.num(0.0)).min(x.num(1.0)), x)
}

/// The two other depths of Hamburger's distribution.
#[inline(always)]
fn roots<V: Lanes>(b: [V; 4], t: V) -> [V; 2] {
    let one = t.num(1.0);
    // B = L D Lᵀ, with d1 the variance, d2 what is left of the variance of the square.
    let tiny = t.like(V::Elem::EPSILON * V::Elem::EPSILON);
    let d1 = (b[1] - b[0] * b[0]).max(tiny);
    let l = (b[2] - b[0] * b[1]) / d1;
    let d2 = (b[3] - b[1] * b[1] - l * l * d1).max(tiny);
    // c = B⁻¹ (1, t, t²).
    let y1 = t - b[0];
    let y2 = t * t - b[1] - l * y1;
    // Scaled by d2, which leaves the roots as they are.
    let c2 = y2;
    let c1 = y1 * (d2 / d1) - l * c2;
    let c0 = d2 - b[0] * c1 - b[1] * c2;
    let half = t.num(0.5) * c1;
    let root = (half * half - c0 * c2).max(t.num(0.0)).sqrt();
    // The root of larger size first, without cancellation; the other by their product. Where a depth vanishes to
    // infinity its weight vanishes too: far away is far enough.
    let q = -(half + root.copysign(half));
    let far = t.num(1e4);
    let (u, v) = (limited(q / c2, far), limited(c0 / q, far));
    let numbers = u.equal(u) & v.equal(v);
    let (low, high) = (V::select(u.less(v), u, v), V::select(u.less(v), v, u));
    [V::select(numbers, low, b[0] - one), V::select(numbers, high, b[0] + one)]
}

/// Hausdorff's distribution over {-1, t, z, 1}.
#[inline(always)]
fn bounded<V: Lanes>(b: [V; 4], t: V) -> Extremal<V> {
    let (zero, one) = (t.num(0.0), t.num(1.0));
    // q(z) = (1 − z²)(z − t) = −t + z + t z² − z³.
    let mean = -t + b[0] + t * b[1] - b[2];
    let with_z = -t * b[0] + b[1] + t * b[2] - b[3];
    let free = with_z / mean;
    let free = V::select(free.equal(free), limited(free, one), b[0]);
    let first = V::select((-one).less(t), lagrange_3(b, -one, t, free, one), zero);
    let last = V::select(t.less(one), lagrange_3(b, one, t, free, -one), zero);
    let middle = V::select(
        (-one).less(free) & free.less(one) & !free.equal(t),
        lagrange_3(b, free, t, -one, one),
        zero,
    );
    Extremal { depths: [-one, free, one], weights: [first, middle, last] }
}

/// The least share before `t`, and so one less the most that is lit; moments are drawn by `alpha` towards `target`. In
/// double, whatever the moments': three differences in a row leave little of single precision.
#[inline(always)]
pub fn moment_bound<T: Real>(m: [T; 4], t: T, support: Support, alpha: f64, target: f64) -> T {
    let (m, t) = ([m[0].to_f64(), m[1].to_f64(), m[2].to_f64(), m[3].to_f64()], t.to_f64());
    if (m[0] + m[1] + m[2] + m[3] + t).is_nan() {
        return T::NAN;
    }
    T::of(unit(extremal(biased(m, alpha, target), t, support).before(t).0))
}
