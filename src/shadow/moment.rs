//! Moment shadow maps: from four moments of depth, the least share that must lie before the receiver.
//!
//! Of all distributions with the moments b₁ … b₄, one with three depths of which `t` is one has the least share before
//! t (Hamburger's problem). If depth is known to lie in [-1, 1] and one of the others does not, one with four depths,
//! −1 and 1 among them, is the least (Hausdorff's problem; M. Krein, A. Nudelman, *The Markov Moment Problem*, 1977).
//!
//! The other depths z of Hamburger's are the roots of (1, z, z²) B⁻¹ (1, t, t²)ᵀ, where B is the matrix of moments; the
//! free depth of Hausdorff's is E[q(z) z] / E[q(z)] with q(z) = (z + 1)(1 − z)(z − t). The share is the mean of the
//! polynomial that is 1 at the depths before t and 0 at the others. In Newton's form about the depths on one side it
//! divides by distances from t alone: two depths before t that rounding cannot tell apart do no harm, as they would to
//! the sum of their weights.
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

/// What must lie before `t`: its share, and the mean of its depths (`t` where there is none).
#[derive(Clone, Copy)]
pub struct Before<V> {
    pub share: V,
    pub depth: V,
}

/// The least that lies before a depth t, of distributions with these moments. `noise` is what they are known to but for
/// rounding.
#[inline(always)]
pub fn before<V: Lanes>(b: [V; 4], t: V, support: Support, noise: V) -> Before<V> {
    let one = t.num(1.0);
    let [low, high] = roots(b, t);
    let free = among(b, t, low, high);
    let out = low.less(-one) | one.less(high);
    if support == Support::Hamburger || V::bits(out) == 0 {
        return free;
    }
    let found = bounded(b, t, noise);
    Before { share: V::select(out, found.share, free.share), depth: V::select(out, found.depth, free.depth) }
}

/// Of Hamburger's distribution over `low`, `high` and t.
#[inline(always)]
fn among<V: Lanes>(b: [V; 4], t: V, low: V, high: V) -> Before<V> {
    let (zero, one) = (t.num(0.0), t.num(1.0));
    let both = high.less(t);
    // The weight of t where both are before it, or of the lower one.
    let at = V::select(both, t, low);
    let (u, v) = (V::select(both, low, t), high);
    let weight = unit((b[1] - b[0] * (u + v) + u * v) / ((at - u) * (at - v)));
    let share = V::select(both, one - weight, V::select(low.less(t), weight, zero));
    let mean = V::select(both, (b[0] - t * weight) / share, low);
    Before { share, depth: V::select(zero.less(share), mean, t) }
}

/// Into [-`most`, `most`]; NaN stays.
#[inline(always)]
fn limited<V: Lanes>(x: V, most: V) -> V {
    V::select(x.equal(x), x.max(-most).min(most), x)
}

/// Into [0, 1], and 0 for what is no number: nothing is known then.
#[inline(always)]
fn unit<V: Lanes>(x: V) -> V {
    let (zero, one) = (x.num(0.0), x.num(1.0));
    V::select(x.equal(x), x.max(zero).min(one), zero)
}

/// The two other depths of Hamburger's distribution.
#[inline(always)]
fn roots<V: Lanes>(b: [V; 4], t: V) -> [V; 2] {
    let one = t.num(1.0);
    // B = L D Lᵀ, with d1 the variance, d2 what is left of the variance of the square.
    let tiny = t.like(V::Elem::EPSILON * V::Elem::EPSILON);
    let d1 = (b[1] - b[0] * b[0]).max(tiny);
    let per = one / d1;
    let l = (b[2] - b[0] * b[1]) * per;
    let d2 = (b[3] - b[1] * b[1] - l * l * d1).max(tiny);
    // c = B⁻¹ (1, t, t²).
    let y1 = t - b[0];
    let y2 = t * t - b[1] - l * y1;
    // Scaled by d2, which leaves the roots as they are.
    let c2 = y2;
    let c1 = y1 * (d2 * per) - l * c2;
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

/// Of Hausdorff's distribution over {-1, t, z, 1}.
#[inline(always)]
fn bounded<V: Lanes>(b: [V; 4], t: V, noise: V) -> Before<V> {
    let (zero, one, two) = (t.num(0.0), t.num(1.0), t.num(2.0));
    // q(z) = (1 − z²)(z − t) = −t + z + t z² − z³.
    let mean = -t + b[0] + t * b[1] - b[2];
    let with_z = -t * b[0] + b[1] + t * b[2] - b[3];
    // If nothing is left of q but noise, all lies at −1, t and 1, and z is free: 1 gives a bound whatever the moments.
    let free = with_z / mean;
    let known = (noise.less(mean) | mean.less(-noise)) & free.equal(free);
    let z = V::select(known, limited(free, one), one);
    let nearer = z.less(t);
    // E[(X + 1)(X − z)], E[(X + 1)(X − z)(X − t)], E[(X − t)(X − z)(X − 1)].
    let two_points = b[1] + b[0] * (one - z) - z;
    let cubic = b[2] + b[1] * (one - z - t) - b[0] * (z + t * (one - z)) + z * t;
    let others = b[2] - b[1] * (one + z + t) + b[0] * (z + t + z * t) - z * t;
    // One less the polynomial that is 0 at −1 and z and 1 at t and 1, or that which is 1 at −1 alone.
    let rest = two * (one - z);
    let part = V::select(nearer, (two + t - z) * cubic - rest * two_points, -others);
    let scale = one / V::select(nearer, rest * (t + one) * (t - z), two * (one + t) * (one + z));
    let whole = V::select(nearer, one, zero);
    let share = whole + part * scale;
    // What noise does by way of z: its error, noise / |mean|, times z's weight, times the polynomial's slope there. An
    // eighth of this worst case is granted, and all of what it does otherwise.
    let by_z = t.num(0.25) / (t - z) + t.num(0.25) * (two + t - z) / rest;
    let granted = noise * scale * V::select(nearer, rest + by_z, one);
    let sum = b[0] + ((t + z) * cubic - t * rest * two_points) * scale;
    let depth = V::select(nearer, (sum / share).max(-one).min(t), -one);
    let share = unit(V::select((-one).less(t), share - granted, zero));
    Before { share, depth: V::select(zero.less(share), depth, t) }
}

/// What moments are off by at least: as the bias is chosen by their rounding, so much as it.
#[inline(always)]
pub fn noise<T: Real>(alpha: f64) -> f64 {
    alpha.max(4.0 * T::EPSILON.to_f64()).min(1e-4)
}

/// The least share before `t`, and so one less the most that is lit; moments are drawn by `alpha` towards `target`. In
/// double, whatever the moments': three differences in a row leave little of single precision.
#[inline(always)]
pub fn moment_bound<T: Real>(m: [T; 4], t: T, support: Support, alpha: f64, target: f64) -> T {
    let (m, t) = ([m[0].to_f64(), m[1].to_f64(), m[2].to_f64(), m[3].to_f64()], t.to_f64());
    if (m[0] + m[1] + m[2] + m[3] + t).is_nan() {
        return T::NAN;
    }
    // All of [-1, 1] is before what is beyond it.
    if support == Support::Hausdorff && t > 1.0 {
        return T::one();
    }
    let t = limited(t, FAR);
    T::of(before(biased(m, alpha, target), t, support, noise::<T>(alpha)).share)
}

/// Farther is no different, and its powers are numbers.
const FAR: f64 = 1e70;
