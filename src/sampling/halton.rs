//! Halton's sequence: the digits of the index in a prime base, mirrored at the point; each dimension has its own prime.
//!
//! Plain, in high dimensions neighbouring coordinates run along lines until n passes the product of their bases.
//! Scrambling breaks these up: every digit is permuted, at random for each position ("digits", Owen 2017), or for each
//! position and all that stands above it ("owen", nested). The nested permutations are digit → a · digit + c modulo the
//! base with a and c hashed from the digits above: any two digits go to any two with equal chance, so variances are
//! those of uniform permutations.
//!
//! J. H. Halton, *On the efficiency of certain quasi-random sequences of points*, 1960. A. B. Owen, *Randomly permuted
//! (t, m, s)-nets and (t, s)-sequences*, 1995; *A randomized Halton algorithm in R*, 2017.

use super::hash::{Key, mix32, permute};
pub use super::primes::PRIMES;
use super::sobol::Scramble;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::Real;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scrambling {
    None,
    /// A permutation for each position of a digit.
    Digits,
    /// A permutation for each position and the digits above it.
    Owen,
}

/// Nested scrambling: how many digits of a base are permuted one by one, until they tell 2³² indices apart.
#[inline(always)]
fn nested_digits(base: u32) -> (u32, u64) {
    let (mut n, mut power) = (0, 1u64);
    while power < 1 << 32 {
        (n, power) = (n + 1, power * u64::from(base));
    }
    (n, power)
}

/// What stands above a digit, as a hash, and the digits so far as a whole number.
#[derive(Clone, Copy, Debug, Default)]
struct Prefix {
    hash: u32,
    number: f64,
}

impl Prefix {
    #[inline(always)]
    fn new(key: Key) -> Self {
        Prefix { hash: key.bits() as u32 ^ (key.bits() >> 32) as u32, number: 0.0 }
    }
    /// The next digit, permuted: a · digit + c.
    #[inline(always)]
    fn push(self, base: u32, reciprocal: f32, digit: u32) -> Self {
        let (g, h) = (mix32(self.hash ^ 0x68E3_1DA4), mix32(self.hash.wrapping_add(0xB529_7A4D)));
        let a = 1 + high_product(g, base - 1);
        let x = a * digit + high_product(h, base);
        // The quotient in single precision is off by one at most: products stay below 2²⁷.
        let q = (x as i32 as f32 * reciprocal) as i32 as u32;
        let r = x.wrapping_sub(q * base) as i32;
        let r = if r < 0 { r + base as i32 } else { r };
        let r = if r >= base as i32 { r - base as i32 } else { r };
        let hash = mix32(self.hash.wrapping_add((digit + 1).wrapping_mul(0x9E37_79B9)));
        Prefix { hash, number: self.number * f64::from(base) + f64::from(r) }
    }
    /// The number in [0, 1): what is below the digits is one more, uniform and turned by `beyond`.
    #[inline(always)]
    fn finish<T: Real>(self, scale: f64, beyond: f64) -> T {
        let below = f64::from(mix32(self.hash)) * (1.0 / (1u64 << 32) as f64) + beyond;
        let below = if below >= 1.0 { below - 1.0 } else { below };
        below_one((self.number + below) * scale)
    }
}

#[inline(always)]
fn high_product(a: u32, b: u32) -> u32 {
    ((u64::from(a) * u64::from(b)) >> 32) as u32
}

#[inline(always)]
fn below_one<T: Real>(x: f64) -> T {
    let x = T::of(x);
    if x < T::one() { x } else { T::one().next_down() }
}

/// Coordinate `dimension` of point `index`, scrambled by nested permutations of the key's own.
///
/// `dimension` is taken modulo the number of primes.
#[inline(always)]
pub fn scrambled<T: Real>(key: Key, index: u32, dimension: u32) -> T {
    let dimension = dimension as usize % PRIMES.len();
    let (base, key) = (PRIMES[dimension], key.at(dimension as u64));
    if base == 2 {
        return Scramble::keyed(key).fraction(index.reverse_bits());
    }
    let (n, power) = nested_digits(base);
    let (mut prefix, mut rest, reciprocal) = (Prefix::new(key), index, 1.0 / base as f32);
    for _ in 0..n {
        prefix = prefix.push(base, reciprocal, rest % base);
        rest /= base;
    }
    prefix.finish(1.0 / power as f64, 0.0)
}

