//! The additive sequence of the generalised golden ratio: i · (1/φ, 1/φ² …) modulo 1, φ the root of φ^(d+1) = φ + 1.
//!
//! M. Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018.

use super::generator::fraction;
use super::hash::Key;
use super::rows;
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

/// ⌊2⁶⁴ / φ⌋ and ⌊2⁶⁴ / φ²⌋ of the plastic number φ = 1.3247…
const PLASTIC: [u64; 2] = [0xC13F_A9A9_02A6_328F, 0x91E1_0DA5_C79E_7B1C];

/// Point `i` of the sequence in the square, turned by the key's own start; exact to 2⁻³² at the last index.
#[inline(always)]
pub fn rotated_pair<T: Real>(key: Key, i: u32) -> [T; 2] {
    [0, 1].map(|d| {
        let x = PLASTIC[d].wrapping_mul(u64::from(i)).wrapping_add(key.at(d as u64).bits());
        fraction((x >> 32) as u32, x as u32)
    })
}

/// Points `start` …, one row each: `offset` + i · `step` modulo 1, a column for each; both are fractions of 2¹²⁸.
pub fn r2_many<T: Real>(
    watch: &mut dyn Watch,
    steps: &[u128],
    offsets: &[u128],
    start: u64,
    out: &mut [T],
) -> Result<(), Interrupted> {
    rows(watch, out, steps.len(), |i, row| {
        let i = u128::from(start.wrapping_add(i));
        for d in 0..row.len() {
            let x = offsets[d].wrapping_add(steps[d].wrapping_mul(i));
            row[d] = fraction((x >> 96) as u32, (x >> 64) as u32);
        }
    })
}
