//! Batches of rays: where they come from, and where their hits go.
//!
//! A closure of a ray's number will do for either. What knows how its rays lie in memory hands over eight or sixteen
//! at a time, at a fraction of the cost.

use super::ray::Eight;
use super::{Hit, Ray};
use crate::real::Real;
use crate::simd::Simd;

/// Where the rays of a batch come from.
pub trait Source<T: Real> {
    fn ray(&self, i: usize) -> Ray<T>;
    #[inline(always)]
    fn direction(&self, i: usize) -> [T; 3] {
        self.ray(i).direction
    }
    /// Eight rays from `i` on, a multiple of eight.
    #[inline(always)]
    fn eight<S: Simd>(&self, s: S, i: usize) -> Eight<T::V8<S>> {
        Eight::load(
            s,
            #[inline(always)]
            |l| self.ray(i + l),
        )
    }
    /// Whether any ray may ignore a face.
    #[inline(always)]
    fn ignoring(&self) -> bool {
        true
    }
}

impl<T: Real, F: Fn(usize) -> Ray<T>> Source<T> for F {
    #[inline(always)]
    fn ray(&self, i: usize) -> Ray<T> {
        self(i)
    }
}

/// Where the hits of a batch go.
pub trait Sink<T: Real> {
    fn put(&mut self, i: usize, hit: Hit<T>);
    /// The hits of sixteen rays from `i` on, a multiple of sixteen.
    #[inline(always)]
    fn sixteen(&mut self, i: usize, hits: &Sixteen<T>) {
        for l in 0..16 {
            self.put(i + l, hits.get(l));
        }
    }
}

impl<T: Real, F: FnMut(usize, Hit<T>)> Sink<T> for F {
    #[inline(always)]
    fn put(&mut self, i: usize, hit: Hit<T>) {
        self(i, hit);
    }
}

/// Sixteen hits, by component.
pub struct Sixteen<T> {
    pub t: [T; 16],
    pub u: [T; 16],
    pub v: [T; 16],
    pub face: [i32; 16],
}

impl<T: Real> Sixteen<T> {
    #[inline(always)]
    pub fn get(&self, l: usize) -> Hit<T> {
        Hit { t: self.t[l], u: self.u[l], v: self.v[l], face: self.face[l] }
    }
}

/// Rays of a list.
#[derive(Clone, Copy)]
pub struct List<'a, T>(pub &'a [Ray<T>]);

impl<T: Real> Source<T> for List<'_, T> {
    #[inline(always)]
    fn ray(&self, i: usize) -> Ray<T> {
        self.0[i]
    }

    #[inline(always)]
    fn eight<S: Simd>(&self, s: S, i: usize) -> Eight<T::V8<S>> {
        let eight = &self.0[i..i + 8];
        Eight::load(
            s,
            #[inline(always)]
            |l| eight[l],
        )
    }
}
