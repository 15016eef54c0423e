//! An equirectangular picture of the radiance that comes from every direction: +y up, the centre column along −z, left to
//! right turning to +x, row 0 the top.
//!
//! Between the centres of pixels radiance is bilinear; across the seam it goes round, beyond the outer rows it is
//! constant up to the pole. Directions are drawn in proportion to the bilinear interpolation of luminance · sin θ at the
//! pixels' centres: first the height from its marginal, a piecewise linear density, then the azimuth from the row there.
//! So the density is that of the picture as it is looked up, but for the sine within a pixel.
//!
//! M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 3rd edition, 2016, sections 13.6.7 and 14.2.4.

use crate::color::luminance::luminance;
use crate::dispatch;
use crate::math;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

pub struct Panorama<T> {
    width: usize,
    height: usize,
    radiance: Vec<[T; 3]>,
    /// Luminance · sin θ at the pixels' centres.
    weights: Vec<T>,
    /// For each row the integral of its weights from column 0's centre to that of column j, j = 0 … width.
    along: Vec<T>,
    /// The integral of rows from the top to the first, second … centre and to the bottom.
    down: Vec<T>,
    /// Sine and cosine of the turn about y from the panorama to the world.
    turn: (T, T),
}

/// A direction drawn from a panorama.
#[derive(Clone, Copy, Debug)]
pub struct Draw<T> {
    /// Unit, to where the light comes from.
    pub wi: Vec3<T>,
    pub radiance: Vec3<T>,
    /// Per solid angle.
    pub pdf: T,
}

/// The four pixels about a place, and how far it is from the first to the last along the row and down.
#[derive(Clone, Copy)]
struct Cell<T> {
    at: [usize; 4],
    s: T,
    t: T,
}

impl<T: Real> Cell<T> {
    #[inline(always)]
    fn mix(&self, value: impl Fn(usize) -> T) -> T {
        let [a, b, c, d] = self.at.map(value);
        let (s, t) = (self.s, self.t);
        let (top, bottom) = (a + (b - a) * s, c + (d - c) * s);
        top + (bottom - top) * t
    }
}

/// Where the integral of the line from `a` at 0 to `b` at 1 reaches `area`.
#[inline(always)]
fn reach<T: Real>(a: T, b: T, area: T) -> T {
    let root = Lanes::max(a * a + T::of(2.0) * (b - a) * area, T::zero()).sqrt();
    Lanes::min((area + area) / (a + root), T::one())
}

