//! Hashes that stand in for stored random numbers: keys of a pixel's dimensions, permutations of any length.

use crate::real::Real;

/// 2⁶⁴ over the golden ratio, odd: successive multiples are spread evenly.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// A bijection of 64 bits without pattern (variant 13 of D. Stafford's constants for Austin Appleby's finalizer, as in
/// G. L. Steele, D. Lea, C. H. Flood, *Fast splittable pseudorandom number generators*, 2014).
#[inline(always)]
pub const fn mix64(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A bijection of 32 bits without pattern (constants of C. Wellons' search for low bias, 2018).
#[inline(always)]
pub const fn mix32(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7FEB_352D);
    x = (x ^ (x >> 15)).wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

/// A source of keys; each key is one again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key(u64);

impl Key {
    #[inline(always)]
    pub const fn new(seed: u64, stream: u64) -> Self {
        Key(mix64(mix64(seed.wrapping_add(GOLDEN)) ^ stream))
    }
    #[inline(always)]
    pub const fn at(self, i: u64) -> Self {
        Key(mix64(self.0.wrapping_add(i.wrapping_add(1).wrapping_mul(GOLDEN))))
    }
    #[inline(always)]
    pub const fn bits(self) -> u64 {
        self.0
    }
    /// Four words.
    #[inline(always)]
    pub const fn words(self) -> [u32; 4] {
        let (a, b) = (self.0, self.at(0).0);
        [a as u32, (a >> 32) as u32, b as u32, (b >> 32) as u32]
    }
    /// A number in [0, 1) with all the digits of the precision.
    #[inline(always)]
    pub fn uniform<T: Real>(self) -> T {
        super::generator::fraction((self.0 >> 32) as u32, self.0 as u32)
    }
}

/// The place of `i` in a random order of 0 … n − 1, where `i` < `n`.
///
/// A bijection of the next power of two is walked until it lands below `n`: at most two steps on average.
#[inline(always)]
pub fn permute(i: u32, n: u32, key: Key) -> u32 {
    if n <= 1 {
        return 0;
    }
    let bits = 32 - (n - 1).leading_zeros();
    let (mask, shift) = (u32::MAX >> (32 - bits), bits.div_ceil(2));
    let ([a, b, c, d], last) = (key.words(), key.at(1).bits());
    let words = [a, b, c, d, last as u32, (last >> 32) as u32];
    let mut x = i;
    loop {
        // Sums and odd products carry upwards, shifts bring the upper digits down again: each is a bijection.
        for w in words {
            x = x.wrapping_add(w) & mask;
            x = x.wrapping_mul((w >> 15) | 1) & mask;
            x ^= x >> shift;
            x = x.wrapping_mul(0x7FEB_352D).wrapping_add(w >> 8) & mask;
            x ^= x >> (shift / 2 + 1);
        }
        if x < n {
            return x;
        }
    }
}
