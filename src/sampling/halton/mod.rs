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

mod table;

use super::hash::{Key, mix32};
pub use super::primes::PRIMES;
use super::sobol::{Scramble, shuffled};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::Real;
use table::Table;

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

/// What stands above a digit, as a hash.
#[inline(always)]
fn root(key: Key) -> u32 {
    key.bits() as u32 ^ (key.bits() >> 32) as u32
}

/// The next digit permuted, a · digit + c, and the hash of what stands above the one after it.
#[inline(always)]
fn push(hash: u32, base: u32, reciprocal: f32, digit: u32) -> (u32, u32) {
    let g = mix32(hash ^ 0x68E3_1DA4);
    let a = 1 + high_product(g.wrapping_mul(0x9E37_79B1), base - 1);
    let x = a * digit + high_product(g, base);
    // The nearest whole quotient, by the digits beside 2²³: products stay below 2²⁷, so it is the nearest or next to it.
    let q = (x as i32 as f32 * reciprocal + 8_388_608.0).to_bits() & 0x7F_FFFF;
    let r = x.wrapping_sub(q.wrapping_mul(base)) as i32;
    let r = if r < 0 { r + base as i32 } else { r };
    (r as u32, mix32(hash.wrapping_add((digit + 1).wrapping_mul(0x9E37_79B9))))
}

