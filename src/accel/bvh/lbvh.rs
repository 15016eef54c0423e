//! The tree that Morton order implies: triangles sorted along the curve, and cut where the highest bit changes.
//!
//! The binary radix tree is never stored: its subtrees are intervals of the sorted codes, and a node's eight children are
//! found by cutting the longest interval until there are eight.
//!
//! C. Lauterbach, M. Garland, S. Sengupta, D. Luebke, D. Manocha, *Fast BVH Construction on GPUs*, 2009; T. Karras,
//! *Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees*, 2012.

use super::boxes::Relative;
use super::collapse::{Front, Tree};
use super::node::{MAX_DEPTH, WIDTH};
use crate::accel::block::BLOCK;
use crate::accel::bounds::{LARGE, vertex};
use crate::accel::{morton, radix};
use crate::dispatch;
use crate::memory;
use crate::real::Real;
use crate::simd::Simd;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Levels after which intervals are halved; what halving needs at most is in reserve.
const CODED: u32 = MAX_DEPTH as u32 - 28;

/// Faces in the order of their centres' codes.
pub struct Sorted {
    /// The upper bits of the code, and below them the face.
    keys: Vec<u64>,
    /// The other bits of the code, if faces that share the upper ones are more than a block; else empty.
    lower: Vec<u32>,
}

/// Triangles that one node holds in full blocks.
const NODEFUL: u32 = (BLOCK * WIDTH) as u32;

/// Keys hold this many bits of the face.
const FACE_BITS: u32 = 27;
/// The bits of a code that keys have no room for.
const LOWER_BITS: u32 = FACE_BITS - 1;

/// An interval of the sorted codes, and how deep it lies.
#[derive(Clone, Copy)]
pub struct Interval {
    first: u32,
    count: u32,
    depth: u32,
}

impl Sorted {
    /// Of no use once `stop` is set.
    pub fn new<T: Real>(
        positions: &[[T; 3]],
        faces: &[[i32; 3]],
        relative: Relative,
        stop: &AtomicBool,
    ) -> Self {
        let mut keys = memory::zeros::<u64>(faces.len(), stop);
        keys.par_chunks_mut(LARGE).enumerate().for_each(|(chunk, keys)| {
            if stop.load(Ordering::Relaxed) {
                return;
            }
            let first = chunk * LARGE;
            let faces = &faces[first..first + keys.len()];
            dispatch!(s => write_codes(s, positions, faces, relative, keys));
            for (i, key) in keys.iter_mut().enumerate() {
                *key = *key >> LOWER_BITS << FACE_BITS | (first + i) as u64;
            }
        });
        let mut sorted = Sorted { keys: radix::sort(keys, 64, stop), lower: vec![] };
        if stop.load(Ordering::Relaxed) {
            return sorted;
        }
        sorted.sort_lower(|face| {
            let mut code = [0];
            let face = &faces[face..face + 1];
            dispatch!(s => write_codes(s, positions, face, relative, &mut code));
            code[0] & ((1 << LOWER_BITS) - 1)
        });
        sorted
    }

    /// Sorts faces that share the upper bits of their code by the lower ones.
    fn sort_lower(&mut self, lower: impl Fn(usize) -> u64 + Sync) {
        let Sorted { keys, lower: list } = self;
        let n = keys.len();
        let mut first = 0;
        while first + BLOCK < n {
            let upper = keys[first] >> FACE_BITS;
            if keys[first + BLOCK] >> FACE_BITS != upper {
                first += 1;
                continue;
            }
            let run = first + keys[first..].partition_point(|key| key >> FACE_BITS == upper);
            let keys = &mut keys[first..run];
            let swap = |key: &mut u64| *key = lower(face_of(*key)) << FACE_BITS | face_of(*key) as u64;
            keys.par_iter_mut().with_min_len(LARGE).for_each(swap);
            keys.par_sort_unstable();
            list.resize(n, 0);
            for (key, lower) in keys.iter_mut().zip(&mut list[first..run]) {
                *lower = (*key >> FACE_BITS) as u32;
                *key = upper << FACE_BITS | face_of(*key) as u64;
            }
            first = run;
        }
    }

    pub fn root(&self) -> Interval {
        Interval { first: 0, count: self.keys.len() as u32, depth: 0 }
    }

    /// Where the codes of an interval are cut.
    #[inline]
    fn cut(&self, i: Interval) -> usize {
        let span = i.first as usize..(i.first + i.count) as usize;
        let keys = &self.keys[span.clone()];
        if keys[0] >> FACE_BITS != keys[keys.len() - 1] >> FACE_BITS {
            return morton::split(keys.len(), |k| keys[k]);
        }
        // A block that shares its upper bits is cut anywhere.
        let lower = self.lower.get(span).unwrap_or(&[]);
        if lower.is_empty() { keys.len() / 2 } else { morton::split(lower.len(), |k| lower[k] as u64) }
    }

    /// The halves of an interval of two or more.
    #[inline]
    fn halves(&self, i: Interval) -> [Interval; 2] {
        let block = BLOCK as u32;
        let middle = if i.depth >= CODED {
            i.count / 2
        } else {
            let middle = self.cut(i) as u32;
            // Near the leaves, at the nearest border of a full block.
            let full = ((middle + block / 2) / block * block).clamp(block, (i.count - 1) / block * block);
            if i.count <= NODEFUL { full } else { middle }
        };
        let depth = i.depth + 1;
        [
            Interval { first: i.first, count: middle, depth },
            Interval { first: i.first + middle, count: i.count - middle, depth },
        ]
    }
}

fn face_of(key: u64) -> usize {
    (key & ((1 << FACE_BITS) - 1)) as usize
}

/// The codes of faces' centres.
#[inline(always)]
fn write_codes<T: Real, S: Simd>(
    s: S,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    relative: Relative,
    codes: &mut [u64],
) {
    for (&[a, b, c], code) in faces.iter().zip(codes) {
        let [a, b, c] = [vertex(s, positions, a), vertex(s, positions, b), vertex(s, positions, c)];
        let [x, y, z] = relative.centre::<T, S>([a, b, c]);
        *code = morton::encode([cell(x), cell(y), cell(z)]);
    }
}

/// Twenty-one bits of a number in 0 … 2.
#[inline(always)]
fn cell(x: f64) -> u64 {
    // Through 32 bits, which lanes can convert to.
    (x * (1 << 20) as f64).min(((1 << 21) - 1) as f64) as i32 as u64
}

impl Tree for Sorted {
    type Part = Interval;

    #[inline]
    fn span(&self, part: Interval) -> (usize, usize, bool) {
        (part.first as usize, part.count as usize, part.count as usize <= BLOCK)
    }
    fn front(&self, part: Interval) -> Front<Interval> {
        let mut parts = [part; WIDTH];
        let mut len = 1;
        // What fits into one node is left to it; what is one node is cut into its blocks.
        let enough = if part.count <= NODEFUL { BLOCK as u32 } else { NODEFUL };
        while len < WIDTH {
            let mut largest = 0;
            for k in 1..len {
                if parts[k].count > parts[largest].count {
                    largest = k;
                }
            }
            if parts[largest].count <= enough {
                break;
            }
            // Kept in order along the curve.
            let halves = self.halves(parts[largest]);
            parts.copy_within(largest + 1..len, largest + 2);
            parts[largest..largest + 2].copy_from_slice(&halves);
            len += 1;
        }
        Front::new(parts, len)
    }
    #[inline]
    fn face(&self, at: usize) -> usize {
        face_of(self.keys[at])
    }
}
