//! An equirectangular picture of the radiance that comes from every direction: +y up, the centre column along −z, left to
//! right turning to +x, row 0 the top.
//!
//! Between the centres of pixels radiance is bilinear; across the seam it goes round, beyond the outer rows it is
//! constant up to the pole. Directions are drawn in proportion to the bilinear interpolation of luminance · sin θ at the
//! pixels' centres: first a row of cells between four centres, then a cell of it, each from sums in which a table of
//! guides tells where to look, then a place in the cell. So the density is that of the picture as it is looked up, but
//! for the sine within a pixel. Directions and angles turn into each other in lanes; pixels are read one by one.
//!
//! M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 3rd edition, 2016, sections 13.6.7 and 14.2.4;
//! H.-C. Chen, Y. Asau, *On generating random variates from an empirical distribution*, 1974 (the guides).

use super::guided::Guided;
use crate::color::luminance::luminance;
use crate::dispatch;
use crate::math;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crate::vec::Vec3;

pub struct Panorama<T> {
    width: usize,
    height: usize,
    /// Red, green, blue; luminance · sin θ, scaled so that over sin θ it is the density.
    pixels: Vec<[T; 4]>,
    /// Of the rows of cells: half a row above the first centres, between two, half a row below the last.
    down: Guided<T>,
    /// Of the cells of each of these.
    along: Guided<T>,
    /// ∫ luminance dω.
    power: T,
    /// Sine and cosine of the turn about y from the panorama to the world.
    turn: (T, T),
}

/// A direction drawn from a panorama, or lanes of them.
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

/// Where the integral of the line from `a` at 0 to `b` at 1 reaches the part `x` of the whole.
#[inline(always)]
fn reach<V: Lanes>(a: V, b: V, x: V) -> V {
    let area = x * (a + b);
    let root = (a * a + (b - a) * area).max(x.num(0.0)).sqrt();
    (area / (a + root)).min(x.num(1.0))
}

impl<T: Real> Panorama<T> {
    /// From finite pixels without negative channels, row by row, turned about y by `angle`.
    pub fn new(width: usize, height: usize, radiance: Vec<[T; 3]>, angle: f64) -> Self {
        let bright = |p: &[T; 3]| luminance(Vec3::from(p.map(T::to_f64)));
        let black = radiance.iter().all(|p| bright(p) == 0.0);
        let mut weights = Vec::with_capacity(radiance.len());
        for (i, row) in radiance.chunks_exact(width).enumerate() {
            let sine = math::sin(std::f64::consts::PI * (i as f64 + 0.5) / height as f64);
            weights.extend(row.iter().map(|p| if black { sine } else { sine * bright(p) }));
        }
        let total: f64 = weights.iter().sum();
        let area = 2.0 * std::f64::consts::PI * std::f64::consts::PI / weights.len() as f64;
        let scale = 1.0 / (total * area);
        let pixels = radiance.iter().zip(&weights).map(|(&[r, g, b], w)| [r, g, b, T::of(w * scale)]);
        let pixels = pixels.collect();

        let (mut down, mut along) = (Guided::new(height + 1), Guided::new(width));
        let (mut rows, mut cells) = (Vec::with_capacity(height + 1), vec![0.0; width]);
        for k in 0..=height {
            let ends = [k.max(1) - 1, k.min(height - 1)];
            let [above, below] = ends.map(|i| &weights[i * width..][..width]);
            for j in 0..width {
                let next = (j + 1) % width;
                cells[j] = above[j] + above[next] + below[j] + below[next];
            }
            along.push(&cells);
            let half = if k == 0 || k == height { 0.5 } else { 1.0 };
            rows.push(half * cells.iter().sum::<f64>());
        }
        down.push(&rows);
        let (sin, cos) = math::sin_cos(angle);
        let turn = (T::of(sin), T::of(cos));
        Panorama { width, height, pixels, down, along, power: T::of(total * area), turn }
    }

    /// ∫ luminance dω over all directions.
    pub fn power(&self) -> T {
        self.power
    }

