//! An oriented box around points, by three methods:
//!
//! - [`Method::Pca`]: along the principal axes of the points' spread. Cheap, and loose where points are dense: they pull the
//!   axes, though only the outermost matter. S. Gottschalk, *Collision Queries Using Oriented Bounding Boxes*, 2000.
//! - [`Method::Dito`]: along faces and edges of a ditetrahedron of extreme points. T. Larsson, L. Källberg, *Fast Computation
//!   of Tight-Fitting Oriented Bounding Boxes*, Game Engine Gems 2, 2011.
//! - [`Method::Calipers`]: from both of these and the axes, turned about one axis after the other, each time to the smallest
//!   rectangle around the points' shadow (H. Freeman, R. Shapira, 1975: it has a side on a side of the hull), until the
//!   volume shrinks no more. A local minimum in each axis, near the best.
//!
//! Computed in double precision. Extents are then measured from the centre and along the axes as rounded, and widened by
//! what rounding may cost whoever tests a point against them.

use super::bounding_kdop::DIRECTIONS;
use super::bounding_sphere::{Local, cross, dot, minus};
use super::predicate::Point;
use crate::real::Real;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Pca,
    Dito,
    Calipers,
}

type Axes = [Point; 3];
/// Points that are sorted at a time.
const CHUNK: usize = 1 << 14;
const AXES: Axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn unit(v: Point) -> Option<Point> {
    let length = dot(v, v).sqrt();
    (length > 1e-150).then(|| v.map(|x| x / length))
}

/// An orthonormal frame whose first axis is `a` and whose second lies towards `b`, as far as they tell.
fn frame(a: Point, b: Point) -> Axes {
    let Some(a) = unit(a) else { return AXES };
    // Any other direction will do for points in one line: the axis that is least along it.
    let least = (0..3).min_by(|&i, &j| a[i].abs().total_cmp(&a[j].abs())).unwrap_or(0);
    let n = cross(a, b);
    let n = unit(n).filter(|_| dot(n, n) > 1e-24 * dot(b, b)).or_else(|| unit(cross(a, AXES[least])));
    let n = n.unwrap_or(AXES[2]);
    [a, cross(n, a), n]
}

fn extents(points: &[Point], axes: &Axes) -> [[f64; 2]; 3] {
    let mut e = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for &p in points {
        for k in 0..3 {
            let h = dot(p, axes[k]);
            e[k] = [e[k][0].min(h), e[k][1].max(h)];
        }
    }
    e
}

/// The volume of a box, of which flat ones keep their area and lines their length.
fn size(points: &[Point], axes: &Axes) -> f64 {
    extents(points, axes).iter().map(|[low, high]| high - low + 1e-7).product()
}

/// Eigenvectors of the points' covariance, by Jacobi's rotations.
fn principal(points: &[Point]) -> Axes {
    let n = points.len() as f64;
    let mean: Point = std::array::from_fn(|k| points.iter().map(|p| p[k]).sum::<f64>() / n);
    let mut m = [[0.0; 3]; 3];
    for &p in points {
        let d = minus(p, mean);
        for i in 0..3 {
            for j in 0..3 {
                m[i][j] += d[i] * d[j] / n;
            }
        }
    }
    let mut axes = AXES;
    for _ in 0..24 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q].abs() <= 1e-30 {
                continue;
            }
            let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for k in 0..3 {
                (m[k][p], m[k][q]) = (c * m[k][p] - s * m[k][q], s * m[k][p] + c * m[k][q]);
            }
            for k in 0..3 {
                (m[p][k], m[q][k]) = (c * m[p][k] - s * m[q][k], s * m[p][k] + c * m[q][k]);
            }
            let (a, b) = (axes[p], axes[q]);
            axes[p] = std::array::from_fn(|k| c * a[k] - s * b[k]);
            axes[q] = std::array::from_fn(|k| s * a[k] + c * b[k]);
        }
    }
    // Orthonormal again, and right-handed.
    frame(axes[0], axes[1])
}

