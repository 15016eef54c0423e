//! Thresholds of a tile such that the pixels below any threshold are evenly spread, around its edges too.
//!
//! Void and cluster: pixels repel each other by a Gaussian; the tightest cluster is thinned and the largest void filled,
//! one pixel after the other, and the order is the mask. A step changes the energies near one pixel alone, and minima
//! are kept for every segment of a row, so that a mask of N pixels takes about N^1.5 / 32 operations and a small factor.
//!
//! R. Ulichney, *The void-and-cluster method for dither array generation*, 1993.

use super::hash::{Key, permute};
use crate::math::exp;
use crate::parallel::{self, Interrupted, Watch};
use std::sync::atomic::{AtomicBool, Ordering};

const SEGMENT: usize = 32;

/// The rank of each pixel, row by row.
pub fn blue_noise_mask(
    watch: &mut dyn Watch,
    width: usize,
    height: usize,
    sigma: f64,
    seed: u64,
) -> Result<Vec<u32>, Interrupted> {
    parallel::run_forking(watch, |stop| ranks(width, height, sigma, Key::new(seed, 5), stop))
}

fn ranks(width: usize, height: usize, sigma: f64, key: Key, stop: &AtomicBool) -> Vec<u32> {
    let n = width * height;
    let mut ranks = vec![0; n];
    let mut energy = Energy::new(width, height, sigma, key);
    let ones = (n / 10).max(1);
    for i in 0..ones {
        energy.set(permute(i as u32, n as u32, key.at(0)) as usize, true);
    }
    // The first pattern: clusters move to voids until none would.
    for step in 0..16 * n {
        if step % 256 == 0 && stop.load(Ordering::Relaxed) {
            return ranks;
        }
        let cluster = energy.tightest();
        energy.set(cluster, false);
        let void = energy.emptiest();
        energy.set(void, true);
        if void == cluster {
            break;
        }
    }
    let mut thinned = energy.clone();
    for rank in (0..ones).rev() {
        let cluster = thinned.tightest();
        thinned.set(cluster, false);
        ranks[cluster] = rank as u32;
    }
    for rank in ones..n {
        if rank % 256 == 0 && stop.load(Ordering::Relaxed) {
            return ranks;
        }
        let void = energy.emptiest();
        energy.set(void, true);
        ranks[void] = rank as u32;
    }
    ranks
}

/// What the pixels that are set do to each place.
#[derive(Clone)]
struct Energy {
    width: usize,
    /// A Gaussian of the distance around the edges, along each axis.
    across: Vec<(usize, f32)>,
    down: Vec<(usize, f32)>,
    set: Vec<bool>,
    /// A tiny part of it random, so that ties are broken without a preferred place.
    energy: Vec<f32>,
    /// The least energy of a place that is not set and the largest of one that is, for each segment of a row.
    least: Vec<f32>,
    most: Vec<f32>,
    segments: usize,
}

impl Energy {
    fn new(width: usize, height: usize, sigma: f64, key: Key) -> Self {
        let segments = width.div_ceil(SEGMENT);
        let tie = |i: usize| (key.at(1).at(i as u64).bits() >> 40) as f32 * (1e-6 / (1u32 << 24) as f32);
        let mut new = Energy {
            width,
            across: gaussian(width, sigma),
            down: gaussian(height, sigma),
            set: vec![false; width * height],
            energy: (0..width * height).map(tie).collect(),
            least: vec![0.0; segments * height],
            most: vec![0.0; segments * height],
            segments,
        };
        (0..segments * height).for_each(|s| new.summarize(s));
        new
    }
    fn set(&mut self, at: usize, on: bool) {
        let (x, y, height) = (at % self.width, at / self.width, self.set.len() / self.width);
        self.set[at] = on;
        let sign = if on { 1.0 } else { -1.0 };
        let mut touched = vec![false; self.segments];
        for k in 0..self.across.len() {
            touched[(x + self.across[k].0) % self.width / SEGMENT] = true;
        }
        for j in 0..self.down.len() {
            let (dy, b) = self.down[j];
            let row = (y + dy) % height;
            for &(dx, a) in &self.across {
                let column = x + dx;
                let column = if column < self.width { column } else { column - self.width };
                self.energy[row * self.width + column] += sign * a * b;
            }
            for s in 0..self.segments {
                if touched[s] {
                    self.summarize(row * self.segments + s);
                }
            }
        }
    }
    fn span(&self, segment: usize) -> std::ops::Range<usize> {
        let (row, s) = (segment / self.segments, segment % self.segments);
        row * self.width + s * SEGMENT..row * self.width + ((s + 1) * SEGMENT).min(self.width)
    }
    fn summarize(&mut self, segment: usize) {
        let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
        let span = self.span(segment);
        for (&e, &set) in self.energy[span.clone()].iter().zip(&self.set[span]) {
            let (low, high) = if set { (f32::INFINITY, e) } else { (e, f32::NEG_INFINITY) };
            least = if low < least { low } else { least };
            most = if high > most { high } else { most };
        }
        (self.least[segment], self.most[segment]) = (least, most);
    }
    /// The place that is set and most crowded.
    fn tightest(&self) -> usize {
        let segment = (0..self.most.len()).fold(0, |b, s| if self.most[s] > self.most[b] { s } else { b });
        self.find(segment, true, self.most[segment])
    }
    /// The place that is not set and least crowded.
    fn emptiest(&self) -> usize {
        let segment = (0..self.least.len()).fold(0, |b, s| if self.least[s] < self.least[b] { s } else { b });
        self.find(segment, false, self.least[segment])
    }
    fn find(&self, segment: usize, set: bool, energy: f32) -> usize {
        let mut span = self.span(segment);
        let start = span.start;
        span.find(|&i| self.set[i] == set && self.energy[i] == energy).unwrap_or(start)
    }
}

/// exp(-d² / 2σ²) of distances around a circle of `n` places, where it matters: (offset, value).
fn gaussian(n: usize, sigma: f64) -> Vec<(usize, f32)> {
    let reach = (6.0 * sigma).ceil() as i64;
    let mut sums = vec![0.0f64; n];
    for d in -reach..=reach {
        let x = d as f64 / sigma;
        sums[d.rem_euclid(n as i64) as usize] += exp(-0.5 * x * x);
    }
    sums.into_iter().enumerate().filter(|&(_, g)| g > 0.0).map(|(d, g)| (d, g as f32)).collect()
}
