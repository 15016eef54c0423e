//! Where the lights of a node are parted: by the orientation and area of both sides, in buckets along each axis.

use super::source::{Source, least, most, nothing};
use crate::real::Real;
use crate::vec::Vec3;

const BUCKETS: usize = 12;

/// Orders lights so that a first part and the rest are cheap together, and says where the rest begins.
pub(super) fn split<T: Real>(
    sources: &[Source<T>],
    middles: &[Vec3<T>],
    lights: &mut [u32],
    depth: u32,
) -> usize {
    let half = lights.len() / 2;
    let (low, high) = lights.iter().fold(nothing(), |(low, high), &i| {
        (low.zip(middles[i as usize], least), high.zip(middles[i as usize], most))
    });
    let size = (high - low).to_array();
    let widest = size.iter().fold(T::zero(), |m, &s| most(m, s));
    // Halves from there on: the trail has 64 turns.
    if !(widest > T::zero()) || depth >= 32 {
        return half;
    }
    let (mut best, mut at) = (f64::INFINITY, (0, 0));
    for axis in 0..3 {
        if !(size[axis] > T::zero()) {
            continue;
        }
        let mut buckets: [Option<Source<T>>; BUCKETS] = [None; BUCKETS];
        for &i in lights.iter() {
            let bucket = &mut buckets[bucket_of(middles[i as usize], low, size, axis)];
            let source = sources[i as usize];
            *bucket = Some(bucket.map_or(source, |b| b.with(&source)));
        }
        let stretch = (widest / size[axis]).to_f64();
        let both = |a: Option<Source<T>>, b: Option<Source<T>>| match (a, b) {
            (Some(a), Some(b)) => Some(a.with(&b)),
            (a, b) => a.or(b),
        };
        for cut in 1..BUCKETS {
            let first = buckets[..cut].iter().copied().fold(None, both);
            let second = buckets[cut..].iter().copied().fold(None, both);
            if let (Some(a), Some(b)) = (first, second) {
                let cost = stretch * (a.cost() + b.cost());
                if cost < best {
                    (best, at) = (cost, (axis, cut));
                }
            }
        }
    }
    let (axis, cut) = at;
    if cut == 0 {
        return half;
    }
    lights.sort_by_key(|&i| bucket_of(middles[i as usize], low, size, axis) >= cut);
    lights.partition_point(|&i| bucket_of(middles[i as usize], low, size, axis) < cut)
}

fn bucket_of<T: Real>(middle: Vec3<T>, low: Vec3<T>, size: [T; 3], axis: usize) -> usize {
    let t = (middle - low).to_array()[axis] / size[axis];
    ((t.to_f64() * BUCKETS as f64) as usize).min(BUCKETS - 1)
}
