//! Hard shadows: the nearest texel's depth against the receiver's.
//!
//! L. Williams, *Casting Curved Shadows on Curved Surfaces*, 1978.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::shadow::anchor::{Bias, all, or_answer, put};
use crate::shadow::lookup::{LOT, Map};
use crate::simd::*;

/// The lit fraction, 0 or 1, of every receiver. `normals` is empty or as long as `receivers`.
pub fn hard<T: Real, const PERSPECTIVE: bool>(
    watch: &mut dyn Watch,
    map: &Map<'_, T>,
    receivers: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    bias: &Bias<T>,
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (receivers, normals, out),
        1 << 14,
        |first, (p, n, out)| dispatch!(s => body::<T, _, PERSPECTIVE>(s, map, first, p, n, bias, out)),
    )
}

#[inline(always)]
fn body<T: Real, S: Simd, const PERSPECTIVE: bool>(
    s: S,
    map: &Map<'_, T>,
    first: usize,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    bias: &Bias<T>,
    out: &mut [T],
) {
    let (zero, one) = (all::<T, S>(s, T::zero()), all::<T, S>(s, T::one()));
    let mut i = 0;
    while i < out.len() {
        let asked = map.asks(first + i, LOT.min(out.len() - i));
        if asked != 0 {
            let a = map.anchor::<S, PERSPECTIVE>(s, points, normals, i, bias);
            let (_, blocked) = map.tap::<S, PERSPECTIVE, false>(s, &a, (zero, zero));
            put::<T, S>(out, i, asked, or_answer::<T, S>(s, &a, blocked.select(zero, one)));
        }
        i += LOT;
    }
}
