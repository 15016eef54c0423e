//! A number for every (pixel, sample, dimension), from the point set of choice: what kernels draw from.
//!
//! Pixels are independent of each other. Within one, dimensions come in pairs (0, 1), (2, 3) …: each pair is a good
//! point set of the square over the samples, and pairs are combined at random; Halton's sequence alone goes through
//! all dimensions together. Every number is uniform by itself, so averages are unbiased.

use super::generator::Generator;
use super::halton;
use super::hash::Key;
use super::latin_hypercube::stratum;
use super::multi_jittered::multi_jittered;
use super::r2::rotated_pair;
use super::sobol::{padded_pair, shuffled};
use super::stratified::shuffled_cell;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;

/// The kinds, in the order of [`Sampler::new`]'s names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    Independent { seed: u64 },
    Stratified(Grid),
    LatinHypercube(Grid),
    MultiJittered(Grid),
    R2 { seed: u64 },
    Halton { seed: u64 },
    Sobol { seed: u64 },
}

/// A point set of a size that is known before; samples beyond it belong to further, independent sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    seed: u64,
    samples: u32,
    columns: u32,
}

pub const NAMES: [&str; 7] =
    ["independent", "stratified", "latin_hypercube", "multi_jittered", "r2", "halton", "sobol"];

impl Sampler {
    /// The kind of that name, if there is one. `samples` a pixel are planned: those with a grid need to know.
    pub fn new(name: &str, seed: u64, samples: u32) -> Option<Self> {
        let samples = samples.clamp(1, 1 << 30);
        let columns = (1..).find(|c: &u32| u64::from(*c) * u64::from(*c) >= u64::from(samples)).unwrap_or(1);
        let grid = Grid { seed, samples, columns };
        Some(match name {
            "independent" => Sampler::Independent { seed },
            "stratified" => Sampler::Stratified(grid),
            "latin_hypercube" => Sampler::LatinHypercube(grid),
            "multi_jittered" => Sampler::MultiJittered(grid),
            "r2" => Sampler::R2 { seed },
            "halton" => Sampler::Halton { seed },
            "sobol" => Sampler::Sobol { seed },
            _ => return None,
        })
    }

    /// As [`Sampler::new`], but a set of `samples` that begins with sample `first` has a seed of its own: rounds of a
    /// picture are stratified each for itself. Also the number from which samples count.
    pub fn round(name: &str, seed: u64, first: u32, samples: u32) -> Option<(Self, u32)> {
        let plain = Sampler::new(name, seed, samples)?;
        if !plain.has_size() {
            return Some((plain, 0));
        }
        let seed = seed.wrapping_add(u64::from(first).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        Some((Sampler::new(name, seed, samples)?, first))
    }

    /// Whether points belong to sets of a size.
    pub fn has_size(&self) -> bool {
        matches!(self, Sampler::Stratified(_) | Sampler::LatinHypercube(_) | Sampler::MultiJittered(_))
    }

    /// A number in [0, 1). Where two are wanted, [`Sampler::pair`] costs no more.
    #[inline(always)]
    pub fn number<T: Real>(&self, pixel: u64, sample: u32, dimension: u32) -> T {
        match *self {
            Sampler::Independent { seed } => Generator::new(seed).uniform(pixel, sample, dimension),
            Sampler::LatinHypercube(grid) => grid.stratum(pixel, sample, dimension),
            Sampler::Halton { seed } => halton::scrambled(Key::new(seed, pixel), sample, dimension),
            _ => self.pair(pixel, sample, dimension & !1)[(dimension & 1) as usize],
        }
    }

    /// The numbers of `dimension`, which is even, and of the next.
    #[inline(always)]
    pub fn pair<T: Real>(&self, pixel: u64, sample: u32, dimension: u32) -> [T; 2] {
        let pair = u64::from(dimension / 2);
        match *self {
            Sampler::Stratified(grid) => {
                let (key, i) = grid.set(pixel, sample, pair);
                shuffled_cell(key, i, grid.columns, grid.samples.div_ceil(grid.columns))
            }
            Sampler::MultiJittered(grid) => {
                let (key, i) = grid.set(pixel, sample, pair);
                multi_jittered(key, i, grid.samples, grid.columns, false)
            }
            Sampler::R2 { seed } => {
                let key = Key::new(seed, pixel).at(pair);
                // The first as it is, each other in an order of its own: pairs that ran alike would fill no more than a
                // surface of their product.
                rotated_pair(key, if pair == 0 { sample } else { shuffled(key.at(2), sample) })
            }
            Sampler::Sobol { seed } => padded_pair(Key::new(seed, pixel).at(pair), sample),
            Sampler::Independent { seed } => Generator::new(seed).pair(pixel, sample, dimension / 2),
            Sampler::LatinHypercube(grid) => [0, 1].map(|d| grid.stratum(pixel, sample, dimension + d)),
            Sampler::Halton { seed } => {
                [0, 1].map(|d| halton::scrambled(Key::new(seed, pixel), sample, dimension + d))
            }
        }
    }
}

impl Grid {
    /// The key of a sample's set, and which of it the sample is.
    #[inline(always)]
    fn set(self, pixel: u64, sample: u32, part: u64) -> (Key, u32) {
        let set = u64::from(sample / self.samples);
        (Key::new(self.seed, pixel).at(part).at(set), sample % self.samples)
    }
    #[inline(always)]
    fn stratum<T: Real>(self, pixel: u64, sample: u32, dimension: u32) -> T {
        let (key, i) = self.set(pixel, sample, u64::from(dimension));
        stratum(key, i, self.samples, true)
    }
}

/// [`Sampler::number`] over arrays of equal length.
pub fn sampler_many<T: Real>(
    watch: &mut dyn Watch,
    sampler: Sampler,
    pixel: &[u64],
    sample: &[u32],
    dimension: &[u32],
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (pixel, sample, dimension, out),
        1 << 13,
        |_, (p, s, d, out)| dispatch!(_s => body(sampler, p, s, d, out)),
    )
}

#[inline(always)]
fn body<T: Real>(sampler: Sampler, pixel: &[u64], sample: &[u32], dimension: &[u32], out: &mut [T]) {
    for i in 0..out.len() {
        out[i] = sampler.number(pixel[i], sample[i], dimension[i]);
    }
}
