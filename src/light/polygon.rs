//! What a polygon of even radiance sends to a point: the moments ∫ cosⁿθ dω over the part of it above the horizon, in
//! closed form. Order 0 is the solid angle, order 1 Lambert's irradiance; the higher orders integrate any polynomial of
//! the cosine, such as Schlick's Fresnel.
//!
//! Stokes' theorem on the sphere turns each into a sum over the edges' arcs: with c = cos θ and an edge's unit normal e,
//! (n + 1) τⁿ = (n − 1) τⁿ⁻² + Σ e_z ∫ cⁿ⁻¹ ds, and the arcs' integrals follow a recurrence of their own. Edges are
//! clipped exactly at the horizon; the arcs along it count for order 1 alone.
//!
//! Always in double, whatever the arrays' precision: the sum cancels where the polygon is small, and is good to about
//! 10⁻¹⁵ over the solid angle.
//!
//! J. H. Lambert, *Photometria*, 1760; J. Arvo, *Applications of irradiance tensors to the simulation of non-Lambertian
//! phenomena*, 1995.

use crate::dispatch;
use crate::math;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// Orders 0 … 6.
pub const ORDERS: usize = 7;
pub type Moments = [f64; ORDERS];

/// Sums over the edges of the clipped polygon, as they are walked.
struct Walk {
    /// Σ e_z ∫ cᵏ ds for k = 0 … 5.
    arcs: [f64; ORDERS - 1],
    /// A complex number whose angle is half the solid angle: the product of those of the arcs, of which each is that of
    /// the triangle of the arc and the pole.
    turn: [f64; 2],
    /// The first corner of the clipped polygon and the last one so far, unit.
    ends: Option<(Vec3<f64>, Vec3<f64>)>,
}

impl Walk {
    fn to(&mut self, corner: Vec3<f64>) {
        match self.ends {
            None => self.ends = Some((corner, corner)),
            Some((first, last)) => {
                self.arc(last, corner);
                self.ends = Some((first, corner));
            }
        }
    }

    /// Adds the arc from `a` to `b`.
    fn arc(&mut self, a: Vec3<f64>, b: Vec3<f64>) {
        let normal = a.cross(b);
        let sine = normal.length();
        if sine == 0.0 {
            return;
        }
        let angle = math::atan2(sine, a.dot(b));
        let e = normal * (1.0 / sine);
        // The triangle of the arc and the pole, no corner of which is farther than a right angle from it (van Oosterom
        // and Strackee 1983). Half of all is at most a half turn, so one angle of the product serves.
        let ([p, q], x, y) = (self.turn, 1.0 + a.z + b.z + a.dot(b), normal.z);
        self.turn = [p * x - q * y, p * y + q * x];
        let size = Lanes::max(self.turn[0].abs(), self.turn[1].abs());
        let (small, large) = (size < 1e-100, size > 1e100);
        if small || large {
            self.turn = [self.turn[0] / size, self.turn[1] / size];
        }
        // c and its derivative along the arc, at both ends.
        let (c0, c1) = (a.z, b.z);
        let (d0, d1) = (e.x * a.y - e.y * a.x, e.x * b.y - e.y * b.x);
        let largest = e.x * e.x + e.y * e.y;
        let mut integral = [angle, d0 - d1, 0.0, 0.0, 0.0, 0.0];
        let (mut p0, mut p1) = (c0, c1);
        for k in 2..integral.len() {
            integral[k] = ((k - 1) as f64 * largest * integral[k - 2] - (p1 * d1 - p0 * d0)) / k as f64;
            (p0, p1) = (p0 * c0, p1 * c1);
        }
        for (sum, integral) in self.arcs.iter_mut().zip(integral) {
            *sum += e.z * integral;
        }
    }
}

/// The moment of order 1 alone: [`moments`] for irradiance.
#[inline(always)]
pub fn irradiance(corners: &[Vec3<f64>]) -> f64 {
    vector_irradiance(corners).z
}

