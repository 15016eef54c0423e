//! The unit square onto the directions towards a rectangle, areas in constant proportion: u fixes a plane through the
//! origin and across the rectangle, v the height of the point within that plane.
//!
//! Ureña, Fajardo and King's map, solved so that nothing cancels. In the rectangle's frame, at distance d from its
//! plane, let L be the solid angle of the strip y0 < y < y1 left of x, and R that right of it; then with η1 = atan(d / y1)
//! and η0 = atan(d / y0),
//!
//! x = d sin((L − R) / 2) / √(4 sin(L/2) sin(R/2) sin(η1 + L/2) sin(η1 + R/2)),
//!
//! where η1 + L/2 = η0 − R/2 and η1 + R/2 = η0 − L/2. L grows by the share u of the rectangle's solid angle and R by the
//! share 1 − u, all of them sums of positive terms. Small, distant and grazing rectangles keep their digits in single
//! precision.
//!
//! C. Ureña, M. Fajardo, A. King, *An area-preserving parametrization for spherical rectangles*, 2013; A. van Oosterom,
//! J. Strackee, *The solid angle of a plane triangle*, 1983.

use super::below_one;
use crate::math;
use crate::math::exact::{exponent, largest, scaled};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// A rectangle as its directions from the origin.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle<T> {
    /// Unit edges, and the normal from the origin towards the plane.
    axes: [Vec3<T>; 3],
    /// Its ends along the edges, and its plane's distance.
    x: [T; 2],
    y: [T; 2],
    d: T,
    solid_angle: T,
    /// Half the solid angles of the strip beyond the left and beyond the right end.
    beyond: [T; 2],
}

/// How far edges may be from perpendicular, as a cosine.
const SKEW: f64 = 1e-3;

impl<T: Real> SphericalRectangle<T> {
    /// About a centre, with its full edges. NaN where these are not perpendicular, or the origin lies in the plane.
    #[inline(always)]
    pub fn new(center: Vec3<T>, edge_u: Vec3<T>, edge_v: Vec3<T>) -> Self {
        let (half, zero) = (T::of(0.5), T::zero());
        // In units of a power of two near the longest component: squares stay in range, and nothing is rounded.
        let size = Lanes::max(largest(center), Lanes::max(largest(edge_u), largest(edge_v)));
        let [c, eu, ev] = [center, edge_u, edge_v].map(|v| v.map(|x| scaled(x, -exponent(size))));
        let (ux, uy) = (eu.normalize(), ev.normalize());
        let normal = ux.cross(uy).normalize();
        let (width, height) = (eu.dot(ux), ev.dot(uy));
        let mut z = normal;
        let mut d = c.dot(z);
        if d < zero {
            (z, d) = (-z, -d);
        }
        let skew = ux.dot(uy).abs() > T::of(SKEW);
        let d = if skew || !(d > zero) { T::NAN } else { d };
        let (cx, cy) = (c.dot(ux), c.dot(uy));
        let (x, y) = ([cx - width * half, cx + width * half], [cy - height * half, cy + height * half]);
        let mut r = SphericalRectangle {
            axes: [ux, uy, z],
            x,
            y,
            d,
            solid_angle: solid_angle(x, width, y, height, d),
            beyond: [zero; 2],
        };
        r.beyond = [r.half_strip(-x[0], height), r.half_strip(x[1], height)];
        r
    }
    #[inline(always)]
    pub fn solid_angle(&self) -> T {
        self.solid_angle
    }
    /// Half the solid angle of the strip y0 < y < y1 beyond x.
    #[inline(always)]
    fn half_strip(&self, x: T, height: T) -> T {
        let [y0, y1] = self.y;
        let d2 = self.d * self.d;
        // √(x² + w²) + x without cancellation.
        let far = |y: T| {
            let w = y * y + d2;
            let r = (x * x + w).sqrt();
            if x < T::zero() { w / (r - x) } else { r + x }
        };
        math::atan2(self.d * height, far(y0) * far(y1) + y0 * y1 + d2)
    }
    /// The rectangle's point as a unit direction.
    #[inline(always)]
    fn towards(&self, x: T, y: T) -> Vec3<T> {
        (self.axes[0] * x + self.axes[1] * y + self.axes[2] * self.d).normalize()
    }
    /// 1 − h and 1 + h of the height h = y / √(y² + w²) in a plane at distance w, both without cancellation.
    #[inline(always)]
    fn complements(y: T, squared: T) -> [T; 2] {
        let r = (y * y + squared).sqrt();
        let (small, large) = (squared / (r * (r + y.abs())), (r + y.abs()) / r);
        if y > T::zero() { [small, large] } else { [large, small] }
    }
    #[inline(always)]
    pub fn sample(&self, u: [T; 2]) -> Vec3<T> {
        let (one, half) = (T::one(), T::of(0.5));
        let [u, v] = super::in_square(u);
        let share = self.solid_angle * half;
        let (l, r) = (self.beyond[0] + u * share, self.beyond[1] + (one - u) * share);
        let x = clamp(self.column(l, r), self.x);
        let squared = x * x + self.d * self.d;
        let ([a0, b0], [a1, b1]) =
            (Self::complements(self.y[0], squared), Self::complements(self.y[1], squared));
        let (a, b) = (a0 * (one - v) + a1 * v, b0 * (one - v) + b1 * v);
        let y = squared.sqrt() * (b - a) * half / (a * b).sqrt();
        self.towards(x, clamp(y, self.y))
    }
    /// x between strips of which half the solid angles are `l` and `r`.
    #[inline(always)]
    fn column(&self, l: T, r: T) -> T {
        let zero = T::zero();
        // The upper end is the farther one, by mirroring.
        let mirrored = self.y[0] + self.y[1] < zero;
        let (y0, y1) = if mirrored { (-self.y[1], -self.y[0]) } else { (self.y[0], self.y[1]) };
        let (r0, r1) = ((y0 * y0 + self.d * self.d).sqrt(), (y1 * y1 + self.d * self.d).sqrt());
        let ((sin0, cos0), (sin1, cos1)) = ((self.d / r0, y0 / r0), (self.d / r1, y1 / r1));
        let ((sl, cl), (sr, cr)) = (math::sin_cos(l), math::sin_cos(r));
        // sin(η1 + l) = sin(η0 - r), whichever adds terms of one sign.
        let sum = |(s, c): (T, T), (so, co): (T, T), near: bool| {
            if near { sin1 * c + cos1 * s } else { sin0 * co - cos0 * so }
        };
        let first = sum((sl, cl), (sr, cr), y0 >= zero || l <= r);
        let second = sum((sr, cr), (sl, cl), y0 >= zero || r <= l);
        // sin(l - r) / 2 over the root of the four sines.
        let sine = sl * cr - cl * sr;
        self.d * sine * T::of(0.5) / ((sl * sr).sqrt() * (first * second).sqrt())
    }
    /// Where a direction meets the plane, in the rectangle's frame; NaN away from it.
    #[inline(always)]
    fn meet(&self, d: Vec3<T>) -> [T; 2] {
        let depth = d.dot(self.axes[2]);
        let scale = if depth > T::zero() { self.d / depth } else { T::NAN };
        [d.dot(self.axes[0]) * scale, d.dot(self.axes[1]) * scale]
    }
    /// The inverse of [`SphericalRectangle::sample`] for unit directions towards the rectangle, in [0, 1).
    #[inline(always)]
    pub fn invert(&self, direction: Vec3<T>) -> [T; 2] {
        let [x, y] = self.meet(direction);
        let (x, y) = (clamp(x, self.x), clamp(y, self.y));
        let height = self.y[1] - self.y[0];
        let u = solid_angle([self.x[0], x], x - self.x[0], self.y, height, self.d) / self.solid_angle;
        let squared = x * x + self.d * self.d;
        let [c, c0, c1] = [y, self.y[0], self.y[1]].map(|y| Self::complements(y, squared));
        // Of the two complements, the smaller has the digits.
        let which = if self.y[0] + self.y[1] > T::zero() { 0 } else { 1 };
        let span = c1[which] - c0[which];
        let v = if span == T::zero() { span } else { (c[which] - c0[which]) / span };
        below_one([u, v])
    }
    /// The density per solid angle of a unit direction: one over the rectangle's towards it, else zero. A few rounding
    /// units about the edges count as inside.
    #[inline(always)]
    pub fn pdf(&self, direction: Vec3<T>) -> T {
        let [x, y] = self.meet(direction);
        let behind = direction.dot(self.axes[2]) <= T::zero();
        // A direction's rounding, where it meets the plane.
        let far = (x * x + y * y + self.d * self.d) / self.d;
        let margin = T::of(4.0) * T::EPSILON * far;
        let beside = |x: T, [low, high]: [T; 2]| x < low - margin || x > high + margin;
        let outside = behind || beside(x, self.x) || beside(y, self.y);
        let even = T::one() / self.solid_angle + (x + y) * T::zero();
        if outside { T::zero() } else { even }
    }
}

