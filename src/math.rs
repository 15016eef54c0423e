//! Elementary functions, one straight line each, for a scalar or SIMD lanes, in f32 and f64.
//!
//! The standard library's functions differ between systems and do not vectorise; these give the same bits on every
//! machine, in a scalar loop, in lanes and at each SIMD level, since nothing is fused and nothing branches.
//! Arguments are reduced exactly or with a remainder carried along, then go through minimax polynomials ([`minimax`]).
//!
//! Largest error in ulps (units of the last place of the exact result; of one argument in f32 measured over every
//! float, else over 10⁷ random arguments and beside hard cases):
//!
//! | function | domain | f32 | f64 |
//! |---|---|---|---|
//! | sin, cos | \|x\| ≤ 10⁵ (f32), 10⁶ (f64); NaN beyond | 1.57 | 1.50 |
//! | tan | the same | 3.28 | 3.09 |
//! | asin | [-1, 1] | 1.70 | 1.66 |
//! | acos | [-1, 1] | 1.20 | 1.14 |
//! | exp | all | 0.78 | 0.77 |
//! | ln | all | 0.84 | 0.83 |
//! | atan2 | all | 1.85 | 1.93 |
//! | pow | all | 0.79 | 1.46 |
//! | sin, cos of turns | \|x\| < 2²¹ (f32), 2⁵⁰ (f64) | 1.98 | 1.90 |
//!
//! NaN gives NaN (but `pow(x, 0) = pow(1, y) = 1` as in C99), and infinities and signed zeros are C99's.
//!
//! W. Cody, W. Waite, *Software Manual for the Elementary Functions*, 1980 (reduction of the argument in parts);
//! T. Dekker, *A floating-point technique for extending the available precision*, 1971 (products with remainder).

mod erf;
pub mod exact;
mod map;
mod minimax;
mod pow;
#[cfg(test)]
mod tests;

pub use erf::{bell, inverse_bell};
pub use map::{Binary, Unary, binary, unary};
pub use pow::pow;

use crate::real::{Lanes, Real};

/// `c[0] + c[1] x + …` with the coefficients of this precision.
#[inline(always)]
fn poly<V: Lanes>(x: V, (single, double): (&[f64], &[f64])) -> V {
    let c = if V::Elem::DOUBLE { double } else { single };
    let mut sum = x.num(c[c.len() - 1]);
    for &c in c[..c.len() - 1].iter().rev() {
        sum = sum * x + x.num(c);
    }
    sum
}

/// [`poly`], even and odd powers apart.
#[inline(always)]
fn poly_halves<V: Lanes>(x: V, (single, double): (&[f64], &[f64])) -> V {
    let c = if V::Elem::DOUBLE { double } else { single };
    let (square, last) = (x * x, c.len() - 1);
    let (mut this, mut other) = (x.num(c[last]), x.num(c[last - 1]));
    let mut k = last - 1;
    while k > 0 {
        k -= 1;
        (this, other) = (other, this * square + x.num(c[k]));
    }
    other + this * x
}

/// One constant for f32, another for f64.
#[inline(always)]
fn either<V: Lanes>(x: V, single: f64, double: f64) -> V {
    x.num(if V::Elem::DOUBLE { double } else { single })
}

/// `a + b` as the rounded sum and its error, for `|a| ≥ |b|` or where the sum is exact.
#[inline(always)]
fn fast_two_sum<V: Lanes>(a: V, b: V) -> (V, V) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// π/2 in parts so short that their products with the quadrant's number are exact; the last is rounded.
const HALF_PI_SINGLE: [f64; 6] = [
    1.5703125,
    0.0004825592041015625,
    1.2665987014770508e-06,
    9.89530235528946e-10,
    2.5579538487363607e-12,
    5.390302858158119e-15,
];
const HALF_PI_DOUBLE: [f64; 4] =
    [1.5707963267341256, 6.077100506303966e-11, 2.0222662487111665e-21, 8.4784276603689e-32];

