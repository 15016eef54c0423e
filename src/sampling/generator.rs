//! A random number for every (seed, pixel, sample, dimension), computed from these alone: no state, so any thread can
//! ask for any number in any order, and a picture is the same however its work is divided.
//!
//! Philox4x32-10: ten rounds of multiplication and exchange turn a 128-bit counter under a 64-bit key into 128 bits
//! that pass BigCrush.
//!
//! J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, *Parallel random numbers: as easy as 1, 2, 3*, 2011.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;

/// The multipliers of the two halves, and what the key grows by each round (golden ratio, √3 − 1).
const MULTIPLY: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

/// The bijection of counters under a key: Philox4x32 with ten rounds.
#[inline(always)]
pub fn philox4x32(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..10 {
        let a = u64::from(MULTIPLY[0]) * u64::from(counter[0]);
        let b = u64::from(MULTIPLY[1]) * u64::from(counter[2]);
        let (a_high, b_high) = ((a >> 32) as u32, (b >> 32) as u32);
        counter = [b_high ^ counter[1] ^ key[0], b as u32, a_high ^ counter[3] ^ key[1], a as u32];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

/// The 32-bit digits after the point `high` and, where the precision holds them, `low`: in [0, 1), rounded down.
#[inline(always)]
pub fn fraction<T: Real>(high: u32, low: u32) -> T {
    if size_of::<T>() == 4 {
        bytemuck::cast((high >> 8) as i32 as f32 * (1.0 / (1u32 << 24) as f32))
    } else {
        // Both parts and their sum are exact; the upper and the lower digits convert lane by lane.
        let low = f64::from((low >> 11) as i32) * (1.0 / (1u64 << 53) as f64);
        T::of(f64::from(high) * (1.0 / (1u64 << 32) as f64) + low)
    }
}

/// All the random numbers of one seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Generator {
    key: [u32; 2],
}

impl Generator {
    #[inline(always)]
    pub const fn new(seed: u64) -> Self {
        Generator { key: [seed as u32, (seed >> 32) as u32] }
    }
    /// Four independent words. Block `b` holds dimensions `2b` and `2b + 1` of [`Generator::uniform`].
    #[inline(always)]
    pub fn bits(self, pixel: u64, sample: u32, block: u32) -> [u32; 4] {
        philox4x32([block, sample, pixel as u32, (pixel >> 32) as u32], self.key)
    }
    /// A number in [0, 1) with all the digits of the precision: 24 bits of f32, 53 of f64.
    #[inline(always)]
    pub fn uniform<T: Real>(self, pixel: u64, sample: u32, dimension: u32) -> T {
        let w = self.bits(pixel, sample, dimension / 2);
        let at = (dimension % 2 * 2) as usize;
        fraction(w[at], w[at + 1])
    }
    /// The numbers of dimensions `2 block` and `2 block + 1` for the price of one.
    #[inline(always)]
    pub fn pair<T: Real>(self, pixel: u64, sample: u32, block: u32) -> [T; 2] {
        let w = self.bits(pixel, sample, block);
        [fraction(w[0], w[1]), fraction(w[2], w[3])]
    }
    /// Four numbers in [0, 1) for the price of one; in f64 they have 32 digits.
    #[inline(always)]
    pub fn quad<T: Real>(self, pixel: u64, sample: u32, block: u32) -> [T; 4] {
        self.bits(pixel, sample, block).map(|w| fraction(w, 0))
    }
}

/// [`Generator::uniform`] over arrays of equal length.
pub fn uniform_many<T: Real>(
    watch: &mut dyn Watch,
    seed: u64,
    pixel: &[u64],
    sample: &[u32],
    dimension: &[u32],
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (pixel, sample, dimension, out),
        1 << 14,
        |_, (p, s, d, out)| dispatch!(_s => uniform_body(Generator::new(seed), p, s, d, out)),
    )
}

#[inline(always)]
fn uniform_body<T: Real>(
    generator: Generator,
    pixel: &[u64],
    sample: &[u32],
    dimension: &[u32],
    out: &mut [T],
) {
    for i in 0..out.len() {
        out[i] = generator.uniform(pixel[i], sample[i], dimension[i]);
    }
}

/// [`philox4x32`] over arrays of equal length.
pub fn philox_many(
    watch: &mut dyn Watch,
    counter: &[[u32; 4]],
    key: &[[u32; 2]],
    out: &mut [[u32; 4]],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (counter, key, out),
        1 << 14,
        |_, (c, k, out)| dispatch!(_s => philox_body(c, k, out)),
    )
}

#[inline(always)]
fn philox_body(counter: &[[u32; 4]], key: &[[u32; 2]], out: &mut [[u32; 4]]) {
    for i in 0..out.len() {
        out[i] = philox4x32(counter[i], key[i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known answers published with Random123.
    #[test]
    fn philox_gives_the_published_vectors() {
        let all = u32::MAX;
        assert_eq!(philox4x32([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(philox4x32([all; 4], [all; 2]), [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);
        let pi = [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344];
        let out = philox4x32(pi, [0xa409_3822, 0x299f_31d0]);
        assert_eq!(out, [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]);
    }

    #[test]
    fn the_largest_fraction_is_below_one() {
        assert_eq!(fraction::<f32>(u32::MAX, u32::MAX), 1.0f32.next_down());
        assert_eq!(fraction::<f64>(u32::MAX, u32::MAX), 1.0f64.next_down());
    }
}
