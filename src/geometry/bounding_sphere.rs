//! A ball around points, by two methods:
//!
//! - [`Method::Minimal`]: the smallest. From the ball of a few support points, the farthest point outside joins them, and the
//!   smallest ball of these (at most five) points, found by trying all, takes the place of the last; it grows until no
//!   point is outside. E. Welzl, *Smallest Enclosing Disks*, 1991; B. Gärtner, *Fast and Robust Smallest Enclosing Balls*,
//!   ESA 1999 (the farthest point as pivot).
//! - [`Method::Ritter`]: two passes over the points; some percent larger. J. Ritter, *An Efficient Bounding Sphere*, Graphics
//!   Gems, 1990.
//!
//! Computed in double precision. The radius is then measured from the centre as rounded, so that no point lies outside,
//! neither exactly nor in the working precision.

use super::predicate::Point;
use crate::real::{Lanes, Real};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Minimal,
    Ritter,
}

/// Points relative to the first, scaled by a power of two to the neighbourhood of one: so size and place cost no digits.
pub(super) struct Local {
    pub origin: Point,
    pub scale: f64,
    pub points: Vec<Point>,
}

impl Local {
    /// None if a point is NaN or infinite, or there is none.
    pub fn new<T: Real>(points: &[[T; 3]]) -> Option<Self> {
        let origin = super::predicate::point(*points.first()?);
        let mut largest = 0.0;
        let mut local = Vec::with_capacity(points.len());
        for &p in points {
            let p = super::predicate::point(p);
            let q = [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]];
            if !super::predicate::finite(q) {
                return None;
            }
            largest = q.iter().fold(largest, |m: f64, x| m.max(x.abs()));
            local.push(q);
        }
        // Of magnitudes from 1e-290, which powers of two still reach.
        let scale = if largest > 1e-290 {
            f64::from_bits((2046 << 52) - (largest.to_bits() & (0x7ff << 52)))
        } else {
            1.0
        };
        for q in &mut local {
            for x in q {
                *x *= scale;
            }
        }
        Some(Self { origin, scale, points: local })
    }
    /// Back where the points came from.
    pub fn global<T: Real>(&self, p: Point) -> [T; 3] {
        let at = |k: usize| T::of(self.origin[k] + p[k] / self.scale);
        [at(0), at(1), at(2)]
    }
}

#[inline(always)]
pub(super) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[derive(Clone, Copy)]
struct Ball {
    center: Point,
    squared: f64,
}

/// The smallest ball with all of two to four points on its surface; None where they lie on no sphere, or no one for certain.
fn circumscribed(p: &[Point]) -> Option<Ball> {
    let u = minus(p[1], p[0]);
    let offset = match p.len() {
        2 => u.map(|x| 0.5 * x),
        3 => {
            let v = minus(p[2], p[0]);
            let n = cross(u, v);
            let (uu, vv, nn) = (dot(u, u), dot(v, v), dot(n, n));
            if nn <= 1e-28 * uu * vv {
                return None;
            }
            let (a, b) = (cross(v, n), cross(n, u));
            std::array::from_fn(|k| (uu * a[k] + vv * b[k]) / (2.0 * nn))
        }
        _ => {
            let (v, w) = (minus(p[2], p[0]), minus(p[3], p[0]));
            let (uu, vv, ww) = (dot(u, u), dot(v, v), dot(w, w));
            let det = dot(u, cross(v, w));
            if det * det <= 1e-28 * uu * vv * ww {
                return None;
            }
            let (a, b, c) = (cross(v, w), cross(w, u), cross(u, v));
            std::array::from_fn(|k| (uu * a[k] + vv * b[k] + ww * c[k]) / (2.0 * det))
        }
    };
    let center: Point = std::array::from_fn(|k| p[0][k] + offset[k]);
    Some(Ball { center, squared: dot(offset, offset) })
}

/// The smallest ball of a few points, of which the last lies on its surface, and which of them hold it.
fn smallest(points: &[Point]) -> Option<(Ball, Vec<usize>)> {
    let last = points.len() - 1;
    let mut best: Option<(Ball, Vec<usize>)> = None;
    for chosen in 1..1usize << last {
        if chosen.count_ones() > 3 {
            continue;
        }
        let on: Vec<usize> = (0..last).filter(|i| chosen >> i & 1 == 1).chain([last]).collect();
        let corners: Vec<Point> = on.iter().map(|&i| points[i]).collect();
        let Some(ball) = circumscribed(&corners) else { continue };
        let holds =
            |&p: &Point| dot(minus(p, ball.center), minus(p, ball.center)) <= ball.squared * (1.0 + 1e-12);
        if points.iter().all(holds) && best.as_ref().is_none_or(|(b, _)| ball.squared < b.squared) {
            best = Some((ball, on));
        }
    }
    best
}