/// The quadrant of `x` in {-2, …, 2} and the remainder in [-π/4, π/4], relatively accurate even beside multiples of
/// π/2. NaN beyond |x| = 10⁵ (f32: 16-bit multiples) or 10⁶ (f64: 20-bit multiples).
#[inline(always)]
fn quadrant<V: Lanes>(x: V) -> (V, V) {
    let inside = x.abs().less_eq(either(x, 1e5, 1e6));
    let x = V::select(inside, x, x.like(V::Elem::NAN));
    let n = (x * x.num(std::f64::consts::FRAC_2_PI)).round();
    // The leading parts leave exact differences; from then on the rounding errors are kept and added at last.
    let (exact, parts): (usize, &[f64]) =
        if V::Elem::DOUBLE { (1, &HALF_PI_DOUBLE) } else { (2, &HALF_PI_SINGLE) };
    let (rest, last) = parts.split_at(parts.len() - 1);
    let mut r = x;
    for &part in &rest[..exact] {
        r = r - n * x.num(part);
    }
    let mut error = x.num(0.0);
    for &part in &rest[exact..] {
        let (sum, lost) = fast_two_sum(r, -(n * x.num(part)));
        (r, error) = (sum, error + lost);
    }
    r = r + (error - n * x.num(last[0]));
    // Keeps the sign of -0.
    let r = V::select(n.equal(x.num(0.0)), x, r);
    (n - (n * x.num(0.25)).round() * x.num(4.0), r)
}

/// The sine and the cosine of an angle within an eighth of a turn of zero.
#[inline(always)]
pub fn sin_cos_octant<V: Lanes>(r: V) -> (V, V) {
    let (z, one) = (r * r, r.num(1.0));
    let s = (r + r * z * poly(z, minimax::SIN)).copysign(r);
    // 1 - z/2 with the digits that its rounding drops.
    let half = z * r.num(0.5);
    let w = one - half;
    (s, w + ((one - w - half) + z * z * poly(z, minimax::COS)))
}

/// The sine and the cosine of `r` in a quadrant of {-2, …, 2}.
#[inline(always)]
fn turned<V: Lanes>(q: V, r: V) -> (V, V) {
    let (s, c) = sin_cos_octant(r);
    let one = q.num(1.0);
    let swapped = q.abs().equal(one);
    let opposite = q.abs().equal(q.num(2.0));
    let (sin, cos) = (V::select(swapped, c, s), V::select(swapped, s, c));
    (V::select(opposite | q.equal(-one), -sin, sin), V::select(opposite | q.equal(one), -cos, cos))
}

/// The sine and the cosine of an angle in radians.
#[inline(always)]
pub fn sin_cos<V: Lanes>(x: V) -> (V, V) {
    let (q, r) = quadrant(x);
    turned(q, r)
}

/// The sine and the cosine of an angle in turns, which needs no π to be reduced; quarters of a turn are exact.
///
/// For |x| below 2²¹ (f32) and 2⁵⁰ (f64).
#[inline(always)]
pub fn sin_cos_turns<V: Lanes>(x: V) -> (V, V) {
    let n = (x * x.num(4.0)).round();
    // The difference is exact; zero keeps its sign.
    let r = V::select(n.equal(x.num(0.0)), x, x - n * x.num(0.25));
    turned(n - (n * x.num(0.25)).round() * x.num(4.0), r * x.num(2.0 * std::f64::consts::PI))
}

#[inline(always)]
pub fn sin<V: Lanes>(x: V) -> V {
    sin_cos(x).0
}

#[inline(always)]
pub fn cos<V: Lanes>(x: V) -> V {
    sin_cos(x).1
}

#[inline(always)]
pub fn tan<V: Lanes>(x: V) -> V {
    let (s, c) = sin_cos(x);
    s / c
}

/// ln 2 as a part whose product with an exponent is exact, and the rest.
#[inline(always)]
fn ln2<V: Lanes>(x: V) -> (V, V) {
    (
        either(x, 0.693145751953125, 0.693147180559663),
        either(x, 1.4286068203094173e-06, 2.8235290563031577e-13),
    )
}

