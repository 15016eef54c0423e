//! Light from what a circle bounds, as seen from a point: a disk, or a sphere by its rim. Irradiance in closed form, and
//! the moments of [`super::polygon`] by the same theorem: sums over the boundary, here an integral along the circle.
//!
//! Along r(t) = c + p cos t + q sin t the irradiance is −½ ∮ (r × dr)·n / |r|², and with q perpendicular to c both parts of
//! the fraction are of the form a + b cos t + c sin t. All of the circle above the horizon is Hamilton and Morgan's form
//! factor, in a form without cancellation; a part of it takes an arc's antiderivative, and the chord along the horizon.
//!
//! D. C. Hamilton, W. R. Morgan, *Radiant-interchange configuration factors*, NACA TN 2836, 1952; J. M. Snyder, *Area
//! light sources for real-time graphics*, 1996 (spheres).

use super::polygon::ORDERS;
use crate::math;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;
use std::f64::consts::{PI, TAU};

/// A circle in the receiver's frame: the receiver at the origin, its normal z.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// The foot of the receiver's perpendicular on the circle's plane lies `height` away along −normal, `offset` before the
    /// centre along `p`.
    height: f64,
    offset: f64,
    radius: f64,
    /// Unit: in the plane away from the foot, across it, and the plane's normal, to the receiver's side.
    p: Vec3<f64>,
    q: Vec3<f64>,
    normal: Vec3<f64>,
}

/// The part of the circle above the horizon, as an interval of t.
#[derive(Clone, Copy, Debug)]
enum Above {
    All,
    None,
    Between(f64, f64),
}

impl Circle {
    /// From the centre as seen by the receiver and the unit normal of the plane, to either side.
    pub fn new(center: Vec3<f64>, normal: Vec3<f64>, radius: f64) -> Self {
        let along = center.dot(normal);
        let normal = if along > 0.0 { -normal } else { normal };
        // In the plane to the last bit, even where the centre is all but above the foot.
        let frame = Frame::about(normal);
        let (x, y) = (frame.x.dot(center), frame.y.dot(center));
        let offset = (x * x + y * y).sqrt();
        let p = if offset > 0.0 { frame.x * (x / offset) + frame.y * (y / offset) } else { frame.x };
        Circle { height: along.abs(), offset, radius, p, q: normal.cross(p), normal }
    }

    /// The rim of a sphere as it is seen, on the sphere of directions; None from within.
    pub fn rim(center: Vec3<f64>, radius: f64) -> Option<Self> {
        let axis = center.normalize();
        let sin = radius / center.dot(axis);
        if !(sin < 1.0) {
            return None;
        }
        let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
        let frame = Frame::about(-axis);
        Some(Circle { height: cos, offset: 0.0, radius: sin, p: frame.x, q: frame.y, normal: -axis })
    }

    fn at(&self, sin: f64, cos: f64) -> Vec3<f64> {
        let center = self.p * self.offset - self.normal * self.height;
        center + self.p * (self.radius * cos) + self.q * (self.radius * sin)
    }

    fn above(&self) -> Above {
        let (x, y) = (self.p.z * self.radius, self.q.z * self.radius);
        let middle = self.p.z * self.offset - self.normal.z * self.height;
        let swing = (x * x + y * y).sqrt();
        if middle >= swing {
            return Above::All;
        }
        if !(middle > -swing) {
            return Above::None;
        }
        let half = math::atan2(((swing - middle) * (swing + middle)).sqrt(), -middle);
        let top = math::atan2(y, x);
        Above::Between(top - half, top + half)
    }

    /// Irradiance of unit radiance.
    pub fn irradiance(&self) -> f64 {
        match self.above() {
            Above::All => self.full(),
            Above::None => 0.0,
            Above::Between(t0, t1) => -0.5 * (self.arc(t0, t1) + self.chord(t1, t0)),
        }
    }

    /// Of the whole circle: the vector irradiance along the normal and across it.
    fn full(&self) -> f64 {
        let (h, d, r) = (self.height, self.offset, self.radius);
        let (near, far) = (d - r, d + r);
        let s = ((h * h + near * near) * (h * h + far * far)).sqrt();
        let (sum, rest) = (h * h + d * d + r * r, h * h + near * far);
        // (s − rest) / s, with s² − rest² = (2 h r)².
        let along = if rest > 0.0 { 4.0 * (h * r) * (h * r) / (s * (s + rest)) } else { 1.0 - rest / s };
        let across = 4.0 * (h * r) * (d * r) / (s * (sum + s));
        PI / 2.0 * (self.p.z * across - self.normal.z * along)
    }

