//! Signs of polynomials in given numbers, as exact arithmetic has them.
//!
//! A formula is written once over [`Number`]. [`Bounded`] evaluates it in double precision and bounds its own rounding;
//! only where the bound does not settle the sign, [`Expansion`] evaluates it anew without rounding. Single precision
//! converts exactly. Kernels that decide so are scalar and double, which no SIMD level betters: they are called from the
//! dispatch, not inlined into it, where their closures would stay calls. Values and their products must neither overflow nor underflow in double precision: formulas of
//! degree six hold for magnitudes from 1e-50 to 1e50, and so for all of single precision.
//!
//! J. R. Shewchuk, *Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates*, Discrete &
//! Computational Geometry 18, 1997. Orientations go through the crate `robust`.

use crate::math::exact::{two_product, two_sum};
use crate::real::Real;
use robust::{Coord, Coord3D};
use std::cmp::Ordering;

pub type Point = [f64; 3];

/// What formulas are written in.
pub trait Number: Clone {
    fn of(x: f64) -> Self;
    fn plus(&self, o: &Self) -> Self;
    fn minus(&self, o: &Self) -> Self;
    fn times(&self, o: &Self) -> Self;
    fn abs(&self) -> Self;
}

/// A double with a bound of its distance from the exact value.
#[derive(Clone, Copy, Debug)]
pub struct Bounded {
    pub value: f64,
    pub error: f64,
}

/// Half the distance from 1 to the next double, raised so that it also covers the rounding of the bounds themselves.
const UNIT: f64 = 0.5 * f64::EPSILON * (1.0 + 1e-12);

impl Bounded {
    #[inline(always)]
    fn rounded(value: f64, error: f64) -> Self {
        Self { value, error: error + UNIT * value.abs() }
    }
    /// None where the bound does not settle it.
    #[inline(always)]
    fn sign(self) -> Option<Ordering> {
        // Bounds are sums of a few hundred rounded positive terms.
        if self.value.abs() > self.error * (1.0 + 1e-12) {
            Some(if self.value > 0.0 { Ordering::Greater } else { Ordering::Less })
        } else {
            (self.value == 0.0 && self.error == 0.0).then_some(Ordering::Equal)
        }
    }
}

impl Number for Bounded {
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self { value: x, error: 0.0 }
    }
    #[inline(always)]
    fn plus(&self, o: &Self) -> Self {
        Self::rounded(self.value + o.value, self.error + o.error)
    }
    #[inline(always)]
    fn minus(&self, o: &Self) -> Self {
        Self::rounded(self.value - o.value, self.error + o.error)
    }
    #[inline(always)]
    fn times(&self, o: &Self) -> Self {
        let (a, b) = (self.value.abs() + self.error, o.value.abs() + o.error);
        let carried = a * o.error + self.error * o.value.abs();
        // What underflows is no longer bounded by the unit of rounding.
        let vanished = if a == 0.0 || b == 0.0 { 0.0 } else { f64::MIN_POSITIVE };
        Self::rounded(self.value * o.value, carried + vanished)
    }
    #[inline(always)]
    fn abs(&self) -> Self {
        Self { value: self.value.abs(), error: self.error }
    }
}

/// An unevaluated sum of doubles that do not overlap, smallest first: a number without rounding.
#[derive(Clone, Debug)]
pub struct Expansion(Vec<f64>);

#[inline(always)]
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

impl Expansion {
    pub fn sign(&self) -> Ordering {
        self.0.last().map_or(Ordering::Equal, |x| x.partial_cmp(&0.0).unwrap_or(Ordering::Equal))
    }
    /// The nearest double but for an ulp.
    pub fn value(&self) -> f64 {
        self.0.iter().sum()
    }
    fn push(&mut self, x: f64) {
        if x != 0.0 {
            self.0.push(x);
        }
    }
    /// Shewchuk's fast expansion sum: both merged by magnitude, then added from the smallest up.
    #[inline(never)]
    fn sum(&self, o: &[f64], sign: f64) -> Self {
        let (mut a, mut b) = (self.0.iter().copied().peekable(), o.iter().map(|x| sign * x).peekable());
        let mut merged = std::iter::from_fn(|| match (a.peek(), b.peek()) {
            (Some(x), Some(y)) if x.abs() > y.abs() => b.next(),
            (None, _) => b.next(),
            _ => a.next(),
        });
        let mut out = Self(Vec::with_capacity(self.0.len() + o.len()));
        let Some(mut total) = merged.next() else { return out };
        let mut first = true;
        for x in merged {
            let (sum, rest) = if first { fast_two_sum(x, total) } else { two_sum(total, x) };
            first = false;
            out.push(rest);
            total = sum;
        }
        out.push(total);
        out
    }
    /// Shewchuk's scaling of an expansion.
    fn scaled(&self, b: f64) -> Self {
        let mut out = Self(Vec::with_capacity(2 * self.0.len()));
        let Some((&first, others)) = self.0.split_first() else { return out };
        let (mut total, rest) = two_product(first, b);
        out.push(rest);
        for &x in others {
            let (product, low) = two_product(x, b);
            let (sum, rest) = two_sum(total, low);
            out.push(rest);
            let (sum, rest) = fast_two_sum(product, sum);
            out.push(rest);
            total = sum;
        }
        out.push(total);
        out
    }
}

