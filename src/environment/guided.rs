//! Drawing from many tabulated densities by inversion: sums, and a table of guides that tells where to look in them.
//!
//! H.-C. Chen, Y. Asau, *On generating random variates from an empirical distribution*, 1974.

use crate::real::{Lanes, Real};

/// Lines of shares of one, summed up, with guides: where the search for a number starts and ends.
pub struct Guided<T> {
    /// Shares of each line.
    count: usize,
    /// Sums, count + 1 a line.
    sums: Vec<T>,
    /// For each of `count` equal parts of [0, 1] the share in which it begins, and that in which the last one ends.
    guides: Vec<u32>,
}

impl<T: Real> Guided<T> {
    pub fn new(count: usize) -> Self {
        Guided { count, sums: Vec::new(), guides: Vec::new() }
    }

    /// Adds a line in proportion to weights; an even one if there are none.
    pub fn push(&mut self, weights: &[f64]) {
        let (n, start) = (self.count, self.sums.len());
        let total: f64 = weights.iter().sum();
        let share = |w: f64| if total > 0.0 { w / total } else { 1.0 / n as f64 };
        let mut sum = 0.0;
        for &w in weights {
            self.sums.push(T::of(f64::min(sum, 1.0)));
            sum += share(w);
        }
        self.sums.push(T::one());
        let (sums, mut k) = (&self.sums[start..], 0);
        for part in 0..=n {
            // A little before, since u · n is rounded.
            let edge = (part as f64 - 0.01 - n as f64 * T::EPSILON.to_f64()) / n as f64;
            while k + 1 < n && sums[k + 1].to_f64() <= edge {
                k += 1;
            }
            self.guides.push(k as u32);
        }
    }

    /// The share of a line at `u` in [0, 1], and where in it.
    #[inline(always)]
    pub fn find(&self, line: usize, u: T) -> (usize, T) {
        let n = self.count;
        let sums = &self.sums[line * (n + 1)..][..n + 1];
        let part = ((u * T::of(n as f64)).to_f64() as usize).min(n - 1);
        let guides = &self.guides[line * (n + 1) + part..][..2];
        let (mut low, mut high) = (guides[0] as usize, guides[1] as usize + 1);
        // Guides stand a little before the parts.
        if sums[high] <= u {
            high = n;
        }
        while high - low > 1 {
            let middle = (low + high) / 2;
            if sums[middle] <= u {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (start, end) = (sums[low], sums[low + 1]);
        let rest = (u - start) / (end - start);
        (low, Lanes::min(Lanes::max(rest, T::zero()), T::one()))
    }

    /// [`Guided::find`] of eight numbers, each in a line of its own.
    ///
    /// Step by step for all of them: what one waits for (tables are larger than the nearer caches) all wait for
    /// together, and no branch depends on it but the end of the search.
    #[inline(always)]
    pub fn finds(&self, lines: &[usize; 8], u: &[T; 8]) -> ([usize; 8], [T; 8]) {
        let n = self.count;
        let (mut low, mut high, mut rest) = ([0usize; 8], [0usize; 8], [T::zero(); 8]);
        for l in 0..8 {
            let part = ((u[l] * T::of(n as f64)).to_f64() as usize).min(n - 1);
            let guides = &self.guides[lines[l] * (n + 1) + part..][..2];
            (low[l], high[l]) = (guides[0] as usize, guides[1] as usize + 1);
        }
        let mut widest = 0;
        for l in 0..8 {
            let beyond = self.sums[lines[l] * (n + 1) + high[l]] <= u[l];
            high[l] = if beyond { n } else { high[l] };
            widest = widest.max(high[l] - low[l]);
        }
        while widest > 1 {
            for l in 0..8 {
                // Of one share the middle is its start, which is not above the number.
                let middle = (low[l] + high[l]) / 2;
                let above = self.sums[lines[l] * (n + 1) + middle] <= u[l];
                low[l] = if above { middle } else { low[l] };
                high[l] = if above { high[l] } else { middle.max(low[l] + 1) };
            }
            widest = widest.div_ceil(2);
        }
        for l in 0..8 {
            let sums = &self.sums[lines[l] * (n + 1) + low[l]..][..2];
            let part = (u[l] - sums[0]) / (sums[1] - sums[0]);
            rest[l] = Lanes::min(Lanes::max(part, T::zero()), T::one());
        }
        (low, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash::mix32;

    #[test]
    fn eight_are_found_as_each_alone() {
        let n = 37;
        let mut table: Guided<f32> = Guided::new(n);
        for line in 0..5 {
            // Even; of few shares among zeros; of one alone; falling steeply; of nothing.
            let weights: Vec<f64> = (0..n)
                .map(|i| match line {
                    0 => 1.0,
                    1 => f64::from(u8::from(i % 7 == 3)),
                    2 => f64::from(u8::from(i == 20)),
                    3 => 0.3f64.powi(i as i32),
                    _ => 0.0,
                })
                .collect();
            table.push(&weights);
        }
        let edges: Vec<f32> = (0..5 * (n + 1)).map(|i| table.sums[i]).collect();
        for i in 0..4000u32 {
            let (mut lines, mut u) = ([0usize; 8], [0f32; 8]);
            for l in 0..8 {
                let random = mix32(8 * i + l as u32);
                lines[l] = random as usize % 5;
                u[l] = match i % 4 {
                    // Where shares meet, and right beside.
                    0 => edges[random as usize / 5 % edges.len()],
                    1 => edges[random as usize / 5 % edges.len()].next_down().max(0.0),
                    _ => mix32(random) as f32 / 2f32.powi(32),
                };
            }
            let (found, rest) = table.finds(&lines, &u);
            for l in 0..8 {
                assert_eq!((found[l], rest[l].to_bits()), {
                    let (k, x) = table.find(lines[l], u[l]);
                    (k, x.to_bits())
                });
            }
        }
    }
}
