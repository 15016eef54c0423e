//! Relative luminance of linear RGB with sRGB (Rec. 709) primaries.
//!
//! Rec. ITU-R BT.709-6, 2015: the weights to four digits, as the standard states them.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Lanes;
use crate::real::Real;
use crate::vec::Vec3;

#[inline(always)]
pub fn luminance<V: Lanes>(c: Vec3<V>) -> V {
    c.x * c.x.num(0.2126) + c.y * c.x.num(0.7152) + c.z * c.x.num(0.0722)
}

/// [`luminance`] over arrays.
pub fn luminance_many<T: Real>(
    watch: &mut dyn Watch,
    rgb: &[[T; 3]],
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (rgb, out), 1 << 15, |_, (rgb, out)| dispatch!(_s => body(rgb, out)))
}

#[inline(always)]
fn body<T: Real>(rgb: &[[T; 3]], out: &mut [T]) {
    for (out, &c) in out.iter_mut().zip(rgb) {
        *out = luminance(c.into());
    }
}
