//! Sobol' sequences, plain or Owen-scrambled: the first 2^k points of each pair of dimensions are far more even than
//! random ones, and after scrambling their averages are unbiased, with an error of order n^(-3/2) on smooth integrands.
//!
//! Points come in natural (not Gray code) order. A point has as many digits as its index; 2⁶⁴ points are there.
//! Scrambling flips each binary digit by a hash of the digits above it (nested uniform scrambling), in one pass over
//! an integer: of the first 32 digits; those below are flipped all at once, by a hash of the 32.
//!
//! S. Joe, F. Y. Kuo, *Constructing Sobol sequences with better two-dimensional projections*, 2008 (direction
//! numbers). A. B. Owen, *Randomly permuted (t, m, s)-nets and (t, s)-sequences*, 1995. S. Laine, T. Karras,
//! *Stratified sampling for stochastic transparency*, 2011; B. Burley, *Practical hash-based Owen scrambling*, 2020.

use super::generator::{fraction, philox4x32};
use super::hash::{Key, mix32};
use super::joe_kuo::{Initial, initials};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::Real;
use std::sync::OnceLock;

pub use super::joe_kuo::DIMENSIONS;

/// The direction numbers of one dimension: digit k of the index contributes column k, its first digit the highest bit.
pub type Columns = [u32; 32];
type Wide = [u64; 64];

/// The direction numbers of all dimensions.
pub fn columns() -> &'static [Columns] {
    static TABLE: OnceLock<Vec<Columns>> = OnceLock::new();
    TABLE.get_or_init(|| wide().map(|v| std::array::from_fn(|k| (v[k] >> 32) as u32)).collect())
}

/// The same for indices of 64 digits.
fn wide() -> impl Iterator<Item = Wide> {
    let first = std::array::from_fn(|k| 1 << (63 - k));
    std::iter::once(first).chain(initials().map(|i| grow(&i)))
}

/// Grows the initial numbers by the recurrence of the polynomial (Joe and Kuo 2008, equation 2).
fn grow(initial: &Initial) -> Wide {
    let s = initial.degree;
    let mut v = [0u64; 64];
    for k in 0..64 {
        v[k] = if k < s {
            u64::from(initial.m[k]) << (63 - k)
        } else {
            let taps = (1..s).filter(|j| initial.polynomial >> (s - j) & 1 == 1);
            taps.fold(v[k - s] ^ (v[k - s] >> s), |x, j| x ^ v[k - j])
        };
    }
    v
}

/// The digits of point `index` in the dimension of `columns`.
#[inline(always)]
pub fn sobol(index: u32, columns: &Columns) -> u32 {
    let (mut x, mut rest) = (0, index);
    while rest != 0 {
        x ^= columns[rest.trailing_zeros() as usize];
        rest &= rest - 1;
    }
    x
}

fn wide_digits(index: u64, columns: &Wide) -> u64 {
    (0..64).filter(|k| index >> k & 1 == 1).fold(0, |x, k| x ^ columns[k])
}

/// What one dimension is scrambled by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scramble([u32; 4]);

impl Scramble {
    /// Independent scrambles for every seed, stream (as of pixels) and dimension.
    #[inline(always)]
    pub fn new(seed: u64, stream: u64, dimension: u32) -> Self {
        // A block far from those that `Generator` hands out for paths.
        let counter = [dimension, 0xFFFF_FFFF, stream as u32, (stream >> 32) as u32];
        Scramble(philox4x32(counter, [seed as u32, (seed >> 32) as u32]))
    }
    /// A scramble for less: by hashing.
    #[inline(always)]
    pub fn keyed(key: Key) -> Self {
        Scramble(key.words())
    }
    /// Owen's scrambling of the digits `x`: every digit is flipped or not by a hash of those above it.
    #[inline(always)]
    pub fn apply(self, x: u32) -> u32 {
        self.reversed(x.reverse_bits()).reverse_bits()
    }
    /// Of digits whose first is the lowest bit: additions, odd multiplications and x ^= x · even carry upwards only.
    #[inline(always)]
    fn reversed(self, mut x: u32) -> u32 {
        let [a, b, c, d] = self.0;
        x = x.wrapping_add(a);
        x ^= x.wrapping_mul(0x6C50_B47C);
        x = x.wrapping_mul(b | 1);
        x ^= x.wrapping_mul(0xB82F_1E52);
        x = x.wrapping_add(c);
        x ^= x.wrapping_mul(0xC7AF_E638);
        x = x.wrapping_mul(d | 1);
        x ^ x.wrapping_mul(0x8D22_F6E6)
    }
    /// The scrambled number in [0, 1); in f64 the digits after the 32nd, all zero before, are hashed as well.
    #[inline(always)]
    pub fn fraction<T: Real>(self, x: u32) -> T {
        self.finish(self.apply(x), 0)
    }
    /// The digits of `index` mirrored at the point and scrambled, and after them `low`.
    #[inline(always)]
    pub fn binary<T: Real>(self, index: u32, low: u32) -> T {
        self.finish(self.reversed(index).reverse_bits(), low)
    }
    /// Scrambled digits, and after them plain ones.
    #[inline(always)]
    fn finish<T: Real>(self, high: u32, low: u32) -> T {
        fraction(high, if size_of::<T>() == 4 { 0 } else { self.below(high, low) })
    }
    /// The digits after scrambled ones.
    #[inline(always)]
    fn below(self, high: u32, low: u32) -> u32 {
        mix32(high ^ self.0[1]) ^ self.0[3] ^ low
    }
}

/// An index in an order of the key's own: aligned blocks of 2^k indices remain such blocks.
#[inline(always)]
pub fn shuffled(key: Key, index: u32) -> u32 {
    Scramble::keyed(key).reversed(index.reverse_bits()).reverse_bits()
}

