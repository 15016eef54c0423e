//! Sums and products with the error of their rounding, and powers of two: what tests that must not lose digits are
//! made of. All are exact unless parts overflow or fall below the normal numbers; nothing is fused.
//!
//! T. J. Dekker, *A Floating-Point Technique for Extending the Available Precision*, 1971;
//! D. E. Knuth, *The Art of Computer Programming 2*, section 4.2.2.

use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// `fl(a + b)` and what its rounding lost.
#[inline(always)]
pub fn two_sum<V: Lanes>(a: V, b: V) -> (V, V) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// `fl(a - b)` and what its rounding lost.
#[inline(always)]
pub fn two_difference<V: Lanes>(a: V, b: V) -> (V, V) {
    two_sum(a, -b)
}

/// `fl(a b)` and what its rounding lost.
#[inline(always)]
pub fn two_product<V: Lanes>(a: V, b: V) -> (V, V) {
    (a * b, product_error(a, b))
}

/// `a b - fl(a b)`.
#[inline(always)]
pub fn product_error<V: Lanes>(a: V, b: V) -> V {
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    ((ah * bh - a * b) + ah * bl + al * bh) + al * bl
}

/// `a b - c d`, right to two units of the last place: the rounding errors of the products are carried along.
/// W. Kahan, *On the Cost of Floating-Point Computation Without Extra-Precise Arithmetic*, 2004.
#[inline(always)]
pub fn difference_of_products<V: Lanes>(a: V, b: V, c: V, d: V) -> V {
    (a * b - c * d) + (product_error(a, b) - product_error(c, d))
}

/// The upper and the lower half of a significand: products of such halves are exact.
#[inline(always)]
fn halves<V: Lanes>(x: V) -> (V, V) {
    // 2^ceil(digits / 2) + 1.
    let cutter = if V::Elem::DOUBLE { 134217729.0 } else { 4097.0 };
    let c = x * x.num(cutter);
    let high = c - (c - x);
    (high, x - high)
}

/// The cross product, each component by [`difference_of_products`].
#[inline(always)]
pub fn cross<V: Lanes>(a: Vec3<V>, b: Vec3<V>) -> Vec3<V> {
    Vec3 {
        x: difference_of_products(a.y, b.z, a.z, b.y),
        y: difference_of_products(a.z, b.x, a.x, b.z),
        z: difference_of_products(a.x, b.y, a.y, b.x),
    }
}

/// The sum, right to two units of the last place, whatever cancels; its sign is exact. The errors of all additions
/// are summed along; where the result is so small that theirs could matter, the terms are distilled.
/// T. Ogita, S. M. Rump, S. Oishi, *Accurate Sum and Dot Product*, SIAM Journal on Scientific Computing 26, 2005.
#[inline(always)]
pub fn total<T: Real, const N: usize>(terms: [T; N]) -> T {
    let (mut sum, mut lost, mut size) = (terms[0], T::zero(), terms[0].abs());
    for &x in &terms[1..] {
        let (s, low) = two_sum(sum, x);
        (sum, lost, size) = (s, lost + low, size + x.abs());
    }
    let result = sum + lost;
    if result.abs() > size * T::EPSILON * T::of(N as f64) || !size.is_finite() {
        return result;
    }
    distilled(terms)
}

/// Adds neighbours without error until no two overlap: then the last exceeds all others together.
#[inline(never)]
fn distilled<T: Real, const N: usize>(mut terms: [T; N]) -> T {
    for _ in 0..4 * N {
        let before = terms;
        for i in 1..N {
            (terms[i], terms[i - 1]) = two_sum(terms[i], terms[i - 1]);
        }
        if terms == before {
            break;
        }
    }
    terms[N - 1]
}

/// The scalar product by [`total`].
#[inline(always)]
pub fn dot<T: Real>(a: Vec3<T>, b: Vec3<T>) -> T {
    let [x, y, z] = a.zip(b, |p, q| two_product(p, q)).to_array();
    total([x.0, y.0, z.0, x.1, y.1, z.1])
}

/// The largest magnitude among the components.
#[inline(always)]
pub fn largest<T: Real>(v: Vec3<T>) -> T {
    Lanes::max(Lanes::max(v.x.abs(), v.y.abs()), v.z.abs())
}

/// Whether no component is infinite or NaN.
#[inline(always)]
pub fn all_finite<T: Real>(v: Vec3<T>) -> bool {
    v.x.is_finite() & v.y.is_finite() & v.z.is_finite()
}

/// The exponent `e` of a positive number: it lies in `[√½, √2) 2^e`. Zero and numbers below the normal ones have the
/// least, so that `2^-e` is finite always.
#[inline(always)]
pub fn exponent<T: Real>(x: T) -> T {
    let limit = -T::MIN_POSITIVE.split_exponent().1;
    Lanes::min(Lanes::max(x, T::MIN_POSITIVE).split_exponent().1, limit)
}

/// `x 2^e`, rounded once at most, for `|e|` up to twice the range of exponents.
#[inline(always)]
pub fn scaled<T: Real>(x: T, e: T) -> T {
    let half = (e * T::of(0.5)).floor();
    x * T::exp2i(half) * T::exp2i(e - half)
}
