//! Densities given as tables: constant within each of n equal cells of [0, 1], or of H × W cells of the unit square.
//!
//! Points come from the inverse of the cumulative sum, so that neighbours stay neighbours and strata stay strata; a guide
//! table tells where to begin, and the expected number of steps does not grow with n. The density is taken from the very
//! sums that are inverted: what a cell says is how often it comes, to the bit, so estimates stay unbiased whatever the
//! precision. A cell of less weight than the sums resolve (the rounding unit of the whole) may never come; its density
//! is then zero. Sums are made in f64, compensated.
//!
//! L. Devroye, *Non-Uniform Random Variate Generation*, 1986, section III.2.4 (guide tables, after H.-C. Chen and
//! Y. Asau 1974); M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 2023, appendix A.

use crate::math::exact::two_sum;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};

/// More cells than this a precision cannot tell apart.
pub const fn most_cells<T: Real>() -> usize {
    if T::DOUBLE { 1 << 31 } else { 1 << 22 }
}

/// What a table cannot hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Invalid {
    /// Negative, infinite or NaN, at this index.
    Weight(usize),
    /// No weight is positive.
    Empty,
    /// None, or more than [`most_cells`].
    Length(usize),
}

/// A point, its density, and the cell it lies in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drawn<T> {
    pub x: T,
    pub pdf: T,
    pub cell: u32,
}

/// A table over [0, 1], wherever its sums are kept.
#[derive(Clone, Copy, Debug)]
struct Table<'a, T> {
    /// n + 1 sums from 0 to 1.
    sums: &'a [T],
    /// For each of n equal parts of [0, 1], the cell in which it begins.
    guide: &'a [u32],
}

impl<T: Real> Table<'_, T> {
    #[inline(always)]
    fn cells(&self) -> T {
        T::of(self.guide.len() as f64)
    }
    /// The last cell whose sum begins at or below `u`, and which is not empty.
    #[inline(always)]
    fn find(&self, u: T) -> usize {
        let n = self.guide.len();
        let part = (u * self.cells()).to_f64() as usize;
        let mut i = self.guide[part.min(n - 1)] as usize;
        while i + 1 < n && self.sums[i + 1] <= u {
            i += 1;
        }
        // The part of `u` may be rounded up.
        while i > 0 && self.sums[i] > u {
            i -= 1;
        }
        // Beyond the last cell that has weight, where u is 1.
        while i > 0 && self.sums[i + 1] <= self.sums[i] {
            i -= 1;
        }
        i
    }
    #[inline(always)]
    fn sample(&self, u: T) -> Drawn<T> {
        if !(u >= T::zero() && u <= T::one()) {
            return Drawn { x: T::NAN, pdf: T::NAN, cell: 0 };
        }
        let i = self.find(u);
        let (low, width) = (self.sums[i], self.sums[i + 1] - self.sums[i]);
        let within = if width > T::zero() { (u - low) / width } else { T::of(0.5) };
        let n = self.cells();
        let mut x = (T::of(i as f64) + Lanes::min(within, T::one())) / n;
        // Rounding must not carry the point into a neighbour.
        while x > T::zero() && self.cell(x) > i {
            x = x.next_down();
        }
        while self.cell(x) < i {
            x = x.next_up();
        }
        Drawn { x: if x < T::one() { x } else { T::one().next_down() }, pdf: width * n, cell: i as u32 }
    }
    /// The cell of a point in [0, 1].
    #[inline(always)]
    fn cell(&self, x: T) -> usize {
        ((x * self.cells()).to_f64() as usize).min(self.guide.len() - 1)
    }
    #[inline(always)]
    fn pdf(&self, x: T) -> T {
        if x >= T::zero() && x <= T::one() {
            let i = self.cell(x);
            (self.sums[i + 1] - self.sums[i]) * self.cells()
        } else if x.is_nan() {
            x
        } else {
            T::zero()
        }
    }
    #[inline(always)]
    fn invert(&self, x: T) -> T {
        if x.is_nan() {
            return x;
        }
        let x = x.clamp01();
        let i = self.cell(x);
        let within = (x * self.cells() - T::of(i as f64)).clamp01();
        (self.sums[i] + within * (self.sums[i + 1] - self.sums[i])).clamp01()
    }
}

/// The sum of weights times `scale`, with the digits that single additions lose.
pub(super) fn total<T: Real>(weights: &[T], scale: f64) -> f64 {
    let (mut sum, mut lost) = (0.0, 0.0);
    for w in weights {
        let (s, low) = two_sum(sum, w.to_f64() * scale);
        (sum, lost) = (s, lost + low);
    }
    sum + lost
}

