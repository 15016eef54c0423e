//! The unit square onto a spherical triangle, areas in constant proportion.
//!
//! Arvo's construction: a share u of the area fixes a point on one side, opposite the triangle's second corner; a share v
//! of the cap's depth then fixes the point on the arc between them. Here it is solved in tangents of half angles. With D
//! the unit tangent at A of the side AC, the triangle (A, B, A cos s + D sin s) has, by van Oosterom and Strackee's
//! formula, tan(area / 2) = t V / (1 + A·B + t B·D) with t = tan(s / 2) and V = det(A, B, D), which gives t at once; all
//! directions are kept as differences from a corner. So there is nothing to cancel where the triangle is small: the area
//! keeps its digits, and points their place, as far as directions can hold it.
//!
//! J. Arvo, *Stratified sampling of spherical triangles*, 1995; A. van Oosterom, J. Strackee, *The solid angle of a plane
//! triangle*, 1983.

use super::below_one;
use crate::math;
use crate::math::exact::{exponent, largest, scaled};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// A triangle on the unit sphere.
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle<T> {
    a: Vec3<T>,
    b: Vec3<T>,
    /// The second and third corner from the first.
    ab: Vec3<T>,
    ac: Vec3<T>,
    /// The unit tangent at `a` of the side to `c`.
    tangent: Vec3<T>,
    /// det(a, b, tangent), 1 + a·b, b·tangent.
    volume: T,
    beside: T,
    slope: T,
    solid_angle: T,
}

/// The difference of the unit vectors along `p` and `q`, with the digits of `q - p` where these are of like length.
#[inline(always)]
fn unit_difference<T: Real>(p: Vec3<T>, q: Vec3<T>) -> Vec3<T> {
    let (p_length, q_length) = (p.length(), q.length());
    let edge = q + -p;
    let longer = edge.dot(q + p) / (p_length + q_length);
    if longer.abs() * T::of(2.0) > Lanes::min(p_length, q_length) {
        return q.normalize() + -p.normalize();
    }
    (edge * p_length + -(p * longer)) * (T::one() / (p_length * q_length))
}

/// The point of the great circle from the unit vector `from` towards `from + step`, at which 1 − cos is `depth` and
/// 1 + cos is `rest`.
#[inline(always)]
fn along<T: Real>(from: Vec3<T>, step: Vec3<T>, depth: T, rest: T) -> Vec3<T> {
    from + -(from * depth) + tangent(from, step) * (depth * rest).sqrt()
}

/// The unit tangent at a unit vector towards another one, given as their difference.
#[inline(always)]
fn tangent<T: Real>(from: Vec3<T>, step: Vec3<T>) -> Vec3<T> {
    // from · step = -|step|² / 2 on the sphere.
    (step + from * (step.length_squared() * T::of(0.5))).normalize()
}