/// The digits as a whole number to one in [0, 1): what is below them is one more, uniform and turned by `beyond`.
#[inline(always)]
fn finish<T: Real>(number: f64, hash: u32, scale: f64, beyond: f64) -> T {
    let below = f64::from(mix32(hash)) * (1.0 / (1u64 << 32) as f64) + beyond;
    let below = if below >= 1.0 { below - 1.0 } else { below };
    below_one((number + below) * scale)
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
/// Where primes run out they come again, scrambled anew, for the points in another order: numbers of one base would else
/// keep step.
#[inline(always)]
pub fn scrambled<T: Real>(key: Key, index: u32, dimension: u32) -> T {
    let round = dimension / PRIMES.len() as u32;
    let index = if round == 0 { index } else { shuffled(key.at(u64::from(round) << 32), index) };
    let (base, key) = (PRIMES[dimension as usize % PRIMES.len()], key.at(u64::from(dimension)));
    if base == 2 {
        return Scramble::keyed(key).fraction(index.reverse_bits());
    }
    let (n, power) = nested_digits(base);
    one(root(key), 0.0, base, u64::from(index), n, power)
}

/// The digits of `index` mirrored at the point, the last of them the first.
fn mirrored(index: u64, base: u32) -> f64 {
    let (mut rest, b) = (index, u64::from(base));
    if index < b {
        return index as f64 / b as f64;
    }
    if index < 1 << 50 {
        let (mut number, mut power) = (0u64, 1u64);
        while rest != 0 {
            (number, power, rest) = (number * b + rest % b, power * b, rest / b);
        }
        return number as f64 / power as f64;
    }
    let (mut number, mut power) = (0u128, 1u128);
    while rest != 0 {
        (number, power, rest) =
            (number * u128::from(b) + u128::from(rest % b), power * u128::from(b), rest / b);
    }
    number as f64 / power as f64
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
    // Plain digits of a large base are no table's, but follow each other row by row.
    let tabled = if scrambling == Scrambling::None { dimensions.min(TABLED) } else { dimensions };
    let (key, limit) = (Key::new(seed, 0), if dimensions > 32 { 512 } else { 4096 });
    let mut tables: Vec<Option<Table>> = (0..tabled).map(|_| None).collect();
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
/// Numbers that are written together in long rows, and how long these are.
const LINE: usize = 8;
const MANY: usize = 64;
/// Dimensions whose numbers are looked up even if they are plain: those of primes up to 509.
const TABLED: usize = 97;

/// Plain coordinates of following indices, dimensions side by side: the last digit of each, and what those above it
/// come to.
struct Counter {
    base: Vec<f64>,
    digit: Vec<f64>,
    tail: Vec<f64>,
    /// The digits above the last, as a number.
    high: Vec<u64>,
}

impl Counter {
    fn new(first: u64, bases: &[u32]) -> Self {
        let mut made = Counter { base: Vec::new(), digit: Vec::new(), tail: Vec::new(), high: Vec::new() };
        for &b in bases {
            let high = first / u64::from(b);
            made.base.push(f64::from(b));
            made.digit.push((first % u64::from(b)) as f64);
            made.high.push(high);
            made.tail.push(mirrored(high, b));
        }
        made
    }

    /// One coordinate each, and on to the next index.
    #[inline(always)]
    fn step<T: Real>(&mut self, out: &mut [T]) {
        let n = out.len();
        let (base, digit, tail) = (&self.base[..n], &mut self.digit[..n], &self.tail[..n]);
        let mut full = 0.0f64;
        for d in 0..n {
            out[d] = below_one((digit[d] + tail[d]) / base[d]);
            digit[d] += 1.0;
            full += if digit[d] == base[d] { 1.0 } else { 0.0 };
        }
        if full == 0.0 {
            return;
        }
        for d in 0..n {
            if self.digit[d] == self.base[d] {
                self.digit[d] = 0.0;
                self.high[d] += 1;
                self.tail[d] = mirrored(self.high[d], self.base[d] as u32);
            }
        }
    }
}

#[inline(always)]
fn body<T: Real>(first: u64, tables: &[Table], rows: Rows<'_, T>) {
    let (width, data) = (rows.width, rows.data);
    let total = data.len() / width;
    // The last index whose upper digits were summed, for each dimension.
    let mut tails = vec![(u64::MAX, 0.0); tables.len()];
    let mut counter = Counter::new(first, &PRIMES[tables.len()..width]);
    let mut start = 0;
    while start < total {
        let count = TILE.min(total - start);
        for i in start..start + count {
            counter.step(&mut data[i * width + tables.len()..(i + 1) * width]);
        }
        let mut d = 0;
        // Rows of many numbers are written by whole cache lines: a column of them would fall on few places of the cache.
        while width >= MANY && d + LINE <= tables.len() {
            let mut lines = [[T::zero(); LINE]; TILE];
            let flat = lines.as_flattened_mut();
            for k in 0..LINE {
                column(
                    &tables[d + k],
                    PRIMES[d + k],
                    &mut tails[d + k],
                    first + start as u64,
                    count,
                    LINE,
                    &mut flat[k..],
                );
            }
            for j in 0..count {
                data[(start + j) * width + d..][..LINE].copy_from_slice(&lines[j]);
            }
            d += LINE;
        }
        while d < tables.len() {
            let out = &mut data[start * width + d..];
            column(&tables[d], PRIMES[d], &mut tails[d], first + start as u64, count, width, out);
            d += 1;
        }
        start += count;
    }
}

/// `count` coordinates from index `first` on, each `width` after the last. `tail` is the last index whose upper digits
/// were summed, and their sum.
#[inline(always)]
fn column<T: Real>(
    table: &Table,
    base: u32,
    tail: &mut (u64, f64),
    first: u64,
    count: usize,
    width: usize,
    out: &mut [T],
) {
    let (mut done, size) = (0, table.size());
    while done < count {
        // A run of indices that agree in all but the digits looked up.
        let index = first + done as u64;
        let (high, low) = if size == 1 { (index, 0) } else { (index / size, (index % size) as usize) };
        let n = (count - done).min((size - low as u64).min(TILE as u64) as usize);
        if tail.0 != high {
            *tail = (high, table.tail(base, high));
        }
        run(table, base, high, low, tail.1, n, width, &mut out[done * width..]);
        done += n;
    }
}

/// `n` coordinates from index `high` · size + `low`, each `width` after the last.
#[inline(always)]
fn run<T: Real>(
    table: &Table,
    base: u32,
    high: u64,
    low: usize,
    tail: f64,
    n: usize,
    width: usize,
    out: &mut [T],
) {
    match table {
        Table::Fixed { numbers, lacks, .. } => {
            let (numbers, lacks) = (&numbers[low..low + n], &lacks[low..low + n]);
            for j in 0..n {
                out[j * width] = below_one(numbers[j] + (lacks[j] + tail));
            }
        }
        Table::Nested { hashes, numbers, digits, power } => {
            let (hashes, numbers) = (&hashes[low..low + n], &numbers[low..low + n]);
            nested(hashes, numbers, base, high, *digits, *power, width, out);
        }
        Table::Binary(scramble) => {
            let beyond = (high as u32).reverse_bits();
            for j in 0..n {
                out[j * width] = scramble.binary((low as u32).wrapping_add(j as u32), beyond);
            }
        }
    }
}

/// A coordinate by itself.
#[inline(always)]
fn one<T: Real>(mut hash: u32, mut number: f64, base: u32, high: u64, digits: u32, power: u64) -> T {
    let mut rest = high;
    for _ in 0..digits {
        let (r, next) = push(hash, base, 1.0 / base as f32, (rest % u64::from(base)) as u32);
        number = number * f64::from(base) + f64::from(r);
        (hash, rest) = (next, rest / u64::from(base));
    }
    finish(number, hash, 1.0 / power as f64, if rest == 0 { 0.0 } else { mirrored(rest, base) })
}

/// Up to [`TILE`] coordinates whose prefixes differ and whose upper digits are the same.
#[inline(always)]
fn nested<T: Real>(
    hashes: &[u32],
    numbers: &[f64],
    base: u32,
    high: u64,
    digits: u32,
    power: u64,
    width: usize,
    out: &mut [T],
) {
    let n = hashes.len().min(TILE);
    if n == 1 {
        out[0] = one(hashes[0], numbers[0], base, high, digits, power);
        return;
    }
    // All lanes work; those without a point on zeros.
    let (mut hash, mut number, mut group) = ([0u32; TILE], [0.0; TILE], [0u32; TILE]);
    let lanes = n.next_multiple_of(8);
    for j in 0..n {
        (hash[j], number[j]) = (hashes[j], numbers[j]);
    }
    let (mut rest, mut size, reciprocal) = (high, 1u32, 1.0 / base as f32);
    for left in (0..digits).rev() {
        let digit = (rest % u64::from(base)) as u32;
        rest /= u64::from(base);
        for j in 0..lanes {
            let (r, next) = push(hash[j], base, reciprocal, digit);
            group[j] = group[j] * base + r;
            hash[j] = next;
        }
        size *= base;
        // Digits are gathered as integers for as long as they fit, then added to the number.
        if left == 0 || u64::from(size) * u64::from(base) >= 1 << 31 {
            for j in 0..lanes {
                number[j] = number[j] * f64::from(size) + f64::from(group[j] as i32);
                group[j] = 0;
            }
            size = 1;
        }
    }
    let (scale, beyond) = (1.0 / power as f64, mirrored(rest, base));
    for j in 0..n {
        out[j * width] = finish(number[j], hash[j], scale, beyond);
    }
}