/// Fills the sums and the guide of one row and gives its total over `scale`; an empty row is made even.
fn fill<T: Real>(weights: &[T], scale: f64, sums: &mut [T], guide: &mut [u32]) -> f64 {
    let n = weights.len();
    let total = total(weights, scale);
    let (mut sum, mut lost, mut largest) = (0.0, 0.0, T::zero());
    for i in 0..n {
        sums[i] = largest;
        let share = if total > 0.0 { weights[i].to_f64() * scale / total } else { 1.0 / n as f64 };
        let (s, low) = two_sum(sum, share);
        (sum, lost) = (s, lost + low);
        // Rounded, sums may pass 1, or fall.
        largest = Lanes::max(largest, T::of((sum + lost).min(1.0)));
    }
    sums[n] = T::one();
    // Trailing cells without weight stay so: the last that has some takes what rounding left.
    let mut last = n;
    while last > 1 && total > 0.0 && weights[last - 1] == T::zero() {
        last -= 1;
        sums[last] = T::one();
    }
    let mut i = 0;
    for (part, g) in guide.iter_mut().enumerate() {
        let u = T::of(part as f64) / T::of(n as f64);
        while i + 1 < n && sums[i + 1] <= u {
            i += 1;
        }
        *g = i as u32;
    }
    total
}

/// What makes totals neither overflow nor vanish.
fn scale<T: Real>(weights: &[T]) -> Result<f64, Invalid> {
    if let Some(bad) = weights.iter().position(|&w| !(w >= T::zero() && w.is_finite())) {
        return Err(Invalid::Weight(bad));
    }
    let largest = weights.iter().fold(T::zero(), |a, &b| if b > a { b } else { a }).to_f64();
    if largest > 0.0 { Ok(1.0 / largest.max(1e-300)) } else { Err(Invalid::Empty) }
}

/// A density over [0, 1].
#[derive(Clone, Debug)]
pub struct Tabulated1D<T> {
    sums: Vec<T>,
    guide: Vec<u32>,
    mean: f64,
}

impl<T: Real> Tabulated1D<T> {
    pub fn new(weights: &[T]) -> Result<Self, Invalid> {
        let n = weights.len();
        if n == 0 || n > most_cells::<T>() {
            return Err(Invalid::Length(n));
        }
        let scale = scale(weights)?;
        let (mut sums, mut guide) = (vec![T::zero(); n + 1], vec![0; n]);
        let total = fill(weights, scale, &mut sums, &mut guide);
        Ok(Tabulated1D { sums, guide, mean: total / scale / n as f64 })
    }
    #[inline(always)]
    fn table(&self) -> Table<'_, T> {
        Table { sums: &self.sums, guide: &self.guide }
    }
    pub fn cells(&self) -> usize {
        self.guide.len()
    }
    /// The mean of the weights: their integral over [0, 1].
    pub fn mean(&self) -> f64 {
        self.mean
    }
    /// The probability of a cell.
    #[inline(always)]
    pub fn mass(&self, cell: usize) -> T {
        self.sums[cell + 1] - self.sums[cell]
    }
    /// The point below which a share `u` in [0, 1] lies; never in a cell that has no weight.
    #[inline(always)]
    pub fn sample(&self, u: T) -> Drawn<T> {
        self.table().sample(u)
    }
    /// The density at `x`; zero outside [0, 1].
    #[inline(always)]
    pub fn pdf(&self, x: T) -> T {
        self.table().pdf(x)
    }
    /// The share below `x`: the inverse of [`Tabulated1D::sample`].
    #[inline(always)]
    pub fn invert(&self, x: T) -> T {
        self.table().invert(x)
    }
}

/// A density over the unit square: x along the columns, y along the rows, row 0 first.
#[derive(Clone, Debug)]
pub struct Tabulated2D<T> {
    width: usize,
    /// Of each row, one after another: width + 1 sums and width guides.
    sums: Vec<T>,
    guide: Vec<u32>,
    rows: Tabulated1D<T>,
    mean: f64,
}

/// A point of the square, its density, and its cell: column, row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drawn2<T> {
    pub point: [T; 2],
    pub pdf: T,
    pub cell: [u32; 2],
}