impl<T: Real> SphericalTriangle<T> {
    /// Of three directions of any length; either way round. NaN where two coincide or are opposite.
    #[inline(always)]
    pub fn new(a: Vec3<T>, b: Vec3<T>, c: Vec3<T>) -> Self {
        // In units of a power of two near the longest component, so that squares stay in range and nothing is rounded.
        let size = Lanes::max(Lanes::max(largest(a), largest(b)), largest(c));
        let [a, b, c] = [a, b, c].map(|v| v.map(|x| scaled(x, -exponent(size))));
        let (ab, ac) = (unit_difference(a, b), unit_difference(a, c));
        let [a, b] = [a, b].map(|v| v.normalize());
        let half = T::of(0.5);
        let tangent = tangent(a, ac);
        let beside = (a + b).length_squared() * half;
        let bc = ac + -ab;
        // 1 + a·b + b·c + c·a, and the corners' volume.
        let sum = T::of(4.0) - (ab.length_squared() + ac.length_squared() + bc.length_squared()) * half;
        let solid_angle = T::of(2.0) * math::atan2(a.dot(ab.cross(ac)).abs(), sum);
        let volume = a.dot(ab.cross(tangent)).abs();
        SphericalTriangle { a, b, ab, ac, tangent, volume, beside, slope: ab.dot(tangent), solid_angle }
    }
    #[inline(always)]
    pub fn solid_angle(&self) -> T {
        self.solid_angle
    }
    /// The point of the side `ac` at tan(s / 2) = up / down from `a`, as the difference from `a`.
    #[inline(always)]
    fn on_side(&self, up: T, down: T) -> Vec3<T> {
        let squared = up * up + down * down;
        (self.tangent * down + -(self.a * up)) * (T::of(2.0) * up / squared)
    }
    #[inline(always)]
    pub fn sample(&self, u: [T; 2]) -> Vec3<T> {
        let (one, half, two) = (T::one(), T::of(0.5), T::of(2.0));
        let [u, v] = super::in_square(u);
        let (sin, cos) = math::sin_cos(u * self.solid_angle * half);
        let (up, down) = (sin * self.beside, cos * self.volume - sin * self.slope);
        // The largest becomes one, so that squares neither vanish nor overflow.
        let size = Lanes::max(up.abs(), down.abs());
        let side = self.on_side(up / size, down / size);
        // From b towards that point: its depth 1 - cos, and the rest of the diameter, 1 + cos.
        let step = side + -self.ab;
        let full = step.length_squared() * half;
        let opposite = (self.a + side + self.b).length_squared() * half;
        let rest = two * (one - v) + v * opposite;
        along(self.b, step, v * full, rest).normalize()
    }
    /// The inverse of [`SphericalTriangle::sample`] for unit directions in the triangle, in [0, 1).
    #[inline(always)]
    pub fn invert(&self, d: Vec3<T>) -> [T; 2] {
        let (one, zero) = (T::one(), T::zero());
        let step = d + -self.b;
        // The plane through b and d meets the side at the angle s of a cos s + tangent sin s.
        let across = self.b.cross(step);
        let (mut x, mut y) = (across.dot(self.tangent), across.dot(self.ab));
        // Of the two points where it does, the one that d is on the way to.
        // Seen from b, along which it has no part: lengths of rounded directions tell nothing.
        let way = step + -(self.b * self.b.dot(step));
        if (self.tangent * y + -(self.ab * x)).dot(way) < zero {
            (x, y) = (-x, -y);
        }
        // A direction beside the first side is moved onto it.
        let y = if y < zero { zero } else { y };
        let r = x.abs() + y.abs();
        let (x, y) = if r > zero { (x / r, y / r) } else { (one, zero) };
        // tan(s / 2) = sin / (1 + cos), from the end without cancellation.
        let length = (x * x + y * y).sqrt();
        let (up, down) = if x >= zero { (y, length + x) } else { (length - x, y) };
        let area = T::of(2.0) * math::atan2(up * self.volume, down * self.beside + up * self.slope);
        let size = Lanes::max(up.abs(), down.abs());
        let full = (self.on_side(up / size, down / size) + -self.ab).length_squared();
        let u = area / self.solid_angle;
        let v = if full > zero { step.length_squared() / full } else { zero };
        below_one([u, v])
    }
    /// The density per solid angle of a unit direction: one over the triangle's within it, else zero. A few rounding units
    /// about the sides count as inside.
    #[inline(always)]
    pub fn pdf(&self, d: Vec3<T>) -> T {
        let c = self.ac + self.a;
        let bc = self.ac + -self.ab;
        let step = d + -self.a;
        let sign = T::one().copysign(self.a.dot(self.ab.cross(self.ac)));
        // Distances from the planes of the sides: of unit normals, so that the margin is an angle.
        let [ab, bc, ca] = [
            self.a.cross(self.ab).normalize().dot(step),
            self.b.cross(bc).normalize().dot(d + -self.b),
            c.cross(-self.ac).normalize().dot(d + -c),
        ]
        .map(|x| x * sign);
        let margin = -T::of(16.0) * T::EPSILON;
        let outside = ab < margin || bc < margin || ca < margin;
        let even = T::one() / self.solid_angle + (ab + bc + ca) * T::zero();
        if outside { T::zero() } else { even }
    }
}
