//! Transfer functions: linear light in [0, 1] to an encoded signal, and back.
//!
//! Negative values mirror (`f(-x) = -f(x)`), values beyond one continue the curve, so that a round trip returns them.
//!
//! IEC 61966-2-1:1999, *Default RGB colour space: sRGB*.

use crate::dispatch;
use crate::math::pow;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, map_lanes};

/// Which curve, and which way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    /// The piecewise curve of the standard: a line below 0.0031308, a power 1/2.4 above.
    EncodeSrgb,
    DecodeSrgb,
    /// A pure power with this exponent (1/γ encodes, γ decodes).
    Power(f64),
}

#[inline(always)]
pub fn encode_srgb<V: Lanes>(x: V) -> V {
    let a = x.abs();
    // 1.055 p - 0.055, arranged so that one maps to one.
    let p = pow(a, x.num(1.0 / 2.4));
    let curve = p + x.num(0.055) * (p - x.num(1.0));
    V::select(a.less_eq(x.num(0.0031308)), x.num(12.92) * a, curve).copysign(x)
}

#[inline(always)]
pub fn decode_srgb<V: Lanes>(x: V) -> V {
    let a = x.abs();
    let b = (a + x.num(0.055)) / x.num(1.055);
    // b^2.4 in two factors: the rounding of the exponent is multiplied by ln b, so the smaller exponent loses less.
    let curve = b * b * pow(b, x.num(0.4));
    V::select(a.less_eq(x.num(0.04045)), a / x.num(12.92), curve).copysign(x)
}

/// `out[i] = curve(x[i])`.
pub fn transfer_many<T: Real>(
    watch: &mut dyn Watch,
    curve: Transfer,
    x: &[T],
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (x, out), 1 << 15, |_, (x, out)| dispatch!(s => body(s, curve, x, out)))
}

#[inline(always)]
fn body<T: Real, S: Simd>(s: S, curve: Transfer, x: &[T], out: &mut [T]) {
    match curve {
        Transfer::EncodeSrgb => map_lanes(
            s,
            x,
            out,
            #[inline(always)]
            |x| encode_srgb(x),
        ),
        Transfer::DecodeSrgb => map_lanes(
            s,
            x,
            out,
            #[inline(always)]
            |x| decode_srgb(x),
        ),
        Transfer::Power(e) => map_lanes(
            s,
            x,
            out,
            #[inline(always)]
            |x| Lanes::copysign(pow(Lanes::abs(x), x.num(e)), x),
        ),
    }
}