/// The last of increasing `sums(0 … n)` that does not exceed `x`, short of the end.
#[inline(always)]
fn last_below<T: Real>(n: usize, x: T, sums: impl Fn(usize) -> T) -> usize {
    let (mut low, mut high) = (0, n);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if sums(middle) <= x {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

impl<T: Real> Panorama<T> {
    /// From finite pixels without negative channels, row by row, turned about y by `angle`.
    pub fn new(width: usize, height: usize, radiance: Vec<[T; 3]>, angle: f64) -> Self {
        let bright = |p: &[T; 3]| luminance(Vec3::from(p.map(T::to_f64)));
        let black = radiance.iter().all(|p| bright(p) == 0.0);
        let (mut weights, mut along, mut down) = (Vec::new(), Vec::new(), vec![T::zero()]);
        let (mut sum, mut before) = (0.0, 0.0);
        for (i, row) in radiance.chunks_exact(width).enumerate() {
            let sine = math::sin(std::f64::consts::PI * (i as f64 + 0.5) / height as f64);
            let row: Vec<f64> = row.iter().map(|p| if black { sine } else { sine * bright(p) }).collect();
            let mut total = 0.0;
            for j in 0..=width {
                along.push(T::of(total));
                total += 0.5 * (row[j % width] + row[(j + 1) % width]);
            }
            let whole: f64 = row.iter().sum();
            weights.extend(row.iter().map(|&w| T::of(w)));
            sum += 0.5 * (before + whole);
            down.push(T::of(sum));
            before = whole;
        }
        // Up to the first centre half a row of the first, likewise below the last.
        down.push(T::of(sum + 0.5 * before));
        let (sin, cos) = math::sin_cos(angle);
        Panorama { width, height, radiance, weights, along, down, turn: (T::of(sin), T::of(cos)) }
    }

    /// ∫ luminance dω over all directions.
    pub fn power(&self) -> T {
        let pixels = T::of((self.width * self.height) as f64);
        *self.down.last().expect("sums are never empty") * T::of(2.0) * T::PI * T::PI / pixels
    }

    #[inline(always)]
    fn to_world(&self, v: Vec3<T>) -> Vec3<T> {
        let (sin, cos) = self.turn;
        Vec3::new(cos * v.x + sin * v.z, v.y, cos * v.z - sin * v.x)
    }

    /// The cell at a unit direction, and sin θ.
    #[inline(always)]
    fn cell(&self, wi: Vec3<T>) -> (Cell<T>, T) {
        let (half, (sin, cos)) = (T::of(0.5), self.turn);
        let (x, y, z) = (cos * wi.x - sin * wi.z, wi.y, sin * wi.x + cos * wi.z);
        let sine = (x * x + z * z).sqrt();
        let (w, h) = (T::of(self.width as f64), T::of(self.height as f64));
        // Columns and rows from the first centre.
        let column = (half + math::atan2(x, -z) / (T::of(2.0) * T::PI)) * w - half;
        let row = math::atan2(sine, y) / T::PI * h - half;
        let row = Lanes::min(Lanes::max(row, T::zero()), h - T::one());
        let (j, i) = (column.floor(), row.floor());
        let (s, t) = (column - j, row - i);
        // From −1 to width − 1, by rounding to width; NaN becomes 0.
        let j = (j.to_f64() as isize + self.width as isize) as usize % self.width;
        let i = (i.to_f64() as usize).min(self.height - 1);
        let (k, l) = ((j + 1) % self.width, (i + 1).min(self.height - 1));
        let (i, l) = (i * self.width, l * self.width);
        (Cell { at: [i + j, i + k, l + j, l + k], s, t }, Lanes::max(sine, T::EPSILON))
    }

    #[inline(always)]
    fn radiance_of(&self, cell: &Cell<T>) -> Vec3<T> {
        Vec3::from([0, 1, 2].map(|c| cell.mix(|at| self.radiance[at][c])))
    }

    #[inline(always)]
    fn pdf_of(&self, cell: &Cell<T>, sine: T) -> T {
        cell.mix(|at| self.weights[at]) / (self.power() * sine)
    }

    /// Radiance from a unit direction.
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<T>) -> Vec3<T> {
        self.radiance_of(&self.cell(wi).0)
    }

    /// The density of [`Panorama::sample`] per solid angle.
    #[inline(always)]
    pub fn pdf(&self, wi: Vec3<T>) -> T {
        let (cell, sine) = self.cell(wi);
        self.pdf_of(&cell, sine)
    }

    /// Radiance and density at once.
    #[inline(always)]
    pub fn eval_and_pdf(&self, wi: Vec3<T>) -> (Vec3<T>, T) {
        let (cell, sine) = self.cell(wi);
        (self.radiance_of(&cell), self.pdf_of(&cell, sine))
    }

    /// A direction for a point of the unit square: u[0] goes along rows, u[1] down.
    #[inline(always)]
    pub fn sample(&self, u: [T; 2]) -> Draw<T> {
        let (w, h, half, one) = (self.width, self.height, T::of(0.5), T::one());
        // The span between the centres of rows `k − 1` and `k`; half a span at the poles.
        let goal = u[1] * self.down[h + 1];
        let k = last_below(h + 1, goal, |k| self.down[k]);
        let (above, below) = (k.max(1) - 1, k.min(h - 1));
        let ends = [above, below].map(|i| &self.along[i * (w + 1)..][..=w]);
        let of_rows = ends.map(|row| row[w]);
        let rest = goal - self.down[k];
        let (t, row) = if k == 0 || k == h {
            let t = Lanes::min(rest / (half * of_rows[0]), one);
            (t, if k == 0 { t * half } else { T::of(h as f64) - (one - t) * half })
        } else {
            let t = reach(of_rows[0], of_rows[1], rest);
            (t, T::of(k as f64) - half + t)
        };

        let sums = |j: usize| ends[0][j] + (ends[1][j] - ends[0][j]) * t;
        let goal = u[0] * sums(w);
        let j = last_below(w, goal, sums);
        let weight = |j: usize| {
            let [a, b] = [above, below].map(|i| self.weights[i * w + j % w]);
            a + (b - a) * t
        };
        let s = reach(weight(j), weight(j + 1), goal - sums(j));
        let cell = Cell {
            at: [above * w + j, above * w + (j + 1) % w, below * w + j, below * w + (j + 1) % w],
            s,
            t,
        };

        let azimuth = T::of(2.0) * T::PI * ((T::of(j as f64) + half + s) / T::of(w as f64) - half);
        let ((sine, y), (sin, cos)) =
            (math::sin_cos(T::PI * (row / T::of(h as f64))), math::sin_cos(azimuth));
        let wi = self.to_world(Vec3::new(sine * sin, y, -sine * cos));
        let sine = Lanes::max(sine, T::EPSILON);
        Draw { wi, radiance: self.radiance_of(&cell), pdf: self.pdf_of(&cell, sine) }
    }
}

/// Radiance and density of unit directions, over arrays of equal length.
pub fn panorama_many<T: Real>(
    watch: &mut dyn Watch,
    panorama: &Panorama<T>,
    directions: &[[T; 3]],
    radiance: &mut [[T; 3]],
    pdf: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (directions, radiance, pdf), 1 << 12, |_, (directions, radiance, pdf)| {
        dispatch!(_s => {
            for i in 0..directions.len() {
                let wi = Vec3::from(directions[i]);
                let (color, density) = panorama.eval_and_pdf(wi);
                let nan = wi.dot(Vec3::splat(T::zero()));
                (radiance[i], pdf[i]) = (color.map(|c| c + nan).to_array(), density + nan);
            }
        })
    })
}

/// [`Panorama::sample`] over arrays of equal length; NaN outside the unit square.
pub fn panorama_sample_many<T: Real>(
    watch: &mut dyn Watch,
    panorama: &Panorama<T>,
    u: &[[T; 2]],
    wi: &mut [[T; 3]],
    radiance: &mut [[T; 3]],
    pdf: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (u, wi, radiance, pdf), 1 << 12, |_, (u, wi, radiance, pdf)| {
        dispatch!(_s => {
            for i in 0..u.len() {
                let inside = u[i].iter().all(|x| (T::zero()..=T::one()).contains(x));
                let draw = panorama.sample(u[i]);
                let nan = if inside { T::zero() } else { T::NAN };
                let marked = |v: Vec3<T>| v.map(|x| x + nan).to_array();
                (wi[i], radiance[i], pdf[i]) = (marked(draw.wi), marked(draw.radiance), draw.pdf + nan);
            }
        })
    })
}