/// The digits of `index` mirrored at the point, the last of them the first.
#[inline(always)]
fn mirrored(index: u64, base: u32) -> f64 {
    let (mut rest, mut number, mut power) = (index, 0u128, 1u128);
    while rest != 0 {
        number = number * u128::from(base) + u128::from(rest % u64::from(base));
        power *= u128::from(base);
        rest /= u64::from(base);
    }
    number as f64 / power as f64
}

/// One dimension, prepared: the lowest digits of an index are looked up.
enum Table {
    /// The looked-up numbers as sums of two; the permutations of all positions (none: as they are); the looked-up
    /// positions.
    Fixed {
        numbers: Vec<[f64; 2]>,
        permutations: Vec<Vec<u16>>,
        looked_up: usize,
    },
    Nested {
        prefixes: Vec<Prefix>,
        digits: u32,
        power: u64,
    },
    Binary(Scramble),
}

/// Digits after which positions hold less than 2⁻⁶⁰.
fn positions(base: u32) -> usize {
    let (mut n, mut power) = (0, 1u64);
    while power < 1 << 60 && power < u64::MAX / u64::from(base) {
        (n, power) = (n + 1, power * u64::from(base));
    }
    n
}

impl Table {
    fn new(scrambling: Scrambling, key: Key, dimension: usize, limit: u64) -> Self {
        let (base, key) = (PRIMES[dimension], key.at(dimension as u64));
        let (mut looked_up, mut size) = (0, 1u64);
        while size * u64::from(base) <= limit {
            (looked_up, size) = (looked_up + 1, size * u64::from(base));
        }
        match scrambling {
            Scrambling::Owen if base == 2 => Table::Binary(Scramble::keyed(key)),
            Scrambling::Owen => {
                let mut prefixes = vec![Prefix::new(key)];
                for _ in 0..looked_up {
                    let next = |d| prefixes.iter().map(move |p| p.push(base, 1.0 / base as f32, d));
                    prefixes = (0..base).flat_map(next).collect();
                }
                let (digits, power) = nested_digits(base);
                Table::Nested { prefixes, digits: digits - looked_up as u32, power }
            }
            _ => {
                let permutation = |p| (0..base).map(|d| permute(d, base, key.at(p as u64)) as u16).collect();
                let count = if scrambling == Scrambling::Digits { positions(base) } else { 0 };
                let permutations: Vec<Vec<u16>> = (0..count).map(permutation).collect();
                let mut numbers = vec![0u64];
                for p in 0..looked_up {
                    let digit =
                        |d: u32| permutations.get(p).map_or(u64::from(d), |m| u64::from(m[d as usize]));
                    let next = |d| numbers.iter().map(move |x| x * u64::from(base) + digit(d));
                    numbers = (0..base).flat_map(next).collect();
                }
                let numbers = numbers.iter().map(|&x| quotient(x, size)).collect();
                Table::Fixed { numbers, permutations, looked_up }
            }
        }
    }
    fn size(&self) -> u64 {
        match self {
            Table::Fixed { numbers, .. } => numbers.len() as u64,
            Table::Nested { prefixes, .. } => prefixes.len() as u64,
            Table::Binary(_) => 1 << 32,
        }
    }
}

/// a / b as the sum of a double and what it lacks.
fn quotient(a: u64, b: u64) -> [f64; 2] {
    let scale = 1.0 / (1u128 << 110) as f64;
    let exact = (u128::from(a) << 110) / u128::from(b);
    let high = exact as f64;
    [high * scale, (exact as i128 - high as i128) as f64 * scale]
}