    /// ∫ (r × dr)·z / |r|² along the circle from `t0` to `t1`.
    fn arc(&self, t0: f64, t1: f64) -> f64 {
        let (h, d, r) = (self.height, self.offset, self.radius);
        // The fraction is (a0 + b0 cos t + c0 sin t) / (a + b cos t).
        let (a, b) = (h * h + d * d + r * r, 2.0 * d * r);
        let b0 = r * (d * self.normal.z + h * self.p.z);
        let c0 = r * h * self.q.z;
        let a0 = r * r * self.normal.z;
        let ((sin0, cos0), (sin1, cos1)) = (math::sin_cos(t0), math::sin_cos(t1));
        if b == 0.0 {
            return (a0 * (t1 - t0) + b0 * (sin1 - sin0) - c0 * (cos1 - cos0)) / a;
        }
        if b < 0.125 * a {
            // Nearly even in t: there the antiderivative cancels, and few points of Gauss reach the last digit.
            let half = 0.5 * (t1 - t0);
            return GAUSS
                .iter()
                .flat_map(|&(x, w)| [(x, w), (-x, w)])
                .map(|(x, w)| {
                    let (sin, cos) = math::sin_cos(t0 + half * (1.0 + x));
                    half * w * (a0 + b0 * cos + c0 * sin) / (a + b * cos)
                })
                .sum();
        }
        let (near, far) = ((h * h + (d - r) * (d - r)).sqrt(), (h * h + (d + r) * (d + r)).sqrt());
        let turn = |t: f64| {
            let (sin, cos) = math::sin_cos(0.5 * t);
            math::atan2(near * sin, far * cos)
        };
        let mixed = (d * self.normal.z * ((r - d) * (r + d) - h * h) - h * a * self.p.z) / (2.0 * d);
        let inverse = 2.0 * (turn(t1) - turn(t0)) / (near * far);
        mixed * inverse + b0 / b * (t1 - t0) - c0 / b * math::ln((a + b * cos1) / (a + b * cos0))
    }

    /// The angle along the horizon from the circle's crossing at `t0` to that at `t1`, with its sign about z.
    fn chord(&self, t0: f64, t1: f64) -> f64 {
        let [u, v] = [t0, t1].map(|t| {
            let (sin, cos) = math::sin_cos(t);
            self.at(sin, cos)
        });
        math::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y)
    }

    /// Moments 0 … 6 of the part above the horizon: to 1e-9 unless the circle passes within a tenth of its radius.
    pub fn moments(&self) -> [f64; ORDERS] {
        let (t0, t1, clipped) = match self.above() {
            Above::None => return [0.0; ORDERS],
            Above::All => (0.0, TAU, false),
            Above::Between(t0, t1) => (t0, t1, true),
        };
        // Boundary sums of orders: the solid angle's integrand, then z⁰ … z⁵.
        let mut sums = [0.0; ORDERS];
        let mut add = |t: f64, weight: f64| {
            let (sin, cos) = math::sin_cos(t);
            let along = (self.q * cos - self.p * sin) * self.radius;
            let r = self.at(sin, cos);
            let inverse = 1.0 / r.length();
            let step = weight * (r.x * along.y - r.y * along.x) * inverse * inverse;
            let z = r.z * inverse;
            sums[0] += step / (1.0 + z);
            let mut power = step;
            for sum in &mut sums[1..] {
                *sum += power;
                power *= z;
            }
        };
        if clipped {
            const PIECES: usize = 4;
            let half = 0.5 * (t1 - t0) / PIECES as f64;
            for piece in 0..PIECES {
                let middle = t0 + half * (2 * piece + 1) as f64;
                for &(x, w) in &GAUSS {
                    add(middle + half * x, half * w);
                    add(middle - half * x, half * w);
                }
            }
            sums[0] += self.chord(t1, t0);
        } else {
            // The trapezoid rule converges geometrically along a closed curve.
            const POINTS: usize = 64;
            for k in 0..POINTS {
                add(TAU * (k as f64 / POINTS as f64), TAU / POINTS as f64);
            }
        }
        let mut moment = [-sums[0], self.irradiance(), 0.0, 0.0, 0.0, 0.0, 0.0];
        for n in 2..ORDERS {
            moment[n] = ((n - 1) as f64 * moment[n - 2] - sums[n]) / (n + 1) as f64;
        }
        moment
    }
}

/// Half of the points and weights of Gauss and Legendre's rule of sixteen points on [−1, 1]; the others mirror them.
const GAUSS: [(f64, f64); 8] = [
    (0.09501250983763744, 0.1894506104550685),
    (0.2816035507792589, 0.18260341504492358),
    (0.45801677765722737, 0.16915651939500254),
    (0.6178762444026438, 0.14959598881657674),
    (0.755404408355003, 0.12462897125553388),
    (0.8656312023878318, 0.09515851168249279),
    (0.9445750230732326, 0.062253523938647894),
    (0.9894009349916499, 0.027152459411754096),
];