/// Where `exp` is infinite above and zero below.
#[inline(always)]
fn exp_range<V: Lanes>(x: V) -> (V, V) {
    (either(x, -104.0, -745.2), either(x, 89.0, 710.0))
}

/// `exp(x + tail)` for `x` within [`exp_range`] and `tail` of the order of its rounding error.
#[inline(always)]
fn exp_sum<V: Lanes>(x: V, tail: V) -> V {
    let (high, low) = ln2(x);
    let n = (x * x.num(std::f64::consts::LOG2_E)).round();
    let (r, lost) = fast_two_sum(x - n * high, -(n * low));
    let (r, lost) = fast_two_sum(r, tail + lost);
    let (w, rounded) = fast_two_sum(x.num(1.0), r);
    let e = w + (rounded + (r * r * poly(r, minimax::EXP) + lost));
    // 2^n in two factors, each normal, so that results may be subnormal.
    let half = (n * x.num(0.5)).round();
    e * V::exp2i(half) * V::exp2i(n - half)
}

#[inline(always)]
pub fn exp<V: Lanes>(x: V) -> V {
    let (lowest, highest) = exp_range(x);
    // In this order of arguments NaN survives.
    exp_sum(highest.min(lowest.max(x)), x.num(0.0))
}

/// `x = m · 2^e` with `m` in [√½, √2), for positive finite numbers, subnormal ones too.
#[inline(always)]
fn split_positive<V: Lanes>(x: V) -> (V, V) {
    let tiny = x.less(x.like(V::Elem::MIN_POSITIVE));
    let (m, e) = V::select(tiny, x * x.num((1u64 << 54) as f64), x).split_exponent();
    (m, V::select(tiny, e - x.num(54.0), e))
}

/// The natural logarithm.
#[inline(always)]
pub fn ln<V: Lanes>(x: V) -> V {
    // ln m = 2 artanh s = f - f²/2 + s (f²/2 + …) with f = m - 1, s = f / (2 + f): f is exact and leads the sum.
    let (m, e) = split_positive(x);
    let (high, low) = ln2(x);
    let f = m - x.num(1.0);
    let s = f / (f + x.num(2.0));
    let (z, half) = (s * s, f * f * x.num(0.5));
    let tail = s * (half + z * poly(z, minimax::LN)) + e * low;
    let inside = e * high + (f - (half - tail));

    let zero = x.num(0.0);
    let infinity = x.like(V::Elem::INFINITY);
    let outside = V::select(x.equal(zero), -infinity, x.like(V::Elem::NAN));
    let result = V::select(zero.less(x), inside, outside);
    V::select(x.equal(infinity), infinity, result)
}

/// `k π/4` for k in {0, 1, 2, 3, 4}, as a part exact in its product with k, and the rest.
#[inline(always)]
fn quarter_pi<V: Lanes>(k: V) -> (V, V) {
    (
        k * either(k, 0.785398006439209, std::f64::consts::FRAC_PI_4),
        k * either(k, 1.5695823932524066e-07, 3.0616169978683824e-17),
    )
}

/// The angle of the vector (x, y) to the x axis, in [-π, π].
#[inline(always)]
pub fn atan2<V: Lanes>(y: V, x: V) -> V {
    let (zero, one) = (x.num(0.0), x.num(1.0));
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ax.less(ay);
    let (num, den) = (V::select(steep, ax, ay), V::select(steep, ay, ax));
    // Infinity over infinity is one; a finite number over infinity is zero.
    let infinite = den.equal(x.like(V::Elem::INFINITY));
    let num = V::select(infinite & num.less(den), zero, num);
    let (num, den) = (V::select(infinite & num.equal(den), one, num), V::select(infinite, one, den));
    // num + den must not overflow.
    let scale = V::select(x.like(V::Elem::MAX / V::Elem::of(4.0)).less(den), x.num(0.25), one);
    let (num, den) = (num * scale, den * scale);

    // t = num / den within tan(π/8), or turned back by π/4.
    let turned = (den * x.num(0.41421356)).less(num);
    let top = V::select(turned, num - den, num);
    let t = top / V::select(turned, num + den, den);
    let t = V::select(top.equal(zero), zero, t);
    let z = t * t;
    let cubed = t * z * poly(z, minimax::ATAN);

    // Unfold the eighth: atan(num / den) is k π/4 + atan t, then mirrored at the diagonal and at the y axis.
    let k = V::select(turned, one, zero);
    let (k, flip) = (V::select(steep, x.num(2.0) - k, k), V::select(steep, -one, one));
    let left = one.copysign(x).less(zero);
    let (k, flip) = (V::select(left, x.num(4.0) - k, k), V::select(left, -flip, flip));
    let (high, low) = quarter_pi(k);
    let angle = high + (flip * t + (flip * cubed + low));
    let valid = x.equal(x) & y.equal(y);
    V::select(valid, angle.copysign(y), x.like(V::Elem::NAN))
}

