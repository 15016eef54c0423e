//! Hard shadows: the nearest texel's depth against the receiver's.
//!
//! L. Williams, *Casting Curved Shadows on Curved Surfaces*, 1978.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::shadow::lookup::{Bias, Map, at};

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
        |first, (p, n, out)| dispatch!(_s => body::<T, PERSPECTIVE>(map, first, p, n, bias, out)),
    )
}

#[inline(always)]
fn body<T: Real, const PERSPECTIVE: bool>(
    map: &Map<'_, T>,
    first: usize,
    points: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    bias: &Bias<T>,
    out: &mut [T],
) {
    for i in 0..out.len() {
        if map.skips(first + i) {
            continue;
        }
        out[i] = match map.anchor::<PERSPECTIVE>(points[i], at(normals, i), bias) {
            Ok(a) if map.blocker_here::<PERSPECTIVE>(&a).is_some() => T::zero(),
            Ok(_) => T::one(),
            Err(answer) => answer,
        };
    }
}
