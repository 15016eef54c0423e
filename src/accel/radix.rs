//! Sorting of many integers, in parallel: into parts by their highest bits, then each part by itself, in the cache.
//!
//! E. H. Friend, *Sorting on Electronic Computer Systems*, 1956, for the passes from the lowest digit up.

use super::bounds::LARGE;
use crate::memory;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bits by which integers are told apart first: as many parts as addresses that a core can follow while it writes.
const FIRST: u32 = 11;
/// Bits of each pass within a part, and the passes.
const DIGIT: u32 = 9;
const PASSES: u32 = 3;
/// Shorter lists are compared rather than counted.
const SHORT: usize = 192;
/// Parts longer than this leave the cache, and are compared on all threads.
const LONG: usize = 1 << 17;

/// Bits by which [`sort`] tells integers apart.
pub const BITS: u32 = FIRST + DIGIT * PASSES;

/// Sorts integers of `bits` bits, all different, whose order by what lies below the upper [`BITS`] is right already.
/// Leaves them as they come once `stop` is set.
pub fn sort(mut keys: Vec<u64>, bits: u32, stop: &AtomicBool) -> Vec<u64> {
    let going = || !stop.load(Ordering::Relaxed);
    let n = keys.len();
    if n <= LARGE {
        keys.sort_unstable();
        return keys;
    }
    let part = |key: u64| (key >> (bits - FIRST)) as usize & ((1 << FIRST) - 1);
    let chunk = (4 * LARGE).max(n.div_ceil(64));
    let counts: Vec<Vec<u32>> = keys.par_chunks(chunk).map(|keys| count(keys, 1 << FIRST, part)).collect();
    let mut parted = memory::zeros(n, stop);
    if going() {
        scatter(&keys, &mut parted, chunk, &counts, part);
    }
    let sizes: Vec<usize> = (0..1 << FIRST).map(|p| counts.iter().map(|c| c[p] as usize).sum()).collect();
    let mut parts = Vec::with_capacity(1 << FIRST);
    let (mut from, mut to) = (&mut parted[..], &mut keys[..]);
    for size in sizes {
        let (a, rest) = from.split_at_mut(size);
        let (b, more) = to.split_at_mut(size);
        (from, to) = (rest, more);
        if size > 0 {
            parts.push((a, b));
        }
    }
    parts.into_par_iter().filter(|_| going()).for_each(|(a, b)| finish(a, b, bits - BITS));
    keys
}

/// How many keys each part has.
fn count(keys: &[u64], parts: usize, part: impl Fn(u64) -> usize) -> Vec<u32> {
    let mut counts = vec![0u32; parts];
    keys.iter().for_each(|&key| counts[part(key)] += 1);
    counts
}

/// Brings keys into their parts, in the order in which they stand.
fn scatter(
    keys: &[u64],
    into: &mut [u64],
    chunk: usize,
    counts: &[Vec<u32>],
    part: impl Fn(u64) -> usize + Sync,
) {
    // The place of each chunk's keys in each part.
    let mut places: Vec<Vec<std::slice::IterMut<u64>>> =
        counts.iter().map(|_| Vec::with_capacity(1 << FIRST)).collect();
    let mut rest = into;
    for p in 0..1 << FIRST {
        for (places, counts) in places.iter_mut().zip(counts) {
            let (mine, more) = rest.split_at_mut(counts[p] as usize);
            places.push(mine.iter_mut());
            rest = more;
        }
    }
    keys.par_chunks(chunk).zip(places).for_each(|(keys, mut places)| {
        for &key in keys {
            *places[part(key)].next().expect("as many as were counted") = key;
        }
    });
}

/// Sorts a part from `a` into `b`.
fn finish(a: &mut [u64], b: &mut [u64], settled: u32) {
    if a.len() < SHORT || a.len() > LONG {
        if a.len() > LONG {
            a.par_sort_unstable();
        } else {
            a.sort_unstable();
        }
        b.copy_from_slice(a);
        return;
    }
    let digit = |key: u64, pass: u32| (key >> (settled + DIGIT * pass)) as usize & ((1 << DIGIT) - 1);
    let mut counts = [[0u32; 1 << DIGIT]; PASSES as usize];
    for &key in &*a {
        for pass in 0..PASSES {
            counts[pass as usize][digit(key, pass)] += 1;
        }
    }
    let (mut from, mut to) = (a, b);
    for pass in 0..PASSES {
        let ends = &mut counts[pass as usize];
        let mut sum = 0;
        for end in ends.iter_mut() {
            sum += std::mem::replace(end, sum);
        }
        for &key in &*from {
            let place = &mut ends[digit(key, pass)];
            to[*place as usize] = key;
            *place += 1;
        }
        (from, to) = (to, from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keys as of faces along a curve: `crowd` chooses how many share their highest bits.
    fn keys(n: u64, crowd: u32) -> Vec<u64> {
        let code = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 27 >> crowd;
        (0..n).map(|i| code(i) << 27 | i).collect()
    }

    #[test]
    fn keys_of_all_crowds_are_sorted() {
        for n in [0, 1, 2, 1000, LARGE as u64, LARGE as u64 + 1, 300_000] {
            for crowd in [0, 5, 12, 30, 37] {
                let keys = keys(n, crowd);
                let mut expected = keys.clone();
                expected.sort_unstable();
                assert_eq!(sort(keys, 64, &AtomicBool::new(false)), expected, "{n} {crowd}");
            }
        }
    }
}
