//! The random numbers of paths: pairs for every pixel, sample and purpose, eight at a time or one.
//!
//! Sobol' pairs are padded: each purpose has its own two-dimensional Sobol' sequence, whose points come in an order of
//! its own and are scrambled by themselves, so that every pair is a (0, 2)-sequence over the samples of a pixel, and
//! pairs know nothing of each other. They are those of [`crate::sampling::sobol::padded_pair`], but for keys of 32 bits
//! instead of 64, so that eight pairs are made in lanes; the other samplers are asked one number after the other.
//!
//! B. Burley, *Practical hash-based Owen scrambling*, 2020.

use crate::real::Real;
use crate::sampling::generator::fraction;
use crate::sampling::hash::{Key, mix32 as mix};
use crate::sampling::sampler::Sampler;

#[derive(Clone, Copy, Debug)]
pub struct Draws {
    sampler: Sampler,
    /// Of the seed.
    base: u32,
}

/// Flips each binary digit by a hash of the lower ones.
#[inline(always)]
fn scramble(mut x: u32, key: u32) -> u32 {
    x = x.wrapping_add(key);
    x ^= x.wrapping_mul(0x6C50_B47C);
    x = x.wrapping_mul((key >> 16) | 1);
    x ^= x.wrapping_mul(0xB82F_1E52);
    x ^= x.wrapping_mul(0xC7AF_E638);
    x ^ x.wrapping_mul(0x8D22_F6E6)
}

/// Pascal's triangle modulo two, times the digits of `i`: the second Sobol' dimension, digits reversed.
#[inline(always)]
fn pascal(mut x: u32) -> u32 {
    x ^= (x & 0xAAAA_AAAA) >> 1;
    x ^= (x & 0xCCCC_CCCC) >> 2;
    x ^= (x & 0xF0F0_F0F0) >> 4;
    x ^= (x & 0xFF00_FF00) >> 8;
    x ^ (x >> 16)
}

impl Draws {
    pub fn new(sampler: Sampler, seed: u64) -> Self {
        Draws { sampler, base: Key::new(seed, 0).bits() as u32 }
    }

    /// What tells a pixel's numbers from others': its own number, or for Sobol' points a hash.
    #[inline(always)]
    pub fn key(&self, pixel: u32) -> u32 {
        match self.sampler {
            Sampler::Sobol { .. } => mix(mix(pixel) ^ self.base),
            _ => pixel,
        }
    }

    /// A pair in [0, 1)².
    #[inline(always)]
    pub fn pair<T: Real>(&self, key: u32, sample: u32, purpose: u32) -> [T; 2] {
        match self.sampler {
            Sampler::Sobol { .. } => sobol_pair(key, sample, purpose),
            _ => self.other_pair(key, sample, purpose),
        }
    }

    /// Of the other samplers, compiled once.
    #[inline(never)]
    fn other_pair<T: Real>(&self, key: u32, sample: u32, purpose: u32) -> [T; 2] {
        self.sampler.pair(u64::from(key), sample, 2 * purpose)
    }

    /// Eight pairs.
    #[inline(always)]
    pub fn pairs<T: Real>(&self, key: &[u32; 8], sample: &[u32; 8], purpose: u32) -> [[T; 8]; 2] {
        let mut out = [[T::zero(); 8]; 2];
        match self.sampler {
            Sampler::Sobol { .. } => {
                for l in 0..8 {
                    [out[0][l], out[1][l]] = sobol_pair(key[l], sample[l], purpose);
                }
            }
            _ => {
                for l in 0..8 {
                    [out[0][l], out[1][l]] = self.other_pair(key[l], sample[l], purpose);
                }
            }
        }
        out
    }
}

#[inline(always)]
fn sobol_pair<T: Real>(key: u32, sample: u32, purpose: u32) -> [T; 2] {
    let h = mix(key.wrapping_add(purpose.wrapping_mul(0x9E37_79B9)));
    let (a, b) = (mix(h.wrapping_add(0x6A09_E667)), mix(h.wrapping_add(0xBB67_AE85)));
    // The shuffled index, whose reversed digits are the first coordinate.
    let index = scramble(sample.reverse_bits(), h).reverse_bits();
    let x = scramble(index, a).reverse_bits();
    let y = scramble(pascal(index), b).reverse_bits();
    [fraction(x, mix(x ^ b)), fraction(y, mix(y ^ a))]
}