fn farthest(points: &[Point], from: Point) -> (usize, f64) {
    let mut best = (0, -1.0);
    for (i, &p) in points.iter().enumerate() {
        let d = minus(p, from);
        let squared = dot(d, d);
        if squared > best.1 {
            best = (i, squared);
        }
    }
    best
}

fn minimal(points: &[Point]) -> (Point, Vec<usize>) {
    let mut ball = Ball { center: points[0], squared: 0.0 };
    let mut support = vec![0];
    loop {
        let (i, squared) = farthest(points, ball.center);
        // What is within rounding of the surface would only make the support turn in circles.
        if squared <= ball.squared * (1.0 + 4e-15) || support.contains(&i) {
            return (ball.center, support);
        }
        support.push(i);
        let candidates: Vec<Point> = support.iter().map(|&i| points[i]).collect();
        match smallest(&candidates) {
            Some((next, on)) if next.squared > ball.squared => {
                support = on.into_iter().map(|k| support[k]).collect();
                ball = next;
            }
            _ => {
                support.pop();
                return (ball.center, support);
            }
        }
    }
}

fn ritter(points: &[Point]) -> Point {
    // Of the pairs of least and greatest along each axis the one farthest apart.
    let mut best = (-1.0, points[0], points[0]);
    for k in 0..3 {
        let (mut low, mut high) = (points[0], points[0]);
        for &p in points {
            low = if p[k] < low[k] { p } else { low };
            high = if p[k] > high[k] { p } else { high };
        }
        let d = minus(high, low);
        if dot(d, d) > best.0 {
            best = (dot(d, d), low, high);
        }
    }
    let (squared, low, high) = best;
    let mut center: Point = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
    let mut radius = 0.5 * squared.sqrt();
    // A point outside grows the ball until it touches, the far side staying where it is.
    for &p in points {
        let d = minus(p, center);
        let far = dot(d, d).sqrt();
        if far > radius {
            radius = 0.5 * (radius + far);
            let share = (far - radius) / far;
            center = std::array::from_fn(|k| center[k] + share * d[k]);
        }
    }
    center
}

/// A ball, and the places of the points that hold the smallest one (-1 beyond their number).
#[derive(Clone, Copy, Debug)]
pub struct Sphere<T> {
    pub center: [T; 3],
    pub radius: T,
    pub support: [i32; 4],
}

pub fn bounding_sphere<T: Real>(points: &[[T; 3]], method: Method) -> Sphere<T> {
    let mut sphere = Sphere { center: [T::NAN; 3], radius: T::NAN, support: [-1; 4] };
    let Some(local) = Local::new(points) else { return sphere };
    let center = match method {
        Method::Minimal => {
            let (center, support) = minimal(&local.points);
            for (slot, i) in sphere.support.iter_mut().zip(support) {
                *slot = i as i32;
            }
            center
        }
        Method::Ritter => ritter(&local.points),
    };
    sphere.center = local.global(center);
    sphere.radius = reach(points, sphere.center, local.scale);
    sphere
}

/// The radius around a centre as rounded: at least the exact distance of the farthest point, and what the working precision
/// computes for it.
fn reach<T: Real>(points: &[[T; 3]], c: [T; 3], scale: f64) -> T {
    let (mut exact, mut rounded) = (0.0, T::zero());
    // By a power of two, so that squares neither overflow nor vanish where the points' own do not.
    for p in points {
        let (mut wide, mut own) = (0.0, T::zero());
        for k in 0..3 {
            let d = (p[k].to_f64() - c[k].to_f64()) * scale;
            wide += d * d;
            let d = p[k] - c[k];
            own += d * d;
        }
        exact = if wide > exact { wide } else { exact };
        rounded = if own > rounded { own } else { rounded };
    }
    // Fewer than four units of double precision on the way.
    let distance = exact.sqrt() / scale * (1.0 + 2.0 * f64::EPSILON);
    let mut radius = T::of(distance);
    if radius.to_f64() < distance {
        radius = radius.next_up();
    }
    let own = Lanes::sqrt(rounded);
    if own.is_finite() && own > radius {
        radius = own;
    }
    while radius.is_finite() && rounded.is_finite() && radius * radius < rounded {
        radius = radius.next_up();
    }
    radius
}