#[inline(always)]
fn clamp<T: Real>(x: T, [low, high]: [T; 2]) -> T {
    // NaN stays.
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}

/// Of a rectangle between two ends along each axis, at distance `d`: cut where it passes the foot of the perpendicular,
/// so that no angle between corners of a part is obtuse.
#[inline(always)]
fn solid_angle<T: Real>(x: [T; 2], width: T, y: [T; 2], height: T, d: T) -> T {
    let (columns, rows) = (parts(x, width), parts(y, height));
    let mut sum = T::zero();
    for (x, width) in columns {
        for (y, height) in rows {
            // Also where NaN makes it neither.
            if !(width <= T::zero() || height <= T::zero()) {
                sum += part(x, width, y, height, d);
            }
        }
    }
    sum
}

/// The parts of an interval on either side of zero, as distances from it, with their lengths.
#[inline(always)]
fn parts<T: Real>([low, high]: [T; 2], length: T) -> [([T; 2], T); 2] {
    let zero = T::zero();
    if low < zero && high > zero {
        [([zero, high], high), ([zero, -low], -low)]
    } else if high <= zero {
        [([-high, -low], length), ([zero; 2], zero)]
    } else {
        [([low, high], length), ([zero; 2], zero)]
    }
}

/// Of a rectangle in the first quadrant: two triangles, each by van Oosterom and Strackee; sums of positive terms.
#[inline(always)]
fn part<T: Real>(x: [T; 2], width: T, y: [T; 2], height: T, d: T) -> T {
    let d2 = d * d;
    let r = [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[i, j]| (x[i] * x[i] + y[j] * y[j] + d2).sqrt());
    let [r00, r01, r10, r11] = r;
    let (xx, yy) = (x[0] * x[1], y[0] * y[1]);
    let across = xx + yy + d2;
    let bottom = xx + y[0] * y[0] + d2;
    let top = xx + y[1] * y[1] + d2;
    let left = x[0] * x[0] + yy + d2;
    let right = x[1] * x[1] + yy + d2;
    let volume = d * width * height;
    let first = r00 * r10 * r11 + bottom * r11 + right * r00 + across * r10;
    let second = r00 * r01 * r11 + left * r11 + top * r00 + across * r01;
    T::of(2.0) * (math::atan2(volume, first) + math::atan2(volume, second))
}
