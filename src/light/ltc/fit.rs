//! The fit of [`super::Table`]: for each roughness and angle the pair of lobes whose sum is nearest to GGX.
//!
//! Nearest as densities, by ∫ (f − g)² / (f + ε) dω: squares over f + ε, so that neither a bright place nor a dim one
//! counts alone. By directions drawn from GGX, from a wider one and evenly by the cosine, balanced; the same for every
//! trial, so that the distance is smooth. The eight numbers of both shapes (stretch along and across the plane of
//! incidence, shear, tilt) are sought by Levenberg's and Marquardt's steps. Both lobes have half of the light: shares that
//! are free make the second lobe a far tail here and a half there, and between such neighbours the table is wrong by
//! more than they are. Each pair starts from its neighbour in the table and is held near it where the distance does
//! not tell: neighbours that are alike are what interpolation between them needs.
//!
//! `python tests/light/test_ltc.py fit` writes the table that is shipped.
//!
//! D. W. Marquardt, *An algorithm for least-squares estimation of nonlinear parameters*, 1963.

use super::table::{ENTRIES, Lobe, Table, alpha_of};
use crate::brdf::fresnel::schlick_weight;
use crate::brdf::ggx::{self, Masking};
use crate::math;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Lanes;
use crate::sampling::cosine_hemisphere::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};
use crate::sampling::disk::Method;
use crate::vec::Vec3;
use std::sync::Mutex;
use std::sync::atomic::Ordering;

/// Numbers of both shapes: for each the logarithms of the stretches over alpha, the shear over the stretch, and how far
/// from the mirror direction it is tilted, over alpha.
const UNKNOWN: usize = 8;
type Shapes = [f64; UNKNOWN];
/// ε: what keeps dim places from counting by their ratio alone.
const DIM: f64 = 0.02;
/// How strongly neighbours are held together.
const HOLD: f64 = 1e-3;
const MOST_STEPS: usize = 60;
/// Of the light, in the second lobe.
const SHARE: f64 = 0.5;
/// One lobe of a shape, of unit magnitude, for an eye at an angle.
fn lobe(alpha: f64, eye: f64, shape: &[f64]) -> Lobe {
    let (m, n) = (alpha * math::exp(shape[0]), alpha * math::exp(shape[1]));
    let (sin, cos) = math::sin_cos(alpha * shape[3] - eye);
    // M = turn · (m, 0, s; 0, n, 0; 0, 0, 1): the columns in the plane of (x, z).
    let s = shape[2] * m;
    let x = [cos * m, -sin * m];
    let z = [cos * s + sin, cos - sin * s];
    // The inverse times n: the middle entry becomes one.
    let scale = n / m;
    Lobe { inverse: [z[1] * scale, -z[0] * scale, -x[1] * scale, x[0] * scale], magnitude: 1.0, grazing: 0.0 }
}

/// A direction above the horizon with what it stands for, and the density of GGX times the cosine there.
struct Place {
    wi: Vec3<f64>,
    weight: f64,
    value: f64,
    /// Schlick's (1 − wi·h)⁵.
    grazing: f64,
}

/// GGX times the cosine, seen from one direction.
struct Target {
    alpha: f64,
    magnitude: f64,
    grazing: f64,
    places: Vec<Place>,
    /// Its angle from the normal.
    eye: f64,
}

/// A pair of shapes under trial.
struct Trial {
    /// Of the distance, with what holds it.
    square: f64,
    residuals: Vec<f64>,
}

