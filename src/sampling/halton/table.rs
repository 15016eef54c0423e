//! The numbers of a dimension's lowest digits, looked up.

use super::{Scrambling, mirrored, nested_digits, push, root};
use crate::math::exact::two_product;
use crate::sampling::hash::{Key, permute};
use crate::sampling::primes::PRIMES;
use crate::sampling::sobol::Scramble;

/// One dimension, prepared: the lowest digits of an index are looked up.
pub enum Table {
    /// The looked-up numbers and what rounding took from them; for permuted digits the key of the permutations, and what zeros at each
    /// position after those looked up and all following ones come to.
    Fixed {
        numbers: Vec<f64>,
        lacks: Vec<f64>,
        looked_up: u64,
        permuted: Option<(Key, Vec<f64>)>,
    },
    /// Hashes and digits of the looked-up prefixes; how many digits follow; the power of the base of all of them.
    Nested {
        hashes: Vec<u32>,
        numbers: Vec<f64>,
        digits: u32,
        power: u64,
    },
    Binary(Scramble),
}

/// Digits after which positions hold less than 2⁻⁶⁰, at least.
fn positions(base: u32) -> u64 {
    let (mut n, mut power) = (0, 1u64);
    while power < 1 << 60 && power < u64::MAX / u64::from(base) {
        (n, power) = (n + 1, power * u64::from(base));
    }
    n
}

impl Table {
    /// At most `limit` numbers are looked up.
    pub fn new(scrambling: Scrambling, key: Key, dimension: usize, limit: u64) -> Self {
        let (base, key) = (PRIMES[dimension], key.at(dimension as u64));
        let (mut looked_up, mut size) = (0, 1u64);
        while size * u64::from(base) <= limit {
            (looked_up, size) = (looked_up + 1, size * u64::from(base));
        }
        match scrambling {
            Scrambling::Owen if base == 2 => Table::Binary(Scramble::keyed(key)),
            Scrambling::Owen => {
                let mut prefixes = vec![(root(key), 0.0)];
                for _ in 0..looked_up {
                    let next = |d| {
                        prefixes.iter().map(move |&(hash, number)| {
                            let (digit, hash) = push(hash, base, 1.0 / base as f32, d);
                            (hash, number * f64::from(base) + f64::from(digit))
                        })
                    };
                    prefixes = (0..base).flat_map(next).collect();
                }
                let (digits, power) = nested_digits(base);
                let (hashes, numbers) = prefixes.into_iter().unzip();
                Table::Nested { hashes, numbers, digits: digits - looked_up as u32, power }
            }
            _ => {
                let permuting = scrambling == Scrambling::Digits;
                let mut numbers = vec![0u64];
                for p in 0..looked_up {
                    let digit = |d| if permuting { permute(d, base, key.at(p)) } else { d };
                    let digits: Vec<u64> = (0..base).map(|d| u64::from(digit(d))).collect();
                    let next = |&d: &u64| numbers.iter().map(move |x| x * u64::from(base) + d);
                    numbers = digits.iter().flat_map(next).collect();
                }
                let (numbers, lacks) = numbers.iter().map(|&x| quotient(x, size)).unzip();
                let permuted = permuting.then(|| {
                    let mut zeros = vec![0.0];
                    for p in (looked_up..positions(base)).rev() {
                        let below = zeros[zeros.len() - 1];
                        zeros.push((f64::from(permute(0, base, key.at(p))) + below) / f64::from(base));
                    }
                    zeros.reverse();
                    (key, zeros)
                });
                Table::Fixed { numbers, lacks, looked_up, permuted }
            }
        }
    }
    pub fn size(&self) -> u64 {
        match self {
            Table::Fixed { numbers, .. } => numbers.len() as u64,
            Table::Nested { numbers, .. } => numbers.len() as u64,
            Table::Binary(_) => 1 << 32,
        }
    }
    /// What the digits above those looked up come to, `high` being their number.
    pub fn tail(&self, base: u32, high: u64) -> f64 {
        match self {
            Table::Fixed { looked_up, permuted: Some((key, zeros)), .. } => {
                let (mut rest, mut sum, mut scale, mut p) = (high, 0.0, 1.0, 0);
                while rest != 0 && p + 1 < zeros.len() {
                    scale /= f64::from(base);
                    let digit = (rest % u64::from(base)) as u32;
                    sum += scale * f64::from(permute(digit, base, key.at(looked_up + p as u64)));
                    (rest, p) = (rest / u64::from(base), p + 1);
                }
                (sum + scale * zeros[p]) / self.size() as f64
            }
            Table::Fixed { .. } => mirrored(high, base) / self.size() as f64,
            _ => 0.0,
        }
    }
}

/// a / b as the sum of a double and what it lacks; both are below 2⁵³.
fn quotient(a: u64, b: u64) -> (f64, f64) {
    let (a, b) = (a as f64, b as f64);
    let high = a / b;
    let (product, error) = two_product(high, b);
    (high, ((a - product) - error) / b)
}
