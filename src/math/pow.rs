//! `x^y` through a logarithm of extended precision.
//!
//! The error of `y ln x` is absolute in the exponent, so the logarithm carries a second word: `ln x = h + l` with
//! about 2⁻³⁵ (f32) and 2⁻⁶⁶ (f64) of relative error.

use super::{either, exp_range, exp_sum, fast_two_sum, ln2, minimax, poly, split_positive};
use crate::real::{Lanes, Real};

/// `a · b` as the rounded product and its error, without a fused operation (Dekker 1971, Veltkamp's splitting).
#[inline(always)]
fn two_product<V: Lanes>(a: V, b: V) -> (V, V) {
    let splitter = a.num(if V::Elem::DOUBLE { 134217729.0 } else { 4097.0 });
    let split = |v: V| {
        let c = v * splitter;
        let high = c - (c - v);
        (high, v - high)
    };
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

/// `ln x` in two words, for positive finite `x`.
#[inline(always)]
fn ln_extended<V: Lanes>(x: V) -> (V, V) {
    let (m, e) = split_positive(x);
    let (high, low) = ln2(x);
    let (one, two) = (x.num(1.0), x.num(2.0));
    // s = (m - 1) / (m + 1) with its remainder; m + 1 alone is rounded above, by an error known exactly.
    let f = m - one;
    let d = m + one;
    let s = f / d;
    let (p, pe) = two_product(s, d);
    let sl = (((f - p) - pe) - s * (m - (d - one))) / d;

    // ln m = 2s + ⅔ s³ + …
    let (sum, e1) = fast_two_sum(e * high, two * s);
    // The cubic term needs two words as well.
    let (z, ze) = two_product(s, s);
    let zl = ze + two * s * sl;
    let (c, ce) = two_product(z, s);
    let cl = ce + (z * sl + zl * s);
    let (th, tl) = (
        either(x, 0.6666666865348816, 0.6666666666666666),
        either(x, -1.986821492305628e-08, 3.700743415417188e-17),
    );
    let (t, te) = two_product(c, th);
    let rest = te + (c * tl + cl * th) + (two * sl + c * z * poly(z, minimax::LN_EXTENDED));
    let (sum, e2) = fast_two_sum(sum, t);
    fast_two_sum(sum, (e1 + e2) + rest + e * low)
}

/// Whether `a`, not negative, is integral. From 2^(mantissa bits) on every number is.
#[inline(always)]
fn integral<V: Lanes>(a: V) -> V::Mask {
    let big = a.like(V::Elem::of(1.0) / V::Elem::EPSILON);
    big.less_eq(a) | ((a + big) - big).equal(a)
}

/// `x^y`. A negative base takes integral exponents only and gives NaN for others; zeros, infinities and
/// `pow(x, 0) = pow(1, y) = 1` are C99's.
#[inline(always)]
pub fn pow<V: Lanes>(x: V, y: V) -> V {
    let (zero, one) = (x.num(0.0), x.num(1.0));
    let infinity = x.like(V::Elem::INFINITY);
    let a = x.abs();
    // Exponents this large overflow or vanish for every base but one, whose logarithm is zero.
    let limit = either(y, (1u64 << 34) as f64, (1u64 << 63) as f64);
    let exponent = limit.min((-limit).max(y));
    let (h, l) = ln_extended(a);
    let (p, pe) = two_product(exponent, h);
    let (lowest, highest) = exp_range(x);
    let within = lowest.less_eq(p) & p.less_eq(highest);
    let tail = V::select(within, pe + exponent * l, zero);
    let power = exp_sum(highest.min(lowest.max(p)), tail);

    // Zero and infinity have no logarithm here.
    let grows = zero.less(y);
    let power = V::select(a.equal(zero), V::select(grows, zero, infinity), power);
    let power = V::select(a.equal(infinity), V::select(grows, infinity, zero), power);
    // The sign of a negative base (-0 and -infinity too) stays where the exponent is odd.
    let whole = integral(y.abs());
    let odd = whole & !integral(y.abs() * y.num(0.5));
    let power = power.copysign(V::select(odd, x, one));
    let undefined = x.less(zero) & !whole & a.less(infinity);
    let valid = x.equal(x) & y.equal(y) & !undefined;
    let power = V::select(valid, power, x.like(V::Elem::NAN));
    V::select(y.equal(zero) | x.equal(one), one, power)
}
