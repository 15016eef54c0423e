//! Tone mapping: scene-referred linear values to display light in [0, 1], channel by channel.
//!
//! Negative values become 0; infinity becomes the curve's limit; NaN stays NaN.
//!
//! E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, *Photographic Tone Reproduction for Digital Images*, 2002.
//! K. Narkowicz, *ACES Filmic Tone Mapping Curve*, 2015.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};

/// The curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToneMap {
    /// Cut at one.
    Clip,
    /// x / (1 + x).
    Reinhard,
    /// x (1 + x/w²) / (1 + x), cut at one: `w` is the least value that becomes white.
    ReinhardExtended { white: f64 },
    /// Narkowicz's rational fit of the ACES reference and output transforms, cut at one.
    Aces,
}

#[inline(always)]
pub fn tone_map<V: Lanes>(curve: ToneMap, x: V) -> V {
    let (zero, one) = (x.num(0.0), x.num(1.0));
    // NaN fails the comparison and stays. Beyond 1e18 every curve has reached its limit; the bound keeps its squares
    // finite in single precision.
    let x = V::select(x.less(zero), zero, x);
    let x = V::select(x.num(1e18).less(x), x.num(1e18), x);
    let y = match curve {
        ToneMap::Clip => x,
        ToneMap::Reinhard => x / (one + x),
        ToneMap::ReinhardExtended { white } => x * (one + x / x.num(white) / x.num(white)) / (one + x),
        ToneMap::Aces => {
            let above = x * (x.num(2.51) * x + x.num(0.03));
            above / (x * (x.num(2.43) * x + x.num(0.59)) + x.num(0.14))
        }
    };
    V::select(one.less(y), one, y)
}

/// `out[i] = curve(scale · x[i])`.
pub fn tone_map_many<T: Real>(
    watch: &mut dyn Watch,
    curve: ToneMap,
    scale: f64,
    x: &[T],
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (x, out), 1 << 15, |_, (x, out)| dispatch!(_s => body(curve, scale, x, out)))
}

#[inline(always)]
fn body<T: Real>(curve: ToneMap, scale: f64, x: &[T], out: &mut [T]) {
    let scale = T::of(scale);
    for (out, &x) in out.iter_mut().zip(x) {
        *out = tone_map(curve, x * scale);
    }
}