    /// The column of a unit direction, from one before the first pixel's centre, its row, from the first centre, and
    /// sin θ.
    #[inline(always)]
    fn place<V: Lanes<Elem = T>>(&self, wi: Vec3<V>) -> (V, V, V) {
        let x = wi.x;
        let (sin, cos) = (x.like(self.turn.0), x.like(self.turn.1));
        let (x, y, z) = (cos * wi.x - sin * wi.z, wi.y, sin * wi.x + cos * wi.z);
        let sine = (x * x + z * z).sqrt();
        let (w, h) = (self.width as f64, self.height as f64);
        let pi = std::f64::consts::PI;
        let column = math::atan2(x, -z) * x.num(w / (2.0 * pi)) + x.num(0.5 * w + 0.5);
        let row = math::atan2(sine, y) * x.num(h / pi) - x.num(0.5);
        (column, row, sine.max(x.like(T::EPSILON)))
    }

    /// The cell at such a column and row.
    #[inline(always)]
    fn cell(&self, column: T, row: T) -> Cell<T> {
        let row = Lanes::min(Lanes::max(row, T::zero()), T::of(self.height as f64 - 1.0));
        let column = Lanes::max(column, T::zero());
        // Column 0 is the last one; by rounding it may be the width and one more. NaN became 0.
        let (i, j) = (row.to_f64() as usize, column.to_f64() as usize);
        let (s, t) = (column - T::of(j as f64), row - T::of(i as f64));
        let (w, last) = (self.width, self.height - 1);
        let j = if j == 0 { w - 1 } else { j - 1 };
        let j = if j >= w { j - w } else { j };
        self.about(i.min(last), (i + 1).min(last), j, s, t)
    }

    #[inline(always)]
    fn about(&self, above: usize, below: usize, j: usize, s: T, t: T) -> Cell<T> {
        let w = self.width;
        let next = if j + 1 == w { 0 } else { j + 1 };
        let (above, below) = (above * w, below * w);
        Cell { at: [above + j, above + next, below + j, below + next], s, t }
    }

    /// Radiance, and density times sin θ.
    #[inline(always)]
    fn mix(&self, cell: &Cell<T>) -> [T; 4] {
        let [a, b, c, d] = cell.at;
        let (a, b, c, d) = (&self.pixels[a], &self.pixels[b], &self.pixels[c], &self.pixels[d]);
        let mut out = [T::zero(); 4];
        for m in 0..4 {
            let (top, bottom) = (a[m] + (b[m] - a[m]) * cell.s, c[m] + (d[m] - c[m]) * cell.s);
            out[m] = top + (bottom - top) * cell.t;
        }
        out
    }

    /// A cell for a point of the unit square, its column from the picture's left edge, and its row from the top.
    #[inline(always)]
    fn pick(&self, u: [T; 2]) -> (Cell<T>, T, T) {
        let (h, half, one) = (self.height, T::of(0.5), T::one());
        let (k, x) = self.down.find(0, u[1]);
        let (j, y) = self.along.find(k, u[0]);
        let mut cell = self.about(k.max(1) - 1, k.min(h - 1), j, T::zero(), T::zero());
        let [a, b, c, d] = cell.at;
        let [a, b, c, d] = [self.pixels[a][3], self.pixels[b][3], self.pixels[c][3], self.pixels[d][3]];
        // Half rows are constant from top to bottom.
        let edge = k == 0 || k == h;
        cell.t = if edge { x } else { reach(a + b, c + d, x) };
        cell.s = reach(a + (c - a) * cell.t, b + (d - b) * cell.t, y);
        let row = match k {
            0 => cell.t * half,
            _ if k == h => T::of(h as f64) - (one - cell.t) * half,
            _ => T::of(k as f64) - half + cell.t,
        };
        (cell, T::of(j as f64) + half + cell.s, row)
    }