/// [`atan2`] of `y ≥ 0`, both finite and not huge, in [0, π]: what is asked of the sine and cosine of an angle between
/// vectors. No special cases, and two chains of half the length: in a long line of dependent steps it takes half the
/// time. NaN for two zeros.
#[inline(always)]
pub fn angle<V: Lanes>(y: V, x: V) -> V {
    let (zero, one, ax) = (x.num(0.0), x.num(1.0), x.abs());
    let steep = ax.less(y);
    let (num, den) = (V::select(steep, ax, y), V::select(steep, y, ax));
    let turned = (den * x.num(0.41421356)).less(num);
    let t = V::select(turned, num - den, num) / V::select(turned, num + den, den);
    let z = t * t;
    let cubed = t * z * poly_halves(z, minimax::ATAN);
    // As in `atan2`.
    let k = V::select(turned, one, zero);
    let (k, flip) = (V::select(steep, x.num(2.0) - k, k), V::select(steep, -one, one));
    let left = x.less(zero);
    let (k, flip) = (V::select(left, x.num(4.0) - k, k), V::select(left, -flip, flip));
    let (high, low) = quarter_pi(k);
    high + (flip * t + (flip * cubed + low))
}

/// `asin(a)` for `a` in [0, ½] as `a` and the rest.
#[inline(always)]
fn asin_small<V: Lanes>(a: V) -> V {
    let z = a * a;
    a * z * poly(z, minimax::ASIN)
}

/// The angle in [0, π] of that cosine; NaN beyond [-1, 1].
#[inline(always)]
pub fn acos<V: Lanes>(x: V) -> V {
    // Beyond ½: acos a = 2 asin √((1 - a)/2), whose argument is exact; within: π/2 - asin x.
    let (a, zero, half) = (x.abs(), x.num(0.0), x.num(0.5));
    let outer = half.less(a);
    let root = ((x.num(1.0) - a) * half).sqrt();
    let t = V::select(outer, root, a);
    let rest = asin_small(t);
    let negative = x.less(zero);
    // k π/4 + flip · (t + rest)
    let k = V::select(outer, V::select(negative, x.num(4.0), zero), x.num(2.0));
    let two = V::select(outer, x.num(2.0), x.num(1.0));
    // (outer, positive): +2; (outer, negative): -2; (inner, positive): -1; (inner, negative): +1.
    let plus = (outer & !negative) | (!outer & negative);
    let flip = V::select(plus, two, -two);
    let (high, low) = quarter_pi(k);
    high + (flip * t + (flip * rest + low))
}

/// The angle in [-π/2, π/2] of that sine; NaN beyond [-1, 1].
#[inline(always)]
pub fn asin<V: Lanes>(x: V) -> V {
    let (a, half) = (x.abs(), x.num(0.5));
    let outer = half.less(a);
    let t = V::select(outer, ((x.num(1.0) - a) * half).sqrt(), a);
    let rest = asin_small(t);
    let (high, low) = quarter_pi(x.num(2.0));
    let two = x.num(2.0);
    let folded = high - (two * t + (two * rest - low));
    V::select(outer, folded, t + rest).copysign(x)
}