/// Points `start` … of the sequence, one row each. Needs start + rows ≤ 2⁶⁴ and no more columns than [`PRIMES`].
pub fn halton_many<T: Real>(
    watch: &mut dyn Watch,
    scrambling: Scrambling,
    seed: u64,
    start: u64,
    dimensions: usize,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let points = out.len() / dimensions.max(1);
    let (key, limit) = (Key::new(seed, 0), if dimensions > 32 { 512 } else { 4096 });
    let mut tables: Vec<Option<Table>> = (0..dimensions).map(|_| None).collect();
    parallel::for_each(watch, &mut tables[..], 8, |first, tables| {
        for (d, table) in tables.iter_mut().enumerate() {
            *table = Some(Table::new(scrambling, key, first + d, limit.min(points as u64)));
        }
    })?;
    let tables: Vec<Table> = tables.into_iter().flatten().collect();
    let rows = ((1 << 13) / dimensions.max(1)).max(2 * TILE);
    parallel::for_each(watch, Rows { data: out, width: dimensions }, rows, |first, rows| {
        let first = start + first as u64;
        dispatch!(_s => body(first, &tables, rows))
    })
}

const TILE: usize = 64;

#[inline(always)]
fn body<T: Real>(first: u64, tables: &[Table], rows: Rows<'_, T>) {
    let width = rows.width;
    for (t, tile) in rows.data.chunks_mut(TILE * width).enumerate() {
        let (first, count) = (first + (t * TILE) as u64, tile.len() / width);
        for (d, table) in tables.iter().enumerate() {
            let mut done = 0;
            while done < count {
                // A run of indices that agree in all but the digits looked up.
                let (high, low) =
                    ((first + done as u64) / table.size(), (first + done as u64) % table.size());
                let n = (count - done).min((table.size() - low).min(TILE as u64) as usize);
                let values = run(table, PRIMES[d], high, low, n);
                for (row, &value) in tile[done * width..].chunks_exact_mut(width).zip(&values[..n]) {
                    row[d] = value;
                }
                done += n;
            }
        }
    }
}

/// `n` coordinates from index `high` · size + `low`.
#[inline(always)]
fn run<T: Real>(table: &Table, base: u32, high: u64, low: u64, n: usize) -> [T; TILE] {
    let mut values = [T::zero(); TILE];
    match table {
        Table::Fixed { numbers, permutations, looked_up } => {
            let tail = if permutations.is_empty() {
                mirrored(high, base)
            } else {
                permuted(high, base, &permutations[*looked_up..])
            };
            let tail = tail / table.size() as f64;
            let numbers = &numbers[low as usize..][..n];
            for j in 0..n.min(TILE) {
                values[j] = below_one(numbers[j][0] + (numbers[j][1] + tail));
            }
        }
        Table::Nested { prefixes, digits, power } => {
            let (mut state, mut rest) = ([Prefix::default(); TILE], high);
            state[..n].copy_from_slice(&prefixes[low as usize..][..n]);
            let reciprocal = 1.0 / base as f32;
            for _ in 0..*digits {
                let digit = (rest % u64::from(base)) as u32;
                rest /= u64::from(base);
                for j in 0..n.min(TILE) {
                    state[j] = state[j].push(base, reciprocal, digit);
                }
            }
            let (scale, beyond) = (1.0 / *power as f64, mirrored(rest, base));
            for j in 0..n.min(TILE) {
                values[j] = state[j].finish(scale, beyond);
            }
        }
        Table::Binary(scramble) => {
            let beyond = (high as u32).reverse_bits();
            for j in 0..n.min(TILE) {
                values[j] = scramble.binary((low as u32).wrapping_add(j as u32), beyond);
            }
        }
    }
    values
}

/// [`mirrored`] with every digit permuted, zeros after the last among them.
fn permuted(index: u64, base: u32, permutations: &[Vec<u16>]) -> f64 {
    let (mut rest, mut number, mut scale) = (index, 0.0, 1.0);
    for permutation in permutations {
        scale /= f64::from(base);
        number += scale * f64::from(permutation[(rest % u64::from(base)) as usize]);
        rest /= u64::from(base);
    }
    number
}