    /// The direction at a column from the left edge and a row from the top, and sin θ.
    #[inline(always)]
    fn toward<V: Lanes<Elem = T>>(&self, column: V, row: V) -> (Vec3<V>, V) {
        let (w, h) = (self.width as f64, self.height as f64);
        let (sine, y) = math::sin_cos_turns(row * row.num(0.5 / h));
        let (a, b) = math::sin_cos_turns((column - row.num(0.5 * w)) * row.num(1.0 / w));
        let (x, z) = (sine * a, -(sine * b));
        let (sin, cos) = (row.like(self.turn.0), row.like(self.turn.1));
        (Vec3::new(cos * x + sin * z, y, cos * z - sin * x), sine.max(row.like(T::EPSILON)))
    }

    /// Radiance from a unit direction, and the density of [`Panorama::sample`] per solid angle.
    #[inline(always)]
    pub fn eval_and_pdf(&self, wi: Vec3<T>) -> (Vec3<T>, T) {
        let (column, row, sine) = self.place(wi);
        let [r, g, b, weight] = self.mix(&self.cell(column, row));
        (Vec3::new(r, g, b), weight / sine)
    }

    /// [`Panorama::eval_and_pdf`] of eight directions.
    #[inline(always)]
    pub fn look<S: Simd>(&self, s: S, wi: Vec3<T::V8<S>>) -> (Vec3<T::V8<S>>, T::V8<S>) {
        let (column, row, sine) = self.place(wi);
        let (columns, rows) = (column.to_array(), row.to_array());
        let mut out = [[T::zero(); 8]; 4];
        for l in 0..8 {
            let mixed = self.mix(&self.cell(columns[l], rows[l]));
            for m in 0..4 {
                out[m][l] = mixed[m];
            }
        }
        let [r, g, b, weight] = load4::<T, S>(s, &out);
        (Vec3::new(r, g, b), weight / sine)
    }

    /// A direction for a point of the unit square: u[0] goes along rows, u[1] down.
    #[inline(always)]
    pub fn sample(&self, u: [T; 2]) -> Draw<T> {
        let (cell, column, row) = self.pick(u);
        let (wi, sine) = self.toward(column, row);
        let [r, g, b, weight] = self.mix(&cell);
        Draw { wi, radiance: Vec3::new(r, g, b), pdf: weight / sine }
    }

    /// [`Panorama::sample`] of eight points.
    #[inline(always)]
    pub fn samples<S: Simd>(&self, s: S, u: &[[T; 8]; 2]) -> Draw<T::V8<S>> {
        let (h, zero) = (self.height, T::zero());
        let (k, x) = self.down.finds(&[0; 8], &u[1]);
        let (j, y) = self.along.finds(&k, &u[0]);
        let mut cells = [Cell { at: [0; 4], s: zero, t: zero }; 8];
        let (mut weights, mut edge, mut start, mut span) = ([[zero; 8]; 4], [zero; 8], [zero; 8], [zero; 8]);
        let mut columns = [zero; 8];
        for l in 0..8 {
            cells[l] = self.about(k[l].max(1) - 1, k[l].min(h - 1), j[l], zero, zero);
            for m in 0..4 {
                weights[m][l] = self.pixels[cells[l].at[m]][3];
            }
            // Half rows are constant from top to bottom.
            let half = k[l] == 0 || k[l] == h;
            edge[l] = if half { T::one() } else { zero };
            start[l] = if k[l] == 0 { zero } else { T::of(k[l] as f64) - T::of(0.5) };
            span[l] = if half { T::of(0.5) } else { T::one() };
            columns[l] = T::of(j[l] as f64) + T::of(0.5);
        }
        let [a, b, c, d] = load4::<T, S>(s, &weights);
        let [edge, start, span, x] = load4::<T, S>(s, &[edge, start, span, x]);
        let t = Lanes::select(edge.equal(x.num(1.0)), x, reach(a + b, c + d, x));
        let along = reach(a + (c - a) * t, b + (d - b) * t, SimdBase::load_array_ref(s, &y));
        let column: T::V8<S> = SimdBase::load_array_ref(s, &columns);
        let (wi, sine) = self.toward::<T::V8<S>>(column + along, start + t * span);
        let (t, along) = (t.to_array(), along.to_array());
        let mut out = [[zero; 8]; 4];
        for l in 0..8 {
            let mixed = self.mix(&Cell { s: along[l], t: t[l], ..cells[l] });
            for m in 0..4 {
                out[m][l] = mixed[m];
            }
        }
        let [r, g, b, weight] = load4::<T, S>(s, &out);
        Draw { wi, radiance: Vec3::new(r, g, b), pdf: weight / sine }
    }
}

