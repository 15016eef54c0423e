//! Pairs of cosine lobes that stand for one of GGX, tabulated over roughness and angle.

use crate::brdf::metallic_roughness::MIN_ALPHA;
use crate::real::Lanes;
use crate::vec::Vec3;
use std::sync::OnceLock;

/// Numbers of a pair: two inverses, two magnitudes, two grazing parts.
pub const ENTRIES: usize = 12;
/// Steps along roughness and along angle of the table that is shipped.
pub const SIZE: usize = 32;

/// A cosine lobe that a matrix has sheared, in the plane of the normal (z) and the eye (x), and how much of it there is.
#[derive(Clone, Copy, Debug)]
pub struct Lobe {
    /// The inverse matrix over its middle entry, row by row without the zeros: (xx, xz), (zx, zz).
    pub inverse: [f64; 4],
    /// What all of the lobe would have of ∫ f cos θ dω without Fresnel, and of that weighed by (1 − wi·h)⁵. Tables hold
    /// what is above the horizon.
    pub magnitude: f64,
    pub grazing: f64,
}

/// A grid of pairs of lobes: over √alpha evenly in [0, 1], and over √(1 − cos θ) evenly in [0, 1].
#[derive(Clone, Debug)]
pub struct Table {
    /// One row a roughness; the last row of each inverse is divided by the row's alpha.
    pub lobes: Vec<[f32; ENTRIES]>,
    pub angles: usize,
}

/// Alpha of a row of `rows`.
pub fn alpha_of(row: usize, rows: usize) -> f64 {
    let roughness = row as f64 / (rows - 1) as f64;
    f64::max(roughness * roughness, MIN_ALPHA)
}

/// The table that is shipped.
pub fn shipped() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| {
        // Text that the compiler sees: every word of it is a number.
        let numbers: Vec<f32> = include_str!("table_data.txt")
            .split_whitespace()
            .map(|w| w.parse().unwrap_or(f32::NAN))
            .collect();
        Table { lobes: numbers.as_chunks().0.to_vec(), angles: SIZE }
    })
}

impl Table {
    /// The lobes of an alpha in [0, 1] for a cosine of the eye in (0, 1], between four of the grid.
    #[inline(always)]
    pub fn lobes(&self, alpha: f64, cos_theta: f64) -> [Lobe; 2] {
        let rows = self.lobes.len() / self.angles;
        let place = |t: f64, n: usize| {
            let t = Lanes::min(Lanes::max(t, 0.0), 1.0) * (n - 1) as f64;
            let i = (t as usize).min(n - 2);
            (i, t - i as f64)
        };
        let (i, s) = place(alpha.sqrt(), rows);
        let (j, t) = place(Lanes::max(1.0 - cos_theta, 0.0).sqrt(), self.angles);
        let at = i * self.angles + j;
        let [a, b] = [&self.lobes[at], &self.lobes[at + 1]];
        let [c, d] = [&self.lobes[at + self.angles], &self.lobes[at + self.angles + 1]];
        let mut e = [0.0; ENTRIES];
        for k in 0..ENTRIES {
            let first = f64::from(a[k]) * (1.0 - t) + f64::from(b[k]) * t;
            let second = f64::from(c[k]) * (1.0 - t) + f64::from(d[k]) * t;
            e[k] = first * (1.0 - s) + second * s;
        }
        let alpha = Lanes::max(alpha, MIN_ALPHA);
        [
            Lobe::new([e[0], e[1], e[2] * alpha, e[3] * alpha], e[8], e[10]),
            Lobe::new([e[4], e[5], e[6] * alpha, e[7] * alpha], e[9], e[11]),
        ]
    }
}

impl Lobe {
    /// From what is above the horizon.
    #[inline(always)]
    fn new(inverse: [f64; 4], magnitude: f64, grazing: f64) -> Self {
        // One over `above`, by one division.
        let [xx, _, zx, _] = inverse;
        let length = (xx * xx + zx * zx).sqrt();
        let whole = 2.0 * length / (length + xx);
        Lobe { inverse, magnitude: magnitude * whole, grazing: grazing * whole }
    }

    #[inline(always)]
    pub fn straighten(&self, v: Vec3<f64>) -> Vec3<f64> {
        let [xx, xz, zx, zz] = self.inverse;
        Vec3::new(xx * v.x + xz * v.z, v.y, zx * v.x + zz * v.z)
    }

    /// The density of the lobe per solid angle of a unit direction.
    #[inline(always)]
    pub fn density(&self, w: Vec3<f64>) -> f64 {
        let [xx, xz, zx, zz] = self.inverse;
        let v = self.straighten(w);
        let squared = v.length_squared();
        let determinant = (xx * zz - xz * zx).abs();
        Lanes::max(v.z, 0.0) * determinant / (std::f64::consts::PI * squared * squared)
    }

    /// The share of the lobe above the surface's horizon: the horizon is straightened into a great circle, and what a
    /// cosine lobe has on one side of it is (1 + cos) / 2 by the angle between both axes.
    #[inline(always)]
    pub fn above(&self) -> f64 {
        let [xx, _, zx, _] = self.inverse;
        0.5 + 0.5 * xx / (xx * xx + zx * zx).sqrt()
    }
}
