//! Sobol' sequences, plain or Owen-scrambled: the first 2^k points of each pair of dimensions are far more even than
//! random ones, and after scrambling their averages are unbiased, with an error of order n^(-3/2) on smooth integrands.
//!
//! Points come in natural (not Gray code) order, with 32 digits; from 2³² on a sequence would repeat. Scrambling
//! flips each binary digit by a hash of the digits above it (nested uniform scrambling), in one pass over an integer.
//!
//! S. Joe, F. Y. Kuo, *Constructing Sobol sequences with better two-dimensional projections*, 2008 (direction
//! numbers). A. B. Owen, *Randomly permuted (t, m, s)-nets and (t, s)-sequences*, 1995. S. Laine, T. Karras,
//! *Stratified sampling for stochastic transparency*, 2011; B. Burley, *Practical hash-based Owen scrambling*, 2020.

use super::generator::{fraction, philox4x32};
use super::joe_kuo::JOE_KUO;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::Real;
use std::sync::OnceLock;

/// How many dimensions there are direction numbers for.
pub const DIMENSIONS: usize = JOE_KUO.len() + 1;

/// The direction numbers of one dimension: digit k of the index contributes column k.
pub type Columns = [u32; 32];

/// The direction numbers of all dimensions.
pub fn columns() -> &'static [Columns] {
    static TABLE: OnceLock<Vec<Columns>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let first = std::array::from_fn(|k| 1 << (31 - k));
        std::iter::once(first).chain(JOE_KUO.iter().map(|&(poly, m)| grow(poly, m))).collect()
    })
}

/// Grows the initial numbers `m` by the recurrence of the polynomial (Joe and Kuo 2008, equation 2).
fn grow(poly: u32, m: &[u32]) -> Columns {
    let s = m.len();
    let mut v = [0u32; 32];
    for k in 0..32 {
        v[k] = if k < s {
            m[k] << (31 - k)
        } else {
            let taps = (1..s).filter(|j| poly >> (s - j) & 1 == 1);
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
    /// Owen's scrambling of the digits `x`: every digit is flipped or not by a hash of those above it.
    ///
    /// On the reversed digits, additions, odd multiplications and x ^= x · even carry upwards only.
    #[inline(always)]
    pub fn apply(self, x: u32) -> u32 {
        let [a, b, c, d] = self.0;
        let mut x = x.reverse_bits();
        x = x.wrapping_add(a);
        x ^= x.wrapping_mul(0x6C50_B47C);
        x = x.wrapping_mul(b | 1);
        x ^= x.wrapping_mul(0xB82F_1E52);
        x = x.wrapping_add(c);
        x ^= x.wrapping_mul(0xC7AF_E638);
        x = x.wrapping_mul(d | 1);
        x ^= x.wrapping_mul(0x8D22_F6E6);
        x.reverse_bits()
    }
    /// The scrambled number in [0, 1); in f64 the digits after the 32nd, all zero before, are hashed as well.
    #[inline(always)]
    pub fn fraction<T: Real>(self, x: u32) -> T {
        let high = self.apply(x);
        let low = if size_of::<T>() == 4 { 0 } else { mix(high ^ self.0[1]) ^ self.0[3] };
        fraction(high, low)
    }
}

/// A bijection of 32 bits without pattern (constants of C. Wellons' search for low bias, 2018).
#[inline(always)]
fn mix(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7FEB_352D);
    x = (x ^ (x >> 15)).wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

/// Points `start` … of the sequence, one row each; `seed` scrambles them. Needs start + rows ≤ 2³² and no more than
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
    let rows = ((1 << 14) / dimensions.max(1)).max(1);
    parallel::for_each(watch, Rows { data: out, width: dimensions }, rows, |first, rows| {
        let first = (start + first as u64) as u32;
        dispatch!(_s => body(first, table, scrambles.as_deref(), rows))
    })
}

#[inline(always)]
fn body<T: Real>(first: u32, table: &[Columns], scrambles: Option<&[Scramble]>, rows: Rows<'_, T>) {
    // Column by column: from one index to the next the lowest digits flip, so a prefix of the columns is added.
    for (d, columns) in table.iter().enumerate() {
        let mut prefix = *columns;
        (1..32).for_each(|k| prefix[k] ^= prefix[k - 1]);
        let (mut index, mut x) = (first, sobol(first, columns));
        for value in rows.data.iter_mut().skip(d).step_by(rows.width) {
            *value = scrambles.map_or_else(|| fraction(x, 0), |s| s[d].fraction(x));
            // Past the last index of all there is nothing to prepare: 32 trailing ones wrap to the start.
            x ^= prefix[(index.trailing_ones() as usize).min(31)];
            index = index.wrapping_add(1);
        }
    }
}
