//! Where the taps of a filter lie in the square [-1, 1]², and how each receiver turns or shifts them.
//!
//! - Vogel's disk: the spiral of equal areas at golden-angle steps, turned by a random angle (H. Vogel, *A better way
//!   to construct the sunflower head*, 1979).
//! - Box: a lattice of golden-section steps, shifted toroidally by a random vector (R. Cranley, T. Patterson, 1976). Every
//!   row and column of the square is met as evenly as the number of taps allows, so an edge along an axis has as many
//!   grey levels as there are taps.
//! - Tent: the box's points, drawn together so that they are as dense as a tent is high: a filter without corners.
//! - Poisson: points of a disk that keep their distance, each the farthest from all before it of some candidates, turned
//!   like Vogel's (D. Mitchell, *Spectrally Optimal Sampling for Distribution Ray Tracing*, 1991).
//! - Grid: the centres of n × n cells, shifted within a cell.

use crate::real::{Lanes, Real};
use crate::shadow::anchor::{all, lanes};
use crate::shadow::lookup::LOT;
use crate::simd::*;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Vogel,
    Box,
    Grid,
    Tent,
    Poisson,
}

impl Kind {
    /// Whether receivers turn the points, rather than shift them.
    #[inline(always)]
    fn turns(self) -> bool {
        matches!(self, Kind::Vogel | Kind::Poisson)
    }
}

/// Golden angle: cosine and sine of π(3 − √5).
const GOLDEN: (f64, f64) = (-0.737_368_878_078_319_5, 0.675_490_294_261_523_6);
/// The golden section, √5/2 − 1/2.
const SECTION: f64 = 0.618_033_988_749_894_9;
/// Angles that a disk may be turned by, and their step's cosine and sine.
const TURNS: usize = 256;
const STEP: (f64, f64) = (0.999_698_818_696_204_2, 0.024_541_228_522_912_288);

/// Points of a filter.
pub struct Pattern<T> {
    kind: Kind,
    points: Vec<[T; 2]>,
    turns: Vec<[T; 2]>,
    /// Twice the period of a shift: the side of the square, or of a grid's cell.
    cell: T,
    seed: Option<u64>,
    pub samples: usize,
}

/// How a lot of receivers move the points: a matrix in rows, or a shift and half sides.
#[derive(Clone, Copy)]
pub struct Turn<V>(V, V, V, V);

impl<T: Real> Pattern<T> {
    /// `samples` points; for a grid the nearest square number not above it. Without a `seed` every receiver has the
    /// same points.
    pub fn new(kind: Kind, samples: usize, seed: Option<u64>) -> Self {
        let samples = samples.max(1);
        let side = samples.isqrt();
        let points = match kind {
            Kind::Vogel => vogel(samples),
            Kind::Box | Kind::Tent => lattice(samples),
            Kind::Poisson => apart(samples),
            Kind::Grid => grid(side),
        };
        Pattern {
            kind,
            samples: points.len(),
            points: points.into_iter().map(|(x, y)| [T::of(x), T::of(y)]).collect(),
            turns: turns(TURNS, STEP).map(|(c, s)| [T::of(c), T::of(s)]).collect(),
            cell: T::of(if kind == Kind::Grid { 2.0 / side as f64 } else { 2.0 }),
            seed,
        }
    }

    /// The moves of receivers from `index` on, in a filter of the given half sides; `stream` tells filters of one
    /// receiver apart.
    #[inline(always)]
    pub fn turn<S: Simd>(
        &self,
        s: S,
        index: u64,
        stream: u64,
        [half_x, half_y]: [T::V8<S>; 2],
    ) -> Turn<T::V8<S>> {
        let (mut a, mut b) = ([T::zero(); LOT], [T::zero(); LOT]);
        if self.kind.turns() {
            a = [T::one(); LOT];
        }
        if let Some(seed) = self.seed {
            for k in 0..LOT {
                let bits = mix(seed ^ mix((2 * index + stream).wrapping_add(2 * k as u64)));
                (a[k], b[k]) = if self.kind.turns() {
                    let [c, s] = self.turns[bits as usize % TURNS];
                    (c, s)
                } else {
                    // Centred: from minus to plus half a cell.
                    (centred::<T>(bits) * self.cell, centred::<T>(bits >> 16) * self.cell)
                };
            }
        }
        let (a, b) = (lanes::<T, S>(s, a), lanes::<T, S>(s, b));
        if self.kind.turns() {
            Turn(a * half_x, b * half_x, b * half_y, a * half_y)
        } else {
            Turn(a, b, half_x, half_y)
        }
    }

