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
use crate::accel::bounds::LARGE;
use crate::accel::morton;
use crate::real::Real;
use rayon::prelude::*;

/// Levels after which intervals are halved; what halving needs at most is in reserve.
const CODED: u32 = MAX_DEPTH as u32 - 28;

/// Codes of centres with their faces, sorted.
pub struct Sorted(Vec<(u64, u32)>);

/// Triangles that one node holds in full blocks.
const NODEFUL: u32 = (BLOCK * WIDTH) as u32;

/// Keys hold this many bits of the face, and above them the highest of the code.
const FACE_BITS: u32 = 27;

/// An interval of the sorted codes, and how deep it lies.
#[derive(Clone, Copy)]
pub struct Interval {
    first: u32,
    count: u32,
    depth: u32,
}

impl Sorted {
    pub fn new<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]], relative: Relative) -> Self {
        let points = relative.points(positions);
        let code = |face: &[i32; 3]| {
            let [a, b, c] = face.map(|v| points[v as usize]);
            let middle = |k: usize| {
                let (low, high) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
                // Twice the centre, in [0, 2]: twenty-one bits.
                (((low + high) * (1 << 20) as f32) as u64).min((1 << 21) - 1)
            };
            morton::encode([middle(0), middle(1), middle(2)])
        };
        let codes: Vec<u64> = faces.par_iter().with_min_len(LARGE).map(code).collect();
        // Integers that hold both sort fastest; what they leave undecided is sorted by the whole code.
        let key = |(face, &code): (usize, &u64)| (code >> (FACE_BITS - 1) << FACE_BITS) | face as u64;
        let mut keys: Vec<u64> = codes.par_iter().enumerate().with_min_len(LARGE).map(key).collect();
        keys.par_sort_unstable();
        let found = |&key: &u64| {
            let face = key & ((1 << FACE_BITS) - 1);
            (codes[face as usize], face as u32)
        };
        let mut sorted: Vec<(u64, u32)> = keys.par_iter().with_min_len(LARGE).map(found).collect();
        drop(keys);
        for run in sorted.chunk_by_mut(|a, b| a.0 >> (FACE_BITS - 1) == b.0 >> (FACE_BITS - 1)) {
            if run.len() > LARGE {
                run.par_sort_unstable();
            } else if run.len() > 1 {
                run.sort_unstable();
            }
        }
        Sorted(sorted)
    }

    pub fn root(&self) -> Interval {
        Interval { first: 0, count: self.0.len() as u32, depth: 0 }
    }

    /// The halves of an interval of two or more.
    #[inline]
    fn halves(&self, i: Interval) -> [Interval; 2] {
        let codes = &self.0[i.first as usize..][..i.count as usize];
        let block = BLOCK as u32;
        let middle = if i.depth >= CODED {
            i.count / 2
        } else {
            let middle = morton::split(codes.len(), |k| codes[k].0) as u32;
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
        let mut front = Front::new();
        for part in &parts[..len] {
            front.push(*part);
        }
        front
    }
    #[inline]
    fn face(&self, at: usize) -> usize {
        self.0[at].1 as usize
    }
}