fn extreme(points: &[Point], height: impl Fn(Point) -> f64) -> Point {
    let mut best = (f64::NEG_INFINITY, points[0]);
    for &p in points {
        let h = height(p);
        if h > best.0 {
            best = (h, p);
        }
    }
    best.1
}

/// The frame of a face or edge of two tetrahedra over a common triangle of extreme points that makes the smallest box.
fn ditetrahedron(points: &[Point], stop: &AtomicBool) -> Axes {
    let mut outer = Vec::with_capacity(14);
    for d in &DIRECTIONS[..7] {
        if stop.load(Ordering::Relaxed) {
            return AXES;
        }
        let d = d.map(f64::from);
        outer.push(extreme(points, |p| -dot(p, d)));
        outer.push(extreme(points, |p| dot(p, d)));
    }
    // The base: the pair farthest apart, and the point farthest from their line.
    let (mut a, mut b, mut widest) = (outer[0], outer[1], -1.0);
    for pair in outer.chunks_exact(2) {
        let d = minus(pair[1], pair[0]);
        if dot(d, d) > widest {
            (a, b, widest) = (pair[0], pair[1], dot(d, d));
        }
    }
    let e = minus(b, a);
    let off = |p: Point| {
        let n = cross(e, minus(p, a));
        dot(n, n)
    };
    let c = extreme(&outer, off);
    let n = cross(e, minus(c, a));
    // The tops, on both sides.
    let (up, down) = (extreme(points, |p| dot(p, n)), extreme(points, |p| -dot(p, n)));
    let mut best = (size(&outer, &AXES), AXES);
    let faces = [[a, b, c], [a, b, up], [b, c, up], [c, a, up], [a, b, down], [b, c, down], [c, a, down]];
    for [p, q, r] in faces {
        for (from, to, other) in [(p, q, r), (q, r, p), (r, p, q)] {
            let axes = frame(minus(to, from), minus(other, from));
            let s = size(&outer, &axes);
            if s < best.0 {
                best = (s, axes);
            }
        }
    }
    // Few points chose it: all decide whether it beats the axes.
    if size(points, &best.1) < size(points, &AXES) { best.1 } else { AXES }
}

/// The convex hull of many points in the plane: of the hulls of some at a time, so that nothing large is sorted.
fn hull(points: impl Iterator<Item = [f64; 2]>, stop: &AtomicBool) -> Vec<[f64; 2]> {
    let (mut outer, mut some) = (Vec::new(), Vec::with_capacity(CHUNK));
    for p in points {
        some.push(p);
        if some.len() == CHUNK {
            outer.append(&mut small_hull(std::mem::take(&mut some)));
            if stop.load(Ordering::Relaxed) {
                return outer;
            }
        }
    }
    outer.append(&mut some);
    small_hull(outer)
}

/// The convex hull, counter-clockwise (A. Andrew's monotone chain, 1979).
fn small_hull(mut p: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    p.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    p.dedup();
    if p.len() < 3 {
        return p;
    }
    let turn =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let mut out: Vec<[f64; 2]> = Vec::new();
    for upper in [false, true] {
        let base = out.len();
        let mut add = |q: [f64; 2]| {
            while out.len() >= base + 2 && turn(out[out.len() - 2], out[out.len() - 1], q) <= 0.0 {
                out.pop();
            }
            out.push(q);
        };
        if upper {
            p.iter().rev().for_each(|&q| add(q));
        } else {
            p.iter().for_each(|&q| add(q));
        }
        // The end is the other half's start.
        out.pop();
    }
    out
}