    /// Offsets of one point for all receivers of a lot.
    #[inline(always)]
    pub fn offsets<S: Simd>(&self, s: S, point: usize, turn: &Turn<T::V8<S>>) -> (T::V8<S>, T::V8<S>) {
        let [x, y] = self.points[point];
        let (x, y) = (all::<T, S>(s, x), all::<T, S>(s, y));
        let Turn(a, b, c, d) = *turn;
        if self.kind.turns() {
            return (a * x - b * y, c * x + d * y);
        }
        let (x, y) = match self.kind {
            Kind::Grid => (x + a, y + b),
            Kind::Tent => {
                let (x, y) = (wrapped::<T, S>(s, x + a), wrapped::<T, S>(s, y + b));
                (tent::<T, S>(s, x), tent::<T, S>(s, y))
            }
            _ => (wrapped::<T, S>(s, x + a), wrapped::<T, S>(s, y + b)),
        };
        (x * c, y * d)
    }
}

/// From [-2, 2] back into [-1, 1].
#[inline(always)]
fn wrapped<T: Real, S: Simd>(s: S, x: T::V8<S>) -> T::V8<S> {
    x - Lanes::round(x * all::<T, S>(s, T::of(0.5))) * all::<T, S>(s, T::of(2.0))
}

/// From even density on [-1, 1] to that of a tent.
#[inline(always)]
fn tent<T: Real, S: Simd>(s: S, x: T::V8<S>) -> T::V8<S> {
    let one = all::<T, S>(s, T::one());
    let left = Lanes::max(one - Lanes::abs(x), all::<T, S>(s, T::zero()));
    Lanes::copysign(one - Lanes::sqrt(left), x)
}

/// The lowest 16 bits as a number in (-½, ½).
#[inline(always)]
fn centred<T: Real>(bits: u64) -> T {
    T::of((bits & 0xffff) as f64 + 0.5) * T::of(1.0 / 65536.0) - T::of(0.5)
}

/// Unit vectors at multiples of an angle, by repeated multiplication in double precision: the error of the last of 4096
/// is below 1e-12.
fn turns(n: usize, (c, s): (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    std::iter::successors(Some((1.0, 0.0)), move |&(x, y)| Some((c * x - s * y, s * x + c * y))).take(n)
}

fn vogel(n: usize) -> Vec<(f64, f64)> {
    let radius = |i: usize| ((i as f64 + 0.5) / n as f64).sqrt();
    turns(n, GOLDEN).enumerate().map(|(i, (c, s))| (radius(i) * c, radius(i) * s)).collect()
}

fn lattice(n: usize) -> Vec<(f64, f64)> {
    let even = |i: usize| (i as f64 + 0.5) / n as f64;
    (0..n).map(|i| (2.0 * even(i) - 1.0, 2.0 * (0.5 + i as f64 * SECTION).fract() - 1.0)).collect()
}

/// Candidates for each point that keeps its distance.
const CANDIDATES: usize = 24;

fn apart(n: usize) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = Vec::with_capacity(n);
    let mut state = 0;
    let mut number = || {
        state += 1;
        (mix(state) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    for _ in 0..n {
        let (mut best, mut far) = ((0.0, 0.0), -1.0);
        let mut left = CANDIDATES;
        while left > 0 {
            let (x, y) = (number(), number());
            if x * x + y * y > 1.0 {
                continue;
            }
            left -= 1;
            let near =
                points.iter().map(|p| (p.0 - x) * (p.0 - x) + (p.1 - y) * (p.1 - y)).fold(9.0, f64::min);
            if near > far {
                (best, far) = ((x, y), near);
            }
        }
        points.push(best);
    }
    points
}

fn grid(side: usize) -> Vec<(f64, f64)> {
    let at = |i: usize| (2 * i + 1) as f64 / side as f64 - 1.0;
    (0..side * side).map(|i| (at(i % side), at(i / side))).collect()
}

/// The finaliser of SplitMix64 (S. Vigna, 2015): neighbouring counters give unrelated bits.
#[inline(always)]
fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
