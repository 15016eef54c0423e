//! The functions over arrays, for measuring them and for testing them from outside.

use super::{acos, asin, atan2, cos, exp, ln, pow, sin, tan};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::simd::{Simd, map_lanes, zip_lanes};

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
    parallel::for_each(watch, (x, out), PIECE, |_, (x, out)| dispatch!(s => unary_body(s, f, x, out)))
}

/// A function as a closure that stays inside the dispatch: a bare name would be called through a shim outside it.
macro_rules! inlined {
    ($map:ident($($array:expr),+), |$($x:ident),+| $call:expr) => {
        $map(
            $($array),+,
            #[inline(always)]
            |$($x),+| $call,
        )
    };
}

#[inline(always)]
fn unary_body<T: Real, S: Simd>(s: S, f: Unary, x: &[T], out: &mut [T]) {
    match f {
        Unary::Sin => inlined!(map_lanes(s, x, out), |v| sin(v)),
        Unary::Cos => inlined!(map_lanes(s, x, out), |v| cos(v)),
        Unary::Tan => inlined!(map_lanes(s, x, out), |v| tan(v)),
        Unary::Asin => inlined!(map_lanes(s, x, out), |v| asin(v)),
        Unary::Acos => inlined!(map_lanes(s, x, out), |v| acos(v)),
        Unary::Exp => inlined!(map_lanes(s, x, out), |v| exp(v)),
        Unary::Ln => inlined!(map_lanes(s, x, out), |v| ln(v)),
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
    parallel::for_each(
        watch,
        (a, b, out),
        PIECE,
        |_, (a, b, out)| dispatch!(s => binary_body(s, f, a, b, out)),
    )
}

#[inline(always)]
fn binary_body<T: Real, S: Simd>(s: S, f: Binary, a: &[T], b: &[T], out: &mut [T]) {
    match f {
        Binary::Atan2 => inlined!(zip_lanes(s, a, b, out), |v, w| atan2(v, w)),
        Binary::Pow => inlined!(zip_lanes(s, a, b, out), |v, w| pow(v, w)),
    }
}