/// ∫ ω dω over the part above the horizon: its z is the irradiance, its direction the middle of what is seen.
#[inline(always)]
pub fn vector_irradiance(corners: &[Vec3<f64>]) -> Vec3<f64> {
    let mut sum = Vec3::splat(0.0);
    let (mut first, mut last) = (None, Vec3::splat(0.0));
    let mut to = |corner: Vec3<f64>, close: bool| {
        let unit = if close { corner } else { corner.normalize() };
        if first.is_none() {
            first = Some(unit);
        } else {
            let normal = last.cross(unit);
            let sine = normal.length();
            if sine > 0.0 {
                sum = sum - normal * (math::atan2(sine, last.dot(unit)) / sine);
            }
        }
        last = unit;
        first.unwrap_or(unit)
    };
    let mut before = corners[corners.len() - 1];
    let mut start = None;
    for &corner in corners {
        if (before.z > 0.0) != (corner.z > 0.0) {
            let mut crossing = before + (corner - before) * (before.z / (before.z - corner.z));
            crossing.z = 0.0;
            start = Some(to(crossing, false));
        }
        if corner.z > 0.0 {
            start = Some(to(corner, false));
        }
        before = corner;
    }
    if let Some(start) = start {
        to(start, true);
    }
    sum * 0.5
}

/// Whether a polygon, its corners given from the point, is seen from within its own plane: so nearly that rounding
/// alone decides on the side. Nothing is seen of it then.
#[inline(always)]
pub fn is_edge_on(corners: &[Vec3<f64>]) -> bool {
    let (mut normal, mut furthest) = (Vec3::splat(0.0), 0.0);
    let mut before = corners[corners.len() - 1];
    for &corner in corners {
        normal = normal + before.cross(corner);
        furthest = Lanes::max(furthest, corner.dot(corner));
        before = corner;
    }
    !(corners[0].dot(normal).abs() > 1e-14 * normal.length() * furthest.sqrt())
}

/// Moments of orders 0 … 6 of a polygon whose corners are given from the point, the normal being z. Positive for a
/// polygon that is counter-clockwise as seen from the point; zero in its plane.
pub fn moments(corners: &[Vec3<f64>]) -> Moments {
    if is_edge_on(corners) {
        return [0.0; ORDERS];
    }
    let mut walk = Walk { arcs: [0.0; ORDERS - 1], turn: [1.0, 0.0], ends: None };
    let mut before = corners[corners.len() - 1];
    for &corner in corners {
        if (before.z > 0.0) != (corner.z > 0.0) {
            // On the horizon to the bit.
            let t = before.z / (before.z - corner.z);
            let mut crossing = before + (corner - before) * t;
            crossing.z = 0.0;
            walk.to(crossing.normalize());
        }
        if corner.z > 0.0 {
            walk.to(corner.normalize());
        }
        before = corner;
    }
    if let Some((first, _)) = walk.ends {
        walk.to(first);
    }
    // Seen from the point, counter-clockwise is clockwise about the normal.
    let mut solid_angle = 2.0 * math::atan2(walk.turn[1], walk.turn[0]);
    if solid_angle.abs() > 6.0 {
        // All of the hemisphere: rounding could have turned further.
        solid_angle = solid_angle.copysign(walk.arcs[0]);
    }
    let mut moment = [-solid_angle, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for n in 1..ORDERS {
        let lower = if n >= 2 { (n - 1) as f64 * moment[n - 2] } else { 0.0 };
        moment[n] = (lower - walk.arcs[n - 1]) / (n + 1) as f64;
    }
    moment
}

/// Moments 0 … 6 of one polygon at many points; negative where its back is seen, zero in its plane.
pub fn polygon_moments_many<T: Real>(
    watch: &mut dyn Watch,
    corners: &[Vec3<f64>],
    points: &[[T; 3]],
    normals: &[[T; 3]],
    out: &mut [[T; ORDERS]],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (points, normals, out), 1 << 11, |_, (points, normals, out)| {
        let mut local = vec![Vec3::splat(0.0); corners.len()];
        dispatch!(_s => {
            for i in 0..out.len() {
                let (point, normal) = (double(points[i]), double(normals[i]));
                let frame = Frame::about(normal);
                for (local, &corner) in local.iter_mut().zip(corners) {
                    *local = frame.local(corner - point);
                }
                let nan = (point + normal).dot(Vec3::splat(0.0));
                out[i] = if nan.is_nan() { [T::NAN; ORDERS] } else { moments(&local).map(T::of) };
            }
        })
    })
}

#[inline(always)]
pub fn double<T: Real>(v: [T; 3]) -> Vec3<f64> {
    Vec3::new(v[0].to_f64(), v[1].to_f64(), v[2].to_f64())
}

#[inline(always)]
pub fn doubled<T: Real>(v: Vec3<T>) -> Vec3<f64> {
    double([v.x, v.y, v.z])
}
