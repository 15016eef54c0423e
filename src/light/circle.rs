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

    /// Moments 0 … 6 of the part above the horizon, to some 1e-11; zero in the circle's plane.
    pub fn moments(&self) -> [f64; ORDERS] {
        let (t0, t1, clipped) = match self.above() {
            Above::None => return [0.0; ORDERS],
            Above::All => (0.0, TAU, false),
            Above::Between(t0, t1) => (t0, t1, true),
        };
        if !(self.height > 1e-14 * (self.offset + self.radius)) {
            return [0.0; ORDERS];
        }
        // Boundary sums of orders: the solid angle's integrand, then z⁰ … z⁵.
        let mut sums = [0.0; ORDERS];
        // Turn by turn about the place next to the point, which t = π is.
        let mut from = t0;
        while from < t1 {
            let turn = (from / TAU).floor();
            let to = t1.min((turn + 1.0) * TAU);
            let middle = (turn + 0.5) * TAU;
            self.add(from - middle, to - middle, &mut sums);
            from = if to > from { to } else { t1 };
        }
        if clipped {
            sums[0] += self.chord(t1, t0);
        }
        let mut moment = [-sums[0], self.irradiance(), 0.0, 0.0, 0.0, 0.0, 0.0];
        for n in 2..ORDERS {
            moment[n] = ((n - 1) as f64 * moment[n - 2] - sums[n]) / (n + 1) as f64;
        }
        moment
    }

    /// Adds the boundary sums from `s0` to `s1` in [−π, π], counted from the place next to the point. There the integrand
    /// peaks as narrowly as the circle comes near; by s = δ sinh w it is as smooth in w as elsewhere in s.
    fn add(&self, s0: f64, s1: f64, sums: &mut [f64; ORDERS]) {
        let (r, gap) = (self.radius, self.offset - self.radius);
        let near = (self.height * self.height + gap * gap).sqrt() / r;
        // From afar it is smooth as it is, and differences of exponentials would round.
        let afar = near > 1.0;
        let (w0, w1) = if afar { (s0, s1) } else { (asinh(s0 / near), asinh(s1 / near)) };
        let pieces = ((w1 - w0) / 2.0).ceil().max(2.0);
        let half = 0.5 * (w1 - w0) / pieces;
        for piece in 0..pieces as usize {
            let middle = w0 + half * (2 * piece + 1) as f64;
            for &(x, weight) in &GAUSS {
                for w in [middle - half * x, middle + half * x] {
                    let (s, stretch) = if afar {
                        (w, 1.0)
                    } else {
                        let (up, down) = (math::exp(w), math::exp(-w));
                        (near * 0.5 * (up - down), near * 0.5 * (up + down))
                    };
                    let weight = weight * half * stretch;
                    let (sin, cos) = math::sin_cos(s);
                    let (half_sin, _) = math::sin_cos(0.5 * s);
                    // d + r cos t without cancellation: t is s and half a turn.
                    let along = gap + 2.0 * r * half_sin * half_sin;
                    let at = self.p * along - self.normal * self.height - self.q * (r * sin);
                    let step = (self.p * sin - self.q * cos) * r;
                    let inverse = 1.0 / at.length();
                    let turned = weight * (at.x * step.y - at.y * step.x) * inverse * inverse;
                    let z = at.z * inverse;
                    sums[0] += turned / (1.0 + z);
                    let mut power = turned;
                    for sum in &mut sums[1..] {
                        *sum += power;
                        power *= z;
                    }
                }
            }
        }
    }
}

fn asinh(x: f64) -> f64 {
    let y = x.abs();
    math::ln(y + (y * y + 1.0).sqrt()).copysign(x)
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

#[cfg(test)]
mod tests {
    use super::super::polygon;
    use super::*;

    /// Against a polygon of very many corners: its edges lie 2e-11 within the circle, so that by a rim at a distance h
    /// it is off by 2e-11 / h.
    #[test]
    fn moments_are_those_of_a_polygon_of_many_corners() {
        let corners = 1 << 19;
        for (height, offset, tilt) in [
            (0.3, 0.2, 0.0),
            (1e-3, 1.005, 1.6),
            (1e-3, 0.999, 0.9),
            (0.01, 0.99, -1.2),
            (0.1, 1.2, 2.0),
            (1e-4, 1.0, 0.7),
            (1e-4, 0.3, 1.0),
            (2.0, 5.0, 1.5),
            (200.0, 3.0, 0.3),
            (1e-3, 3.0, 1.5),
        ] {
            // The receiver's normal leans from the disk's by the tilt.
            let (sin, cos) = math::sin_cos(tilt);
            let (across, up) = (Vec3::new(cos, 0.0, sin), Vec3::new(-sin, 0.0, cos));
            let center = up * height - across * offset;
            let circle = Circle::new(center, -up, 1.0);
            let y = Vec3::new(0.0, 1.0, 0.0);
            let points: Vec<Vec3<f64>> = (0..corners)
                .map(|k| {
                    let (s, c) = math::sin_cos(-TAU * k as f64 / corners as f64);
                    center + across * c + y * s
                })
                .collect();
            let (found, expected) = (circle.moments(), polygon::moments(&points));
            for n in 0..ORDERS {
                let error = (found[n] - expected[n]).abs();
                assert!(
                    error < 1e-10 + 6e-11 / height,
                    "{height} {offset} {tilt} {n}: {found:?} {expected:?}"
                );
            }
        }
    }
}
