//! The fit of [`super::Table`]: for each roughness and angle the matrix whose lobe is nearest to that of GGX.
//!
//! Nearest by the triangular discrimination ∫ (f − g)² / (f + g) dω of both as densities, which is 0 for equal lobes and 2
//! for disjoint ones, however sharp they are; by directions drawn from both. The lobe's density is that of its part above
//! the horizon. Four numbers are sought by Nelder and Mead's
//! simplex: the stretch along and across the plane of incidence, the shear, and the tilt. Along a row of the table each
//! fit starts from that of the angle before.
//!
//! `python tests/light/test_ltc.py fit` writes the table that is shipped.
//!
//! J. A. Nelder, R. Mead, *A simplex method for function minimization*, 1965.

use super::{ENTRIES, Lobe, Table, alpha_of};
use crate::brdf::fresnel::schlick_weight;
use crate::brdf::ggx::{self, Masking};
use crate::math;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Lanes;
use crate::sampling::cosine_hemisphere::square_to_cosine_hemisphere;
use crate::sampling::disk::Method;
use crate::vec::Vec3;
use std::sync::Mutex;

/// Logarithms of the stretches, the shear over the stretch, the tilt.
type Shape = [f64; 4];

/// A sheared cosine lobe with its forward matrix.
struct Sheared {
    lobe: Lobe,
    /// Columns of the forward matrix in the plane, and the stretch across it.
    x: [f64; 2],
    z: [f64; 2],
    across: f64,
}

impl Sheared {
    fn new([along, across, shear, tilt]: Shape) -> Self {
        let (m, n) = (math::exp(along), math::exp(across));
        let (sin, cos) = math::sin_cos(tilt);
        // M = turn · (m, 0, s; 0, n, 0; 0, 0, 1): the columns in the plane of (x, z).
        let s = shear * m;
        let x = [cos * m, -sin * m];
        let z = [cos * s + sin, cos - sin * s];
        // The inverse times n: the middle entry becomes one.
        let scale = n / m;
        let inverse = [z[1] * scale, -z[0] * scale, -x[1] * scale, x[0] * scale];
        Sheared { lobe: Lobe { inverse, magnitude: 1.0, grazing: 0.0 }, x, z, across: n }
    }
    fn sample(&self, u: [f64; 2]) -> Vec3<f64> {
        let c = square_to_cosine_hemisphere(u, Method::Concentric);
        Vec3::new(self.x[0] * c.x + self.z[0] * c.z, self.across * c.y, self.x[1] * c.x + self.z[1] * c.z)
            .normalize()
    }
}

/// GGX times the cosine, seen from one direction.
struct Target {
    wo: Vec3<f64>,
    alpha: f64,
    magnitude: f64,
    grazing: f64,
    /// Directions drawn from its visible normals, with their densities.
    drawn: Vec<(Vec3<f64>, f64)>,
    squares: Vec<[f64; 2]>,
}