impl Number for Expansion {
    fn of(x: f64) -> Self {
        Self(if x == 0.0 { vec![] } else { vec![x] })
    }
    fn plus(&self, o: &Self) -> Self {
        self.sum(&o.0, 1.0)
    }
    fn minus(&self, o: &Self) -> Self {
        self.sum(&o.0, -1.0)
    }
    #[inline(never)]
    fn times(&self, o: &Self) -> Self {
        let (long, short) = if self.0.len() < o.0.len() { (o, self) } else { (self, o) };
        let mut terms: Vec<Self> = short.0.iter().map(|&x| long.scaled(x)).collect();
        // Added in pairs, so that lengths grow evenly.
        while terms.len() > 1 {
            terms =
                terms.chunks(2).map(|t| t.get(1).map_or_else(|| t[0].clone(), |b| t[0].plus(b))).collect();
        }
        terms.pop().unwrap_or(Self(vec![]))
    }
    fn abs(&self) -> Self {
        if self.sign() == Ordering::Less { Self(self.0.iter().map(|x| -x).collect()) } else { self.clone() }
    }
}

/// The exact sign of one formula, given in both numbers: `sign(f(x), || f(x))`.
#[inline(always)]
pub fn sign(quick: Bounded, exact: impl FnOnce() -> Expansion) -> Ordering {
    match quick.sign() {
        Some(sign) => sign,
        None => settle(exact).sign(),
    }
}

#[cold]
#[inline(never)]
fn settle(exact: impl FnOnce() -> Expansion) -> Expansion {
    exact()
}

/// The value of one formula to 5e-14 of itself, given in both numbers.
#[inline(always)]
pub fn value(quick: Bounded, exact: impl FnOnce() -> Expansion) -> f64 {
    if quick.error <= 4e-14 * quick.value.abs() { quick.value } else { settle(exact).value() }
}

// ---- Vectors of numbers ----

#[inline(always)]
pub fn vector<N: Number>(v: Point) -> [N; 3] {
    [N::of(v[0]), N::of(v[1]), N::of(v[2])]
}

/// `b - a`.
#[inline(always)]
pub fn between<N: Number>(a: Point, b: Point) -> [N; 3] {
    let part = |i: usize| N::of(b[i]).minus(&N::of(a[i]));
    [part(0), part(1), part(2)]
}

#[inline(always)]
pub fn dot<N: Number>(a: &[N; 3], b: &[N; 3]) -> N {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

#[inline(always)]
pub fn cross<N: Number>(a: &[N; 3], b: &[N; 3]) -> [N; 3] {
    let minor = |i: usize, j: usize| a[i].times(&b[j]).minus(&a[j].times(&b[i]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// In double precision, which holds every single exactly.
#[inline(always)]
pub fn point<T: Real>(p: [T; 3]) -> Point {
    [p[0].to_f64(), p[1].to_f64(), p[2].to_f64()]
}

/// The same of a plane.
#[inline(always)]
pub fn four<T: Real>(p: [T; 4]) -> [f64; 4] {
    [p[0].to_f64(), p[1].to_f64(), p[2].to_f64(), p[3].to_f64()]
}

/// Neither NaN nor infinite.
#[inline(always)]
pub fn finite<const N: usize>(v: [f64; N]) -> bool {
    // What is not finite times zero is NaN, and NaN stays in a sum.
    let mut sum = 0.0;
    for x in v {
        sum += x * 0.0;
    }
    sum == 0.0
}

/// Positive where `a`, `b`, `c` turn counter-clockwise in the plane of the axes `i` and `j`; exact in sign.
#[inline(always)]
pub fn turn([i, j]: [usize; 2], a: Point, b: Point, c: Point) -> f64 {
    let flat = |p: Point| Coord { x: p[i], y: p[j] };
    robust::orient2d(flat(a), flat(b), flat(c))
}

/// Positive where `d` lies on the side of the plane of `a`, `b`, `c` to which their cross product points; exact in sign.
#[inline(always)]
pub fn side(a: Point, b: Point, c: Point, d: Point) -> f64 {
    let solid = |[x, y, z]: Point| Coord3D { x, y, z };
    -robust::orient3d(solid(a), solid(b), solid(c), solid(d))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expansions_cancel_without_rounding() {
        let of = Expansion::of;
        let (big, small) = (of(1e30).plus(&of(1.0)), of(1e-30).plus(&of(3.0)));
        // (a + b)(a - b) - a² + b² = 0, and what is added stays.
        let product = big.plus(&small).times(&big.minus(&small));
        let zero = product.minus(&big.times(&big)).plus(&small.times(&small));
        assert_eq!(zero.sign(), Ordering::Equal);
        assert_eq!(zero.minus(&of(1e-200)).value(), -1e-200);
    }

    #[test]
    fn bounds_hold_what_expansions_find() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64 / 16777216.0 - 0.5
        };
        fn formula<N: Number>(x: [Point; 4]) -> N {
            let n = cross::<N>(&between(x[0], x[1]), &between(x[0], x[2]));
            let d = dot(&n, &between(x[0], x[3]));
            d.times(&d).minus(&dot(&n, &n).abs())
        }
        for _ in 0..2000 {
            let x: [Point; 4] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
            let (quick, exact) = (formula::<Bounded>(x), formula::<Expansion>(x));
            let error = exact.minus(&Expansion::of(quick.value)).value().abs();
            assert!(error <= quick.error && quick.error < 1e-13);
        }
    }
}