/// Two coordinates of point `index` of a sequence of the key's own: the first two dimensions, in shuffled order and
/// scrambled. Aligned blocks of 2^k indices remain (0, k, 2)-nets, and sequences of different keys are independent, so
/// any number of pairs can be padded to a point of many dimensions (Burley 2020).
#[inline(always)]
pub fn padded_pair<T: Real>(key: Key, index: u32) -> [T; 2] {
    // The first dimension is the index with its digits reversed.
    let index = shuffled(key.at(0), index);
    // The second is Pascal's triangle modulo 2: digit l is the sum of those digits whose number contains l's bits.
    let mut second = index;
    second ^= second >> 1 & 0x5555_5555;
    second ^= second >> 2 & 0x3333_3333;
    second ^= second >> 4 & 0x0F0F_0F0F;
    second ^= second >> 8 & 0x00FF_00FF;
    second ^= second >> 16;
    let (a, b) = (Scramble::keyed(key.at(1)), Scramble::keyed(key.at(2)));
    [a.finish(a.reversed(index).reverse_bits(), 0), b.finish(b.reversed(second).reverse_bits(), 0)]
}

/// Points `start` … of the sequence, one row each; `seed` scrambles them. Needs start + rows ≤ 2⁶⁴ and no more than
/// [`DIMENSIONS`] columns.
pub fn sobol_many<T: Real>(
    watch: &mut dyn Watch,
    seed: Option<u64>,
    start: u64,
    dimensions: usize,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let table = &columns()[..dimensions];
    let scrambles: Option<Vec<Scramble>> =
        seed.map(|s| (0..dimensions).map(|d| Scramble::new(s, 0, d as u32)).collect());
    let last = start.saturating_add((out.len() / dimensions.max(1)) as u64);
    let wide: Option<Vec<Wide>> = (last > 1 << 32).then(|| wide().take(dimensions).collect());
    let rows = ((1 << 14) / dimensions.max(1)).max(4 * TILE);
    parallel::for_each(watch, Rows { data: out, width: dimensions }, rows, |first, rows| {
        let first = start + first as u64;
        dispatch!(_s => body(first, table, scrambles.as_deref(), wide.as_deref(), rows))
    })
}

/// So many points are made together: they differ in the lowest digits of the index only.
const TILE: usize = 64;
/// Numbers that are written together in long rows, and how long these are.
const LINE: usize = 8;
const MANY: usize = 64;

#[inline(always)]
fn body<T: Real>(
    first: u64,
    table: &[Columns],
    scrambles: Option<&[Scramble]>,
    wide: Option<&[Wide]>,
    rows: Rows<'_, T>,
) {
    let width = rows.width;
    let mut skip = (first % TILE as u64) as usize;
    let (mut aligned, mut rest) = (first - skip as u64, rows.data);
    while !rest.is_empty() {
        let (now, later) = rest.split_at_mut(rest.len().min((TILE - skip) * width));
        let count = now.len() / width;
        let mut d = 0;
        // Rows of many numbers are written by whole cache lines: a column of them would fall on few places of the cache.
        while width >= MANY && d + LINE <= width {
            let mut lines = [[T::zero(); LINE]; TILE];
            for k in 0..LINE {
                let values = column(aligned, table, scrambles, wide, d + k);
                for j in 0..TILE {
                    lines[j][k] = values[j];
                }
            }
            for j in 0..count {
                now[j * width + d..][..LINE].copy_from_slice(&lines[skip + j]);
            }
            d += LINE;
        }
        while d < width {
            let values = column(aligned, table, scrambles, wide, d);
            // Counting by hand: an iterator's `next` would be called outside the dispatch.
            for j in 0..count {
                now[j * width + d] = values[skip + j];
            }
            d += 1;
        }
        (rest, skip) = (later, 0);
        aligned = aligned.wrapping_add(TILE as u64);
    }
}

/// Coordinate `d` of the points of the tile that begins at index `aligned`.
#[inline(always)]
fn column<T: Real>(
    aligned: u64,
    table: &[Columns],
    scrambles: Option<&[Scramble]>,
    wide: Option<&[Wide]>,
    d: usize,
) -> [T; TILE] {
    let (high, low) = match wide {
        Some(wide) => {
            let x = wide_digits(aligned, &wide[d]);
            ((x >> 32) as u32, x as u32)
        }
        None => (sobol(aligned as u32, &table[d]), 0),
    };
    // No closure: it would be called outside the dispatch.
    #[allow(clippy::manual_map)]
    let scramble = match scrambles {
        Some(s) => Some(s[d]),
        None => None,
    };
    tile(high, low, &table[d], scramble)
}

/// One coordinate of the points of a tile, the first of which has the digits `high` and `low`.
#[inline(always)]
fn tile<T: Real>(high: u32, low: u32, columns: &Columns, scramble: Option<Scramble>) -> [T; TILE] {
    let (mut digits, mut values) = ([high; TILE], [T::zero(); TILE]);
    for k in 0..TILE.trailing_zeros() as usize {
        for j in 0..1 << k {
            digits[(1 << k) + j] = digits[j] ^ columns[k];
        }
    }
    match scramble {
        Some(s) => {
            // Integers first, then floats: loops of one width are vectorised.
            let mut lows = [0; TILE];
            for j in 0..TILE {
                digits[j] = s.apply(digits[j]);
                lows[j] = s.below(digits[j], low);
            }
            for j in 0..TILE {
                values[j] = fraction(digits[j], if size_of::<T>() == 4 { 0 } else { lows[j] });
            }
        }
        None => {
            for j in 0..TILE {
                values[j] = fraction(digits[j], low);
            }
        }
    }
    values
}