impl Target {
    fn new(alpha: f64, cos_theta: f64, steps: usize) -> Self {
        let wo = Vec3::new(((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt(), 0.0, cos_theta);
        let middle = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
        let squares: Vec<[f64; 2]> =
            (0..steps * steps).map(|k| [middle(k % steps, steps), middle(k / steps, steps)]).collect();
        let mut target = Target { wo, alpha, magnitude: 0.0, grazing: 0.0, drawn: Vec::new(), squares };
        // The magnitudes are means over a finer square, with points crowded at the ends of the second number, where the
        // lobe's long tails are.
        let fine = 8 * steps;
        for k in 0..fine * fine {
            let v = middle(k / fine, fine);
            let (wi, pdf) = target.draw([middle(k % fine, fine), v * v * (3.0 - 2.0 * v)]);
            if wi.z > 0.0 && pdf > 0.0 {
                let crowding = 6.0 * v * (1.0 - v);
                let weight = crowding * target.value(wi) / (pdf * (fine * fine) as f64);
                let half = (wi + wo).normalize();
                target.magnitude += weight;
                target.grazing += weight * schlick_weight(Lanes::min(wi.dot(half), 1.0));
            }
        }
        target.drawn = target.squares.iter().map(|&u| target.draw(u)).collect();
        target
    }
    fn draw(&self, u: [f64; 2]) -> (Vec3<f64>, f64) {
        let wi = ggx::ggx_sample(self.wo, u, self.alpha);
        (wi, ggx::ggx_pdf(wi, self.wo, self.alpha))
    }
    /// f cos θ without Fresnel.
    fn value(&self, wi: Vec3<f64>) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        ggx::distribution_and_visibility(wi, self.wo, self.alpha, Masking::HeightCorrelated).0 * wi.z
    }
    /// The triangular discrimination of the lobe and the target.
    fn distance(&self, shape: Shape) -> f64 {
        let sheared = Sheared::new(shape);
        let above = sheared.lobe.above();
        let term = |wi: Vec3<f64>, drawn: f64| {
            // Of the lobe's part above the horizon; draws are from all of it.
            let all = sheared.lobe.density(wi);
            let (f, g) = (self.value(wi) / self.magnitude, if wi.z > 0.0 { all / above } else { 0.0 });
            let sum = f + g;
            // Balanced over both ways to draw.
            let weight = drawn + all;
            if sum > 0.0 && weight > 0.0 { (f - g) * (f - g) / (sum * weight) } else { 0.0 }
        };
        let mut total = 0.0;
        for (&(wi, pdf), &u) in self.drawn.iter().zip(&self.squares) {
            total += term(wi, pdf);
            let wi = sheared.sample(u);
            total += term(wi, ggx::ggx_pdf(wi, self.wo, self.alpha));
        }
        let result = total / self.squares.len() as f64;
        if result.is_finite() { result } else { f64::MAX }
    }
    /// Around the mirror direction, as wide as alpha.
    fn guess(&self) -> Shape {
        let width = math::ln(1.2 * self.alpha);
        [width, width, 0.0, -math::atan2(self.wo.x, self.wo.z)]
    }
}

/// The least of a function near `start`.
fn minimize(start: Shape, steps: Shape, f: impl Fn(Shape) -> f64) -> (Shape, f64) {
    const N: usize = 4;
    let mut simplex: Vec<(Shape, f64)> = (0..=N)
        .map(|k| {
            let mut x = start;
            if k > 0 {
                x[k - 1] += steps[k - 1];
            }
            (x, f(x))
        })
        .collect();
    for _ in 0..400 {
        simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (simplex[0], simplex[N]);
        let spread: f64 = (0..N).map(|i| (best.0[i] - worst.0[i]).abs()).fold(0.0, f64::max);
        if spread < 1e-6 {
            break;
        }
        let middle: Shape =
            std::array::from_fn(|i| simplex[..N].iter().map(|s| s.0[i]).sum::<f64>() / N as f64);
        let along = |t: f64| {
            let x: Shape = std::array::from_fn(|i| middle[i] + t * (worst.0[i] - middle[i]));
            (x, f(x))
        };
        let reflected = along(-1.0);
        let next = if reflected.1 < best.1 {
            let further = along(-2.0);
            if further.1 < reflected.1 { further } else { reflected }
        } else if reflected.1 < simplex[N - 1].1 {
            reflected
        } else {
            along(if reflected.1 < worst.1 { -0.5 } else { 0.5 })
        };
        if next.1 < worst.1 {
            simplex[N] = next;
        } else {
            for s in &mut simplex[1..] {
                let x = std::array::from_fn(|i| 0.5 * (s.0[i] + best.0[i]));
                *s = (x, f(x));
            }
        }
    }
    simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
    simplex[0]
}

/// One row of the table: entries and the distance left, for every angle.
fn row(alpha: f64, angles: usize, steps: usize) -> Vec<([f32; ENTRIES], f64)> {
    let mut shape = None;
    (0..angles)
        .map(|j| {
            let t = j as f64 / (angles - 1) as f64;
            // At the horizon itself there is no lobe.
            let target = Target::new(alpha, Lanes::max(1.0 - t * t, 1e-3), steps);
            let guess = target.guess();
            let steps = [0.2, 0.2, 0.1, 0.5 * Lanes::min(alpha, 0.4)];
            let mut found = minimize(guess, steps, |x| target.distance(x));
            if let Some(before) = shape {
                let warm = minimize(before, steps, |x| target.distance(x));
                if warm.1 < found.1 {
                    found = warm;
                }
            }
            shape = Some(found.0);
            let [xx, xz, zx, zz] = Sheared::new(found.0).lobe.inverse;
            let entry = [xx, xz, zx / alpha, zz / alpha, target.magnitude, target.grazing];
            (entry.map(|x| x as f32), found.1)
        })
        .collect()
}

/// A table of `rows` roughnesses and `angles` angles, fitted over `steps`² directions of both lobes, with the distance
/// that is left at each.
pub fn fit_ltc(
    watch: &mut dyn Watch,
    rows: usize,
    angles: usize,
    steps: usize,
) -> Result<(Table, Vec<f64>), Interrupted> {
    let slots: Vec<_> = (0..rows).map(|_| Mutex::new(Vec::new())).collect();
    parallel::run(watch, rows, |i| {
        if let Ok(mut slot) = slots[i].lock() {
            *slot = row(alpha_of(i, rows), angles, steps);
        }
    })?;
    let done = slots.into_iter().flat_map(|s| s.into_inner().unwrap_or_default());
    let (lobes, left) = done.unzip();
    Ok((Table { lobes, angles }, left))
}
