//! The star discrepancy: the largest difference between a box's volume and the share of the points in it, over all boxes
//! from the origin. Exact, up to rounding: the largest is at a box whose sides pass through points.
//!
//! Two axes are swept, the others enumerated. Between two places along an axis the difference cannot change by more than
//! the volume and the points between them, so places that cannot reach the best found so far are passed over.
//!
//! H. Niederreiter, *Discrepancy and convex programming*, 1972. Bounds of this kind: D. P. Dobkin, D. Eppstein,
//! D. P. Mitchell, *Computing the discrepancy with applications to supersampling patterns*, 1996.

use crate::parallel::{self, Interrupted, Watch};
use std::sync::atomic::{AtomicBool, Ordering};

/// Of points of `dimensions` ≥ 1 coordinates in [0, 1], one row each.
pub fn star_discrepancy(
    watch: &mut dyn Watch,
    points: &[f64],
    dimensions: usize,
) -> Result<f64, Interrupted> {
    if dimensions == 1 {
        return Ok(on_a_line(points));
    }
    let columns: Vec<Vec<f64>> =
        (0..dimensions).map(|d| points.iter().skip(d).step_by(dimensions).copied().collect()).collect();
    parallel::run_forking(watch, |stop| Boxes::new(&columns, stop).largest())
}

/// Niederreiter 1992, *Random number generation and quasi-Monte Carlo methods*, theorem 2.6.
fn on_a_line(points: &[f64]) -> f64 {
    let (mut sorted, n) = (points.to_vec(), points.len() as f64);
    sorted.sort_by(f64::total_cmp);
    let apart = sorted.iter().enumerate().map(|(i, x)| (x - (i as f64 + 0.5) / n).abs());
    0.5 / n + apart.fold(0.0, f64::max)
}

struct Boxes<'a> {
    columns: &'a [Vec<f64>],
    n: f64,
    /// Of the second axis: the distinct coordinates, and each point's place among them.
    levels: Vec<f64>,
    level: Vec<u32>,
    /// The points in the order of the first axis.
    order: Vec<u32>,
    stop: &'a AtomicBool,
    best: f64,
}

impl<'a> Boxes<'a> {
    fn new(columns: &'a [Vec<f64>], stop: &'a AtomicBool) -> Self {
        let levels = distinct(&columns[1]);
        let level = columns[1].iter().map(|y| levels.partition_point(|l| l < y) as u32).collect();
        let mut order: Vec<u32> = (0..columns[0].len() as u32).collect();
        order.sort_by(|&a, &b| columns[0][a as usize].total_cmp(&columns[0][b as usize]));
        Boxes { columns, n: columns[0].len() as f64, levels, level, order, stop, best: 0.0 }
    }
    fn largest(mut self) -> f64 {
        let all = vec![true; self.order.len()];
        self.enumerate(self.columns.len() - 1, 1.0, &all, &all);
        self.best
    }
    /// Boxes whose axes above `axis` are chosen: they have the volume `size`, and hold the points `closed`, or those of
    /// `open` without their upper faces. Returns the largest of these alone, or a bound of it that is below the best.
    fn enumerate(&mut self, axis: usize, size: f64, closed: &[bool], open: &[bool]) -> f64 {
        if axis == 1 {
            return self.sweep(size, closed, open);
        }
        let columns = self.columns;
        let column = &columns[axis];
        let mut ends = distinct(column);
        ends.push(1.0);
        let mut largest = 0.0f64;
        let mut sorted: Vec<f64> = column.iter().zip(closed).filter(|(_, c)| **c).map(|(x, _)| *x).collect();
        sorted.sort_by(f64::total_cmp);
        let mut last: Option<(f64, f64)> = None;
        for &end in ends.iter().rev() {
            if self.stop.load(Ordering::Relaxed) {
                break;
            }
            if let Some((found, from)) = last {
                let between = sorted.partition_point(|x| *x <= from) - sorted.partition_point(|x| *x < end);
                let bound = found + size * (from - end) + between as f64 / self.n;
                if bound <= self.best {
                    largest = largest.max(bound);
                    continue;
                }
            }
            let now_closed: Vec<bool> = closed.iter().zip(column).map(|(c, x)| *c && *x <= end).collect();
            let now_open: Vec<bool> = open.iter().zip(column).map(|(o, x)| *o && *x < end).collect();
            let found = self.enumerate(axis - 1, size * end, &now_closed, &now_open);
            largest = largest.max(found);
            last = Some((found, end));
        }
        largest
    }
    /// All boxes of the first two axes; the result as of [`Boxes::enumerate`].
    fn sweep(&mut self, size: f64, closed: &[bool], open: &[bool]) -> f64 {
        let mut counts = Counts::new(self.levels.len());
        // Bounds of the excess in closed boxes, which points raise, and of the lack in open ones, which volume does.
        let (mut largest, mut excess, mut lack) = (0.0f64, 0.0f64, 0.0f64);
        let (mut i, mut x_last, xs) = (0, 0.0, &self.columns[0]);
        loop {
            let x = self.order.get(i).map_or(1.0, |&p| xs[p as usize]);
            lack += size * (x - x_last);
            x_last = x;
            if lack > self.best {
                lack = counts.lack(&self.levels, size * x, self.n);
                self.best = self.best.max(lack);
            }
            if i == self.order.len() || self.stop.load(Ordering::Relaxed) {
                return largest.max(lack);
            }
            while i < self.order.len() && xs[self.order[i] as usize] == x {
                let p = self.order[i] as usize;
                let level = self.level[p] as usize;
                counts.closed[level] += u32::from(closed[p]);
                counts.open[level] += u32::from(open[p]);
                excess += f64::from(u8::from(closed[p])) / self.n;
                i += 1;
            }
            if excess > self.best {
                excess = counts.excess(&self.levels, size * x, self.n);
                self.best = self.best.max(excess);
            }
            largest = largest.max(lack).max(excess);
        }
    }
}

/// How many points lie at each level of the second axis.
struct Counts {
    closed: Vec<u32>,
    open: Vec<u32>,
}

impl Counts {
    fn new(levels: usize) -> Self {
        Counts { closed: vec![0; levels], open: vec![0; levels] }
    }
    /// The largest lack of points in boxes of `width` that end below a level, or at 1.
    fn lack(&self, levels: &[f64], width: f64, n: f64) -> f64 {
        let (mut below, mut largest) = (0u32, 0.0);
        for (&y, &count) in levels.iter().zip(&self.open) {
            let lack = width * y - f64::from(below) / n;
            largest = if lack > largest { lack } else { largest };
            below += count;
        }
        let lack = width - f64::from(below) / n;
        if lack > largest { lack } else { largest }
    }
    /// The largest excess of points in boxes of `width` that end at a level.
    fn excess(&self, levels: &[f64], width: f64, n: f64) -> f64 {
        let (mut within, mut largest) = (0u32, 0.0);
        for (&y, &count) in levels.iter().zip(&self.closed) {
            within += count;
            let excess = f64::from(within) / n - width * y;
            largest = if excess > largest { excess } else { largest };
        }
        largest
    }
}

fn distinct(column: &[f64]) -> Vec<f64> {
    let mut sorted = column.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    sorted
}
