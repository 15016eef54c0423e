//! What samples leave in a pixel: mean, spread, count, and what stood out.
//!
//! Sums are in double, as running means (Welford), so that memory does not depend on the number of samples and a pixel
//! that always sees the same has no variance at all. Tallies of disjoint samples merge into that of all of them.
//!
//! **Outliers.** A sample that alone outweighs all that its pixel had gathered before it, from the seventeenth on, is
//! counted; nothing is done to it. Rendering has found a path that it hardly ever finds, and the pixel's mean and
//! variance are not to be trusted yet.
//!
//! **Clamping** is asked for or does not happen. What it takes away is summed as well: minus its mean is the bias.
//!
//! B. P. Welford, *Note on a method for calculating corrected sums of squares and products*, 1962; T. F. Chan,
//! G. H. Golub, R. J. LeVeque, *Updating formulae and a pairwise algorithm for computing sample variances*, 1979.

use crate::real::Real;
use crate::vec::Vec3;

/// Samples before outliers are told.
const SETTLED: u32 = 16;

/// One pixel's samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tally {
    pub count: u32,
    /// Samples that outweighed all before them.
    pub outliers: u32,
    pub mean: [f64; 3],
    /// Sums of squares about the mean.
    pub squares: [f64; 3],
    /// Mean of what clamping took away.
    pub removed: [f64; 3],
}

impl Tally {
    /// Of no samples. (The derived default calls what is not inlined.)
    pub const EMPTY: Self =
        Tally { count: 0, outliers: 0, mean: [0.0; 3], squares: [0.0; 3], removed: [0.0; 3] };

    /// Adds a sample, scaled down so that its largest channel does not exceed `clamp` (infinity: as it is).
    #[inline(always)]
    pub fn add_clamped<T: Real>(&mut self, x: Vec3<T>, clamp: f64) {
        let x = x.map(
            #[inline(always)]
            |c| c.to_f64(),
        );
        let brightest = f64::max(f64::max(x.x, x.y), x.z);
        let kept = if brightest > clamp { x * (clamp / brightest) } else { x };
        self.put(kept, brightest);
        if clamp.is_finite() {
            let (x, kept) = (x.to_array(), kept.to_array());
            for c in 0..3 {
                self.removed[c] += (x[c] - kept[c] - self.removed[c]) / f64::from(self.count);
            }
        }
    }

    /// Adds a sample.
    #[inline(always)]
    pub fn add<T: Real>(&mut self, x: Vec3<T>) {
        self.add_clamped(x, f64::INFINITY);
    }

    #[inline(always)]
    fn put(&mut self, x: Vec3<f64>, brightest: f64) {
        let before = f64::max(f64::max(self.mean[0], self.mean[1]), self.mean[2]) * f64::from(self.count);
        self.outliers += u32::from(self.count >= SETTLED && brightest > before);
        self.count += 1;
        let (n, x) = (f64::from(self.count), x.to_array());
        for c in 0..3 {
            let off = x[c] - self.mean[c];
            self.mean[c] += off / n;
            self.squares[c] += off * (x[c] - self.mean[c]);
        }
    }

    /// Of the mean of independent samples; unknown, hence infinite, for less than two.
    #[inline(always)]
    pub fn variance(&self) -> [f64; 3] {
        let n = f64::from(self.count);
        let (known, freedom, [a, b, c]) = (n >= 2.0, n * (n - 1.0), self.squares);
        if known { [a / freedom, b / freedom, c / freedom] } else { [f64::INFINITY; 3] }
    }

    /// Takes in the samples of another.
    #[inline(always)]
    pub fn merge(&mut self, other: &Self) {
        if self.count == 0 || other.count == 0 {
            *self = if self.count == 0 { *other } else { *self };
            return;
        }
        let (a, b) = (f64::from(self.count), f64::from(other.count));
        let n = a + b;
        for c in 0..3 {
            let off = other.mean[c] - self.mean[c];
            self.mean[c] += off * (b / n);
            self.squares[c] += other.squares[c] + off * off * (a * b / n);
            self.removed[c] += (other.removed[c] - self.removed[c]) * (b / n);
        }
        self.count += other.count;
        self.outliers += other.outliers;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merging_is_adding_on() {
        let samples: Vec<Vec3<f64>> = (0..50).map(|i| Vec3::new(f64::from(i * i % 17), 1.0, 0.5)).collect();
        let (mut all, mut head, mut tail) = (Tally::EMPTY, Tally::EMPTY, Tally::EMPTY);
        samples.iter().for_each(|&x| all.add_clamped(x, 9.0));
        samples[..20].iter().for_each(|&x| head.add_clamped(x, 9.0));
        samples[20..].iter().for_each(|&x| tail.add_clamped(x, 9.0));
        head.merge(&tail);
        assert_eq!(head.count, 50);
        for c in 0..3 {
            assert!((head.mean[c] - all.mean[c]).abs() < 1e-12);
            assert!((head.squares[c] - all.squares[c]).abs() < 1e-9);
            assert!((head.removed[c] - all.removed[c]).abs() < 1e-12);
        }
    }

    #[test]
    fn what_clamping_takes_is_the_bias() {
        let (mut free, mut clamped) = (Tally::EMPTY, Tally::EMPTY);
        for i in 0..40 {
            let x = Vec3::splat(if i == 30 { 1000.0 } else { 1.0 });
            free.add(x);
            clamped.add_clamped(x, 2.0);
        }
        assert_eq!((free.outliers, clamped.outliers), (1, 1));
        assert!((clamped.mean[0] + clamped.removed[0] - free.mean[0]).abs() < 1e-12);
        assert!(clamped.removed[0] > 20.0);
    }
}