impl<T: Real> Tabulated2D<T> {
    /// From weights row by row.
    pub fn new(
        watch: &mut dyn Watch,
        weights: &[T],
        width: usize,
    ) -> Result<Result<Self, Invalid>, Interrupted> {
        let height = weights.len().checked_div(width).unwrap_or(0);
        let most = most_cells::<T>();
        if weights.is_empty() || height * width != weights.len() || width > most || height > most {
            return Ok(Err(Invalid::Length(weights.len())));
        }
        let scale = match scale(weights) {
            Ok(scale) => scale,
            Err(invalid) => return Ok(Err(invalid)),
        };
        let (mut sums, mut guide) = (vec![T::zero(); height * (width + 1)], vec![0; weights.len()]);
        let mut totals = vec![0.0; height];
        let rows: Vec<_> = weights.chunks(width).collect();
        let (row_sums, row_guides): (Vec<_>, Vec<_>) =
            (sums.chunks_mut(width + 1).collect(), guide.chunks_mut(width).collect());
        let mut work: Vec<_> = rows.into_iter().zip(row_sums).zip(row_guides).zip(&mut totals).collect();
        let piece = ((1 << 16) / width).max(1);
        parallel::for_each(watch, &mut work[..], piece, |_, rows| {
            for (((weights, sums), guide), total) in rows {
                **total = fill(weights, scale, sums, guide);
            }
        })?;
        let sum = total(&totals, 1.0);
        let mut marginal = (vec![T::zero(); height + 1], vec![0; height]);
        // Rows keep their own digits: totals go into the sums as f64.
        fill_totals(&totals, &mut marginal.0, &mut marginal.1);
        let mean = sum / scale / weights.len() as f64;
        let rows = Tabulated1D { sums: marginal.0, guide: marginal.1, mean };
        Ok(Ok(Tabulated2D { width, sums, guide, rows, mean }))
    }
    #[inline(always)]
    fn row(&self, row: usize) -> Table<'_, T> {
        let w = self.width;
        Table {
            sums: &self.sums[row * (w + 1)..(row + 1) * (w + 1)],
            guide: &self.guide[row * w..(row + 1) * w],
        }
    }
    /// Width and height.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.rows.cells())
    }
    /// The mean of the weights: their integral over the square.
    pub fn mean(&self) -> f64 {
        self.mean
    }
    /// The density of y alone.
    pub fn marginal(&self) -> &Tabulated1D<T> {
        &self.rows
    }
    /// The density of x within a row; even where the row has no weight.
    pub fn conditional(&self, row: usize) -> Tabulated1D<T> {
        let table = self.row(row);
        Tabulated1D { sums: table.sums.to_vec(), guide: table.guide.to_vec(), mean: f64::NAN }
    }
    /// From the unit square: the row by u\[1\], the place in it by u\[0\].
    #[inline(always)]
    pub fn sample(&self, u: [T; 2]) -> Drawn2<T> {
        let y = self.rows.sample(u[1]);
        let x = self.row(y.cell as usize).sample(u[0]);
        Drawn2 { point: [x.x, y.x], pdf: x.pdf * y.pdf, cell: [x.cell, y.cell] }
    }
    /// A point of the row at height `y` in [0, 1], by the density within it.
    #[inline(always)]
    pub fn sample_within(&self, y: T, u: T) -> Drawn<T> {
        self.row(self.rows.table().cell(y)).sample(u)
    }
    /// The density at a point; zero outside the square.
    #[inline(always)]
    pub fn pdf(&self, [x, y]: [T; 2]) -> T {
        let row = self.rows.pdf(y);
        if row > T::zero() {
            row * self.row(self.rows.table().cell(y)).pdf(x)
        } else if x.is_nan() {
            x
        } else {
            row
        }
    }
    /// The inverse of [`Tabulated2D::sample`].
    #[inline(always)]
    pub fn invert(&self, [x, y]: [T; 2]) -> [T; 2] {
        if y.is_nan() {
            return [T::NAN; 2];
        }
        let row = self.rows.table().cell(y.clamp01());
        [self.row(row).invert(x), self.rows.invert(y)]
    }
}

/// [`fill`] of totals that are f64 whatever the table's precision.
fn fill_totals<T: Real>(totals: &[f64], sums: &mut [T], guide: &mut [u32]) {
    let largest = totals.iter().fold(0.0f64, |a, &b| a.max(b));
    // In T and within its range; a row that T cannot hold beside the largest has no share of its own either.
    let weights: Vec<T> = totals.iter().map(|t| T::of(t / largest)).collect();
    fill(&weights, 1.0, sums, guide);
}