impl Target {
    fn new(alpha: f64, cos_theta: f64, steps: usize) -> Self {
        let wo = Vec3::new(((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt(), 0.0, cos_theta);
        let middle = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
        let value = |wi: Vec3<f64>| {
            ggx::distribution_and_visibility(wi, wo, alpha, Masking::HeightCorrelated).0 * wi.z
        };
        let schlick = |wi: Vec3<f64>| schlick_weight(Lanes::min(wi.dot((wi + wo).normalize()), 1.0));
        let (mut magnitude, mut grazing) = (0.0, 0.0);
        // The magnitudes are means over a finer square, with points crowded at the ends of the second number, where the
        // lobe's long tails are.
        let fine = 8 * steps;
        for k in 0..fine * fine {
            let v = middle(k / fine, fine);
            let wi = ggx::ggx_sample(wo, [middle(k % fine, fine), v * v * (3.0 - 2.0 * v)], alpha);
            let pdf = ggx::ggx_pdf(wi, wo, alpha);
            if wi.z > 0.0 && pdf > 0.0 {
                let weight = 6.0 * v * (1.0 - v) * value(wi) / (pdf * (fine * fine) as f64);
                magnitude += weight;
                grazing += weight * schlick(wi);
            }
        }
        let wider = f64::min(4.0 * alpha, 1.0);
        let mut places = Vec::new();
        for k in 0..3 * steps * steps {
            let (which, k) = (k % 3, k / 3);
            let u = [middle(k % steps, steps), middle(k / steps, steps)];
            let wi = match which {
                0 => ggx::ggx_sample(wo, u, alpha),
                1 => ggx::ggx_sample(wo, u, wider),
                _ => square_to_cosine_hemisphere(u, Method::Concentric),
            };
            let pdf = ggx::ggx_pdf(wi, wo, alpha)
                + ggx::ggx_pdf(wi, wo, wider)
                + square_to_cosine_hemisphere_pdf(wi);
            if wi.z > 0.0 && pdf > 0.0 {
                let weight = 1.0 / (pdf * (steps * steps) as f64);
                places.push(Place { wi, weight, value: value(wi) / magnitude, grazing: schlick(wi) });
            }
        }
        Target { alpha, magnitude, grazing, places, eye: math::atan2(wo.x, wo.z) }
    }

    /// A narrow lobe about the mirror direction, and a wide one about it.
    fn guess(&self) -> Shapes {
        [0.0, 0.0, 0.0, 0.0, 0.7, 0.5, 0.0, 0.0]
    }

    /// Both lobes with one over what of them is above the horizon.
    fn lobes(&self, shapes: &Shapes) -> [(Lobe, f64); 2] {
        [lobe(self.alpha, self.eye, &shapes[..4]), lobe(self.alpha, self.eye, &shapes[4..])].map(|l| {
            let whole = 1.0 / l.above();
            (l, whole)
        })
    }

    /// The sum over places of a pair of those shapes, held near `near`.
    fn trial(&self, shapes: &Shapes, near: &Shapes) -> Trial {
        let [(a, a_whole), (b, b_whole)] = self.lobes(shapes);
        let mut residuals = Vec::with_capacity(self.places.len() + UNKNOWN);
        for p in &self.places {
            let sum = (a.density(p.wi) * a_whole) * (1.0 - SHARE) + (b.density(p.wi) * b_whole) * SHARE;
            residuals.push((p.value - sum) * (p.weight / (p.value + DIM)).sqrt());
        }
        for k in 0..UNKNOWN {
            residuals.push(HOLD * (shapes[k] - near[k]));
        }
        let square = residuals.iter().map(|r| r * r).sum();
        Trial { square: if square < f64::INFINITY { square } else { f64::MAX }, residuals }
    }

    /// The nearest pair from `start` on.
    fn nearest(&self, start: Shapes) -> Shapes {
        let (mut shapes, mut damping) = (start, 1e-2);
        let mut best = self.trial(&shapes, &start);
        for _ in 0..MOST_STEPS {
            let mut slopes = Vec::with_capacity(UNKNOWN);
            for k in 0..UNKNOWN {
                let mut moved = shapes;
                moved[k] += 1e-5;
                slopes.push(self.trial(&moved, &start).residuals);
            }
            let mut normal = [[0.0; UNKNOWN]; UNKNOWN];
            let mut right = [0.0; UNKNOWN];
            for (i, now) in best.residuals.iter().enumerate() {
                let row: Shapes = std::array::from_fn(|k| (slopes[k][i] - now) * 1e5);
                for j in 0..UNKNOWN {
                    right[j] -= row[j] * now;
                    for k in 0..UNKNOWN {
                        normal[j][k] += row[j] * row[k];
                    }
                }
            }
            let mut bettered = false;
            for _ in 0..8 {
                let mut damped = normal;
                for (k, row) in damped.iter_mut().enumerate() {
                    row[k] += damping * (row[k] + 1e-9);
                }
                let step = solve(damped, right);
                let moved: Shapes = std::array::from_fn(|k| shapes[k] + step[k].clamp(-0.5, 0.5));
                let trial = self.trial(&moved, &start);
                if trial.square < best.square {
                    bettered = trial.square < best.square * (1.0 - 1e-7);
                    (shapes, best, damping) = (moved, trial, damping * 0.2);
                    break;
                }
                damping *= 6.0;
            }
            if !bettered {
                break;
            }
        }
        shapes
    }

    /// Numbers of the table, and the distance that is left.
    fn entry(&self, shapes: &Shapes) -> ([f32; ENTRIES], f64) {
        let [(a, a_whole), (b, b_whole)] = self.lobes(shapes);
        // The part of the grazing term that goes with the second lobe, by least squares; both sum to what it is.
        let rest = self.grazing / self.magnitude;
        let (mut top, mut bottom, mut left) = (0.0, 0.0, 0.0);
        for p in &self.places {
            let (f, g) = (a.density(p.wi) * a_whole, b.density(p.wi) * b_whole);
            let weight = p.weight / (p.value + DIM);
            top += weight * (p.value * p.grazing - rest * f) * (g - f);
            bottom += weight * (g - f) * (g - f);
            let sum = f + SHARE * (g - f);
            if p.value + sum > 0.0 {
                left += p.weight * (p.value - sum) * (p.value - sum) / (p.value + sum);
            }
        }
        let second = if bottom > 0.0 { Lanes::min(Lanes::max(top / bottom, 0.0), rest) } else { 0.0 };
        let [axx, axz, azx, azz] = a.inverse;
        let [bxx, bxz, bzx, bzz] = b.inverse;
        let (alpha, all) = (self.alpha, self.magnitude);
        let entry = [
            [axx, axz, azx / alpha, azz / alpha],
            [bxx, bxz, bzx / alpha, bzz / alpha],
            [all * (1.0 - SHARE), all * SHARE, all * (rest - second), all * second],
        ];
        let mut out = [0.0; ENTRIES];
        for (out, x) in out.iter_mut().zip(entry.as_flattened()) {
            *out = *x as f32;
        }
        (out, left)
    }
}

/// The solution of a positive definite system, by elimination.
fn solve(mut a: [[f64; UNKNOWN]; UNKNOWN], mut b: Shapes) -> Shapes {
    for i in 0..UNKNOWN {
        let pivot = if a[i][i] != 0.0 { a[i][i] } else { f64::MIN_POSITIVE };
        for j in i + 1..UNKNOWN {
            let factor = a[j][i] / pivot;
            for k in i..UNKNOWN {
                a[j][k] -= factor * a[i][k];
            }
            b[j] -= factor * b[i];
        }
    }
    for i in (0..UNKNOWN).rev() {
        for k in i + 1..UNKNOWN {
            b[i] -= a[i][k] * b[k];
        }
        b[i] /= if a[i][i] != 0.0 { a[i][i] } else { f64::MIN_POSITIVE };
        if !b[i].is_finite() {
            b[i] = 0.0;
        }
    }
    b
}

/// The target of a column of `angles`; at the horizon itself there is no lobe.
fn target(alpha: f64, column: usize, angles: usize, steps: usize) -> Target {
    let t = column as f64 / (angles - 1) as f64;
    Target::new(alpha, Lanes::max(1.0 - t * t, 1e-3), steps)
}

/// Where the rows of [`fit_ltc`] begin: seen from straight above there is neither shear nor tilt to find.
fn first_column(
    watch: &mut dyn Watch,
    rows: usize,
    angles: usize,
    steps: usize,
) -> Result<Vec<Shapes>, Interrupted> {
    parallel::run_forking(watch, |stop| {
        let mut starts = Vec::with_capacity(rows);
        for i in (0..rows).rev() {
            let target = target(alpha_of(i, rows), 0, angles, steps);
            let start = starts.last().copied().unwrap_or_else(|| target.guess());
            if stop.load(Ordering::Relaxed) {
                starts.push(start);
                continue;
            }
            let (warm, cold) = (target.nearest(start), target.nearest(target.guess()));
            // The neighbour's kind, unless it is far from what there is.
            let [near, far] = [warm, cold].map(|x| target.trial(&x, &x).square);
            starts.push(if near > 4.0 * far { cold } else { warm });
        }
        starts.reverse();
        starts
    })
}

/// A table of `rows` roughnesses and `angles` angles, fitted over 3 · `steps`² directions, with the distance that is left
/// at each: the triangular discrimination ∫ (f − g)² / (f + g) dω.
pub fn fit_ltc(
    watch: &mut dyn Watch,
    rows: usize,
    angles: usize,
    steps: usize,
) -> Result<(Table, Vec<f64>), Interrupted> {
    let starts = first_column(watch, rows, angles, steps)?;
    let slots: Vec<_> = (0..rows).map(|_| Mutex::new(Vec::new())).collect();
    parallel::run(watch, rows, |i| {
        let mut row = Vec::with_capacity(angles);
        let mut shapes = starts[i];
        for j in 0..angles {
            let target = target(alpha_of(i, rows), j, angles, steps);
            let found = target.nearest(shapes);
            row.push(target.entry(&found));
            shapes = found;
        }
        if let Ok(mut slot) = slots[i].lock() {
            *slot = row;
        }
    })?;
    let done = slots.into_iter().flat_map(|s| s.into_inner().unwrap_or_default());
    let (lobes, left) = done.unzip();
    Ok((Table { lobes, angles }, left))
}
