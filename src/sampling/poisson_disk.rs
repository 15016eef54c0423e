//! Random points no two of which are nearer than a radius, as many as fit nearly: blue noise.
//!
//! From each point on the front, candidates are thrown into the shell from one to two radii around it; those far from
//! all others are kept. A grid whose cells hold one point each finds the others. Linear in the number of points.
//!
//! R. Bridson, *Fast Poisson disk sampling in arbitrary dimensions*, 2007.

use super::hash::Key;
use crate::parallel::{self, Interrupted, Watch};
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// [0, 1)^D, distances within it.
    Square,
    /// [0, 1)^D, distances around its edges.
    Torus,
    /// The ball of radius 1 about the origin.
    Disk,
}

/// Stops this often to look whether it should.
const PATIENCE: usize = 256;

/// The points, in the order in which they were found. `radius` is above zero, and below 1/2 on the torus.
pub fn poisson_disk<const D: usize>(
    watch: &mut dyn Watch,
    domain: Domain,
    radius: f64,
    attempts: u32,
    seed: u64,
) -> Result<Vec<[f64; D]>, Interrupted> {
    parallel::run_forking(watch, |stop| throw(domain, radius, attempts, Key::new(seed, 4), stop))
}

fn throw<const D: usize>(
    domain: Domain,
    radius: f64,
    attempts: u32,
    key: Key,
    stop: &AtomicBool,
) -> Vec<[f64; D]> {
    let mut draws = 0u64;
    let mut uniform = || {
        draws += 1;
        key.at(draws).uniform::<f64>()
    };
    let mut grid = Grid::<D>::new(domain, radius);
    let first = loop {
        let p = std::array::from_fn(|_| grid.low + grid.extent * uniform());
        if inside(domain, &p) {
            break p;
        }
    };
    grid.insert(first);
    let (mut points, mut front) = (vec![first], vec![0usize]);
    let mut rounds = 0usize;
    while !front.is_empty() {
        rounds += 1;
        if rounds.is_multiple_of(PATIENCE) && stop.load(Ordering::Relaxed) {
            break;
        }
        let at = ((uniform() * front.len() as f64) as usize).min(front.len() - 1);
        let centre = points[front[at]];
        let mut found = false;
        for _ in 0..attempts {
            let step = loop {
                let v: [f64; D] = std::array::from_fn(|_| radius * (4.0 * uniform() - 2.0));
                let square: f64 = v.iter().map(|x| x * x).sum();
                if square >= radius * radius && square < 4.0 * radius * radius {
                    break v;
                }
            };
            let mut p: [f64; D] = std::array::from_fn(|d| centre[d] + step[d]);
            if domain == Domain::Torus {
                p = p.map(|x| x - x.floor()).map(|x| if x < 1.0 { x } else { 0.0 });
            }
            if inside(domain, &p) && grid.is_free(&p) {
                grid.insert(p);
                front.push(points.len());
                points.push(p);
                found = true;
                break;
            }
        }
        if !found {
            front.swap_remove(at);
        }
    }
    points
}

fn inside<const D: usize>(domain: Domain, p: &[f64; D]) -> bool {
    match domain {
        Domain::Square => p.iter().all(|&x| (0.0..1.0).contains(&x)),
        Domain::Torus => true,
        Domain::Disk => p.iter().map(|x| x * x).sum::<f64>() <= 1.0,
    }
}

/// Cells so small that none holds two points; those that might reach a point are `reach` around its own.
struct Grid<const D: usize> {
    domain: Domain,
    radius: f64,
    low: f64,
    extent: f64,
    side: usize,
    reach: i64,
    cells: Vec<[f64; D]>,
}

impl<const D: usize> Grid<D> {
    fn new(domain: Domain, radius: f64) -> Self {
        let (low, extent) = if domain == Domain::Disk { (-1.0, 2.0) } else { (0.0, 1.0) };
        let side = ((extent * (D as f64).sqrt() / radius).ceil() as usize).max(1);
        let reach = (radius * side as f64 / extent).ceil() as i64;
        Grid { domain, radius, low, extent, side, reach, cells: vec![[f64::NAN; D]; side.pow(D as u32)] }
    }
    fn place(&self, p: &[f64; D]) -> [i64; D] {
        p.map(|x| (((x - self.low) / self.extent * self.side as f64) as i64).min(self.side as i64 - 1))
    }
    fn index(&self, cell: [i64; D]) -> Option<usize> {
        let side = self.side as i64;
        let cell = if self.domain == Domain::Torus { cell.map(|c| c.rem_euclid(side)) } else { cell };
        let within = cell.iter().all(|c| (0..side).contains(c));
        within.then(|| cell.iter().fold(0, |i, &c| i * self.side + c as usize))
    }
    fn insert(&mut self, p: [f64; D]) {
        if let Some(i) = self.index(self.place(&p)) {
            self.cells[i] = p;
        }
    }
    fn is_free(&self, p: &[f64; D]) -> bool {
        let (place, width) = (self.place(p), 2 * self.reach + 1);
        (0..width.pow(D as u32)).all(|k| {
            let mut rest = k;
            let cell = place.map(|c| {
                let offset = rest % width - self.reach;
                rest /= width;
                c + offset
            });
            // An empty cell is NaN, which is near to nothing.
            self.index(cell).is_none_or(|i| !(self.square(p, &self.cells[i]) < self.radius * self.radius))
        })
    }
    fn square(&self, p: &[f64; D], q: &[f64; D]) -> f64 {
        let mut sum = 0.0;
        for d in 0..D {
            let x = (p[d] - q[d]).abs();
            let x = if self.domain == Domain::Torus && x > 0.5 { 1.0 - x } else { x };
            sum += x * x;
        }
        sum
    }
}
