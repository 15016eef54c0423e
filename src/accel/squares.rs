//! The order in which arrays of rays are traced: rows of a picture in squares, lists as they stand.

use super::batch::{Sink, Sixteen, Source};
use super::query::{Found, Rays};
use super::ray::Eight;
use super::{Hit, Ray};
use crate::real::Real;
use crate::simd::Simd;

/// Rows of a picture that are traced together, in squares of as many rays a side: neighbours on both axes run more alike
/// than those of one row.
const BAND: usize = 4;
/// Narrower pictures are taken for lists.
const NARROW: usize = 32;

/// The order in which rays of a stretch are traced.
#[derive(Clone, Copy)]
pub struct Order {
    width: usize,
    /// The squares of a band, if it is whole; else rays stand as they are.
    squares: usize,
}

impl Order {
    /// The place in the band of the ray that is traced as number `i`.
    #[inline(always)]
    pub fn place(self, i: usize) -> usize {
        let (square, l) = (i / (BAND * BAND), i % (BAND * BAND));
        if square < self.squares {
            l / BAND * self.width + square * BAND + l % BAND
        } else if self.squares > 0 {
            // Columns beyond the squares.
            let rest = i - self.squares * BAND * BAND;
            rest % BAND * self.width + self.squares * BAND + rest / BAND
        } else {
            i
        }
    }

    /// The places of eight rays from `i` on, a multiple of eight: two runs of four.
    #[inline(always)]
    fn runs(self, i: usize) -> Option<[usize; 2]> {
        let square = i / (BAND * BAND);
        if square < self.squares {
            let at = i % (BAND * BAND) / BAND * self.width + square * BAND;
            Some([at, at + self.width])
        } else if self.squares == 0 {
            Some([i, i + BAND])
        } else {
            None
        }
    }
}

/// Stretches of `count` rays that are traced in one order each: first ray, number of rays, order.
pub fn stretches(width: usize, count: usize) -> impl Iterator<Item = (usize, usize, Order)> {
    let band = if width < NARROW { count.max(1) } else { BAND * width };
    (0..count).step_by(band).map(move |first| {
        let rays = band.min(count - first);
        let whole = width >= NARROW && rays == band;
        (first, rays, Order { width, squares: if whole { width / BAND } else { 0 } })
    })
}

/// A stretch of rays in the order in which they are traced.
#[derive(Clone, Copy)]
pub struct Stretch<'a, T> {
    pub rays: &'a Rays<'a, T>,
    pub start: usize,
    pub order: Order,
}

impl<T: Real> Source<T> for Stretch<'_, T> {
    #[inline(always)]
    fn ray(&self, i: usize) -> Ray<T> {
        self.rays.get(self.start + self.order.place(i))
    }

    #[inline(always)]
    fn direction(&self, i: usize) -> [T; 3] {
        self.rays.directions[self.start + self.order.place(i)]
    }

    #[inline(always)]
    fn eight<S: Simd>(&self, s: S, i: usize) -> Eight<T::V8<S>> {
        let Some([a, b]) = self.order.runs(i) else {
            return Eight::load(
                s,
                #[inline(always)]
                |l| self.ray(i + l),
            );
        };
        let (a, b) = (self.start + a, self.start + b);
        let (low, high) = (one_or_runs(self.rays.t_min, a, b), one_or_runs(self.rays.t_max, a, b));
        let (o, d) = (self.rays.origins, self.rays.directions);
        Eight::of_runs(s, [run(o, a), run(o, b)], [run(d, a), run(d, b)], low, high)
    }

    #[inline(always)]
    fn ignoring(&self) -> bool {
        self.rays.ignore_face.len() != 1 || self.rays.ignore_face[0] >= 0
    }
}

#[inline(always)]
fn one_or_runs<X: Copy>(list: &[X], a: usize, b: usize) -> [[X; BAND]; 2] {
    if list.len() == 1 { [[list[0]; BAND]; 2] } else { [run(list, a), run(list, b)] }
}

#[inline(always)]
fn run<X: Copy>(list: &[X], at: usize) -> [X; BAND] {
    let list = &list[at..at + BAND];
    [list[0], list[1], list[2], list[3]]
}

/// Where the hits of a stretch go.
pub struct Hits<'a, 'b, T> {
    pub found: &'a mut Found<'b, T>,
    pub start: usize,
    pub order: Order,
}

impl<T: Real> Sink<T> for Hits<'_, '_, T> {
    #[inline(always)]
    fn put(&mut self, i: usize, hit: Hit<T>) {
        self.found.put(self.start + self.order.place(i), hit);
    }

    #[inline(always)]
    fn sixteen(&mut self, i: usize, hits: &Sixteen<T>) {
        for half in [0, 8] {
            let Some(runs) = self.order.runs(i + half) else {
                for l in half..half + 8 {
                    self.put(i + l, hits.get(l));
                }
                continue;
            };
            for r in 0..2 {
                let (at, l) = (self.start + runs[r], half + BAND * r);
                self.found.t[at..at + BAND].copy_from_slice(&hits.t[l..l + BAND]);
                self.found.u[at..at + BAND].copy_from_slice(&hits.u[l..l + BAND]);
                self.found.v[at..at + BAND].copy_from_slice(&hits.v[l..l + BAND]);
                self.found.face[at..at + BAND].copy_from_slice(&hits.face[l..l + BAND]);
            }
        }
    }
}

/// Rays a task: whole bands of a picture.
pub fn task(rays: usize, width: usize) -> usize {
    if width < NARROW { rays } else { rays.next_multiple_of(BAND * width) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ray_has_its_turn_once() {
        for width in [0, 1, 4, 31, 32, 33, 34, 35, 70] {
            for count in [0, 1, 3, 4 * width, 7 * width, 12 * width + 5] {
                let mut seen = vec![0; count];
                for (start, rays, order) in stretches(width, count) {
                    (0..rays).for_each(|i| seen[start + order.place(i)] += 1);
                }
                assert!(seen.iter().all(|&n| n == 1), "{width} {count}");
            }
        }
    }
}