/// The frame turned about its axis `k` to the smallest rectangle around the points' shadow.
fn turned(points: &[Point], axes: &Axes, k: usize, stop: &AtomicBool) -> Axes {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let corners = hull(points.iter().map(|&p| [dot(p, axes[i]), dot(p, axes[j])]), stop);
    let n = corners.len();
    let mut best = (f64::INFINITY, [1.0, 0.0]);
    // The corners farthest along a side, across it, and against it go round with it.
    let mut reach = [0; 3];
    for s in 0..n {
        let (a, b) = (corners[s], corners[(s + 1) % n]);
        let (x, y) = (b[0] - a[0], b[1] - a[1]);
        let length = (x * x + y * y).sqrt();
        if length == 0.0 {
            continue;
        }
        let d = [x / length, y / length];
        let ways = [d, [-d[1], d[0]], [-d[0], -d[1]]];
        let height = |c: usize, w: [f64; 2]| corners[c % n][0] * w[0] + corners[c % n][1] * w[1];
        let mut from = s + 1;
        for (r, w) in reach.iter_mut().zip(ways) {
            *r = (*r).max(from);
            while height(*r + 1, w) > height(*r, w) && *r < s + n + 1 {
                *r += 1;
            }
            from = *r;
        }
        let along = height(reach[0], ways[0]) + height(reach[2], ways[2]);
        let across = height(reach[1], ways[1]) - height(s, ways[1]);
        let area = (along + 1e-7) * (across + 1e-7);
        if area < best.0 {
            best = (area, d);
        }
    }
    let [c, s] = best.1;
    let mut out = *axes;
    out[i] = std::array::from_fn(|m| c * axes[i][m] + s * axes[j][m]);
    out[j] = std::array::from_fn(|m| c * axes[j][m] - s * axes[i][m]);
    out
}

fn calipers(points: &[Point], stop: &AtomicBool) -> Axes {
    let mut best = (f64::INFINITY, AXES);
    let starts: [fn(&[Point], &AtomicBool) -> Axes; 3] = [|_, _| AXES, |p, _| principal(p), ditetrahedron];
    for start in starts {
        let start = start(points, stop);
        if stop.load(Ordering::Relaxed) {
            return AXES;
        }
        let (mut axes, mut last) = (start, size(points, &start));
        // Each round turns about all three axes.
        for _ in 0..20 {
            for k in 0..3 {
                let next = turned(points, &axes, k, stop);
                if stop.load(Ordering::Relaxed) {
                    return AXES;
                }
                if size(points, &next) < size(points, &axes) {
                    axes = next;
                }
            }
            let now = size(points, &axes);
            let settled = now > last * (1.0 - 1e-6);
            last = now;
            if settled {
                break;
            }
        }
        if last < best.0 {
            best = (last, axes);
        }
    }
    frame(best.1[0], best.1[1])
}

/// Centre, axes as rows, half extents; NaN where a point is NaN or infinite, or there is none. Returns soon, with any box,
/// once `stop` is set.
pub fn bounding_obb<T: Real>(
    points: &[[T; 3]],
    method: Method,
    stop: &AtomicBool,
) -> ([T; 3], [T; 9], [T; 3]) {
    let Some(local) = Local::new(points) else { return ([T::NAN; 3], [T::NAN; 9], [T::NAN; 3]) };
    let axes = match method {
        Method::Pca => principal(&local.points),
        Method::Dito => ditetrahedron(&local.points, stop),
        Method::Calipers => calipers(&local.points, stop),
    };
    let rows: [T; 9] = std::array::from_fn(|i| T::of(axes[i / 3][i % 3]));
    let e = extents(&local.points, &axes);
    let middle: Point = std::array::from_fn(|m| (0..3).map(|k| 0.5 * (e[k][0] + e[k][1]) * axes[k][m]).sum());
    let center = local.global::<T>(middle);
    // From the centre and along the axes as rounded.
    let c: Point = super::predicate::point(center);
    let axes: Axes = std::array::from_fn(|k| std::array::from_fn(|m| rows[3 * k + m].to_f64()));
    let (mut half, mut far) = ([0.0; 3], 0.0);
    for &p in points {
        let d = minus(super::predicate::point(p), c);
        for k in 0..3 {
            half[k] = dot(d, axes[k]).abs().max(half[k]);
        }
        far = (d[0].abs() + d[1].abs() + d[2].abs()).max(far);
    }
    // Differences and products of a test in the working precision, and axes that are not quite orthonormal.
    let margin = 5.0 * T::EPSILON.to_f64() * far;
    (center, rows, half.map(|h| T::of(h + margin)))
}
