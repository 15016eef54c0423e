//! The functions over arrays, for measuring them and for testing them from outside.

use super::{acos, asin, atan2, cos, exp, ln, pow, sin, tan};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unary {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Exp,
    Ln,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binary {
    Atan2,
    Pow,
}

const PIECE: usize = 1 << 16;

/// `out[i] = f(x[i])`.
pub fn unary<T: Real>(watch: &mut dyn Watch, f: Unary, x: &[T], out: &mut [T]) -> Result<(), Interrupted> {
    parallel::for_each(watch, (x, out), PIECE, |_, (x, out)| dispatch!(_s => unary_body(f, x, out)))
}

#[inline(always)]
fn unary_body<T: Real>(f: Unary, x: &[T], out: &mut [T]) {
    match f {
        Unary::Sin => each(x, out, sin),
        Unary::Cos => each(x, out, cos),
        Unary::Tan => each(x, out, tan),
        Unary::Asin => each(x, out, asin),
        Unary::Acos => each(x, out, acos),
        Unary::Exp => each(x, out, exp),
        Unary::Ln => each(x, out, ln),
    }
}

#[inline(always)]
fn each<T: Real>(x: &[T], out: &mut [T], f: impl Fn(T) -> T) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out = f(x);
    }
}

/// `out[i] = f(a[i], b[i])`.
pub fn binary<T: Real>(
    watch: &mut dyn Watch,
    f: Binary,
    a: &[T],
    b: &[T],
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (a, b, out), PIECE, |_, (a, b, out)| dispatch!(_s => binary_body(f, a, b, out)))
}

#[inline(always)]
fn binary_body<T: Real>(f: Binary, a: &[T], b: &[T], out: &mut [T]) {
    match f {
        Binary::Atan2 => each_pair(a, b, out, atan2),
        Binary::Pow => each_pair(a, b, out, pow),
    }
}

#[inline(always)]
fn each_pair<T: Real>(a: &[T], b: &[T], out: &mut [T], f: impl Fn(T, T) -> T) {
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = f(a, b);
    }
}