#[inline(always)]
fn load4<T: Real, S: Simd>(s: S, x: &[[T; 8]; 4]) -> [T::V8<S>; 4] {
    [
        SimdBase::load_array_ref(s, &x[0]),
        SimdBase::load_array_ref(s, &x[1]),
        SimdBase::load_array_ref(s, &x[2]),
        SimdBase::load_array_ref(s, &x[3]),
    ]
}

/// Radiance and density of unit directions, over arrays of equal length.
pub fn panorama_many<T: Real>(
    watch: &mut dyn Watch,
    panorama: &Panorama<T>,
    directions: &[[T; 3]],
    radiance: &mut [[T; 3]],
    pdf: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (directions, radiance, pdf),
        1 << 12,
        |_, (directions, radiance, pdf)| dispatch!(s => eval_body(s, panorama, directions, radiance, pdf)),
    )
}

#[inline(always)]
fn eval_body<T: Real, S: Simd>(
    s: S,
    panorama: &Panorama<T>,
    directions: &[[T; 3]],
    radiance: &mut [[T; 3]],
    pdf: &mut [T],
) {
    let mut at = [[T::zero(); 8]; 3];
    let mut start = 0;
    while start < directions.len() {
        let n = (directions.len() - start).min(8);
        for l in 0..n {
            for c in 0..3 {
                at[c][l] = directions[start + l][c];
            }
        }
        let wi = Vec3::new(
            SimdBase::load_array_ref(s, &at[0]),
            SimdBase::load_array_ref(s, &at[1]),
            SimdBase::load_array_ref(s, &at[2]),
        );
        let (color, density) = panorama.look::<S>(s, wi);
        let zero = wi.x.num(0.0);
        let nan = wi.x * zero + wi.y * zero + wi.z * zero;
        let (r, g, b) = ((color.x + nan).to_array(), (color.y + nan).to_array(), (color.z + nan).to_array());
        let density = (density + nan).to_array();
        for l in 0..n {
            (radiance[start + l], pdf[start + l]) = ([r[l], g[l], b[l]], density[l]);
        }
        start += n;
    }
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
    parallel::for_each(
        watch,
        (u, wi, radiance, pdf),
        1 << 12,
        |_, (u, wi, radiance, pdf)| dispatch!(s => sample_body(s, panorama, u, wi, radiance, pdf)),
    )
}

#[inline(always)]
fn sample_body<T: Real, S: Simd>(
    s: S,
    panorama: &Panorama<T>,
    u: &[[T; 2]],
    wi: &mut [[T; 3]],
    radiance: &mut [[T; 3]],
    pdf: &mut [T],
) {
    let (zero, one) = (T::zero(), T::one());
    let mut start = 0;
    while start < u.len() {
        let n = (u.len() - start).min(8);
        let (mut at, mut nan) = ([[zero; 8]; 2], [zero; 8]);
        for l in 0..n {
            let [x, y] = u[start + l];
            let inside = (x >= zero) & (x <= one) & (y >= zero) & (y <= one);
            if inside {
                (at[0][l], at[1][l]) = (x, y);
            } else {
                nan[l] = T::NAN;
            }
        }
        let draw = panorama.samples::<S>(s, &at);
        let (x, y, z) = (draw.wi.x.to_array(), draw.wi.y.to_array(), draw.wi.z.to_array());
        let light = draw.radiance;
        let (r, g, b) = (light.x.to_array(), light.y.to_array(), light.z.to_array());
        let density = draw.pdf.to_array();
        for l in 0..n {
            wi[start + l] = [x[l] + nan[l], y[l] + nan[l], z[l] + nan[l]];
            radiance[start + l] = [r[l] + nan[l], g[l] + nan[l], b[l] + nan[l]];
            pdf[start + l] = density[l] + nan[l];
        }
        start += n;
    }
}
