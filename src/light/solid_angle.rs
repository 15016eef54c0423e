//! Solid angles of shapes in closed form.
//!
//! Of a triangle tan(Ω/2) = a·(b × c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|), the triple product taken from edges,
//! which do not cancel where the triangle is far and small; polygons, rectangles and boxes are sums of triangles. Of a
//! sphere 2π (1 − cos) = 2π sin² / (1 + cos). In double whatever the arrays' precision.
//!
//! A. van Oosterom, J. Strackee, *The solid angle of a plane triangle*, 1983.

use crate::dispatch;
use crate::math;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::vec::Vec3;
use std::f64::consts::PI;

/// Of a triangle seen from the origin, negative where it turns clockwise; 2π within it.
#[inline(always)]
pub fn triangle(a: Vec3<f64>, b: Vec3<f64>, c: Vec3<f64>) -> f64 {
    // To size one: no product leaves the range.
    let largest = [a, b, c].iter().flat_map(|v| v.to_array()).fold(0.0, |m: f64, x| m.max(x.abs()));
    let [a, b, c] = [a, b, c].map(|v| v.map(|x| x / largest));
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    // From the nearest corner, whose edges are the best known.
    let triple = if la <= lb && la <= lc {
        a.dot((b - a).cross(c - a))
    } else if lb <= lc {
        b.dot((c - b).cross(a - b))
    } else {
        c.dot((a - c).cross(b - c))
    };
    -2.0 * math::atan2(triple, la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
}

/// Of a parallelogram about `center` with full edges; positive where its front, along u × v, is seen.
#[inline(always)]
pub fn rectangle(center: Vec3<f64>, u: Vec3<f64>, v: Vec3<f64>) -> f64 {
    let (u, v) = (u * 0.5, v * 0.5);
    let normal = u.cross(v);
    if normal.dot(center) == 0.0 && normal.length_squared() > 0.0 {
        // In its plane, where no triangle has a sign: the point's coordinates along the edges, times what is positive.
        let (across, along) = (v.cross(center).dot(normal), center.cross(u).dot(normal));
        let within = across.abs().max(along.abs()) < normal.length_squared();
        return if within { 2.0 * PI } else { 0.0 };
    }
    let [a, b, c, d] = [center - u - v, center + u - v, center + u + v, center - u + v];
    triangle(a, b, c) + triangle(a, c, d)
}

#[inline(always)]
pub fn sphere(center: Vec3<f64>, radius: f64) -> f64 {
    let distance = center.normalize().dot(center);
    let sin = radius / distance;
    if radius >= 0.0 && sin < 1.0 {
        2.0 * PI * sin * sin / (1.0 + ((1.0 - sin) * (1.0 + sin)).sqrt())
    } else if radius >= 0.0 && !center.x.is_nan() {
        if sin == 1.0 { 2.0 * PI } else { 4.0 * PI }
    } else {
        f64::NAN
    }
}

/// Of an axis-aligned box between two corners; 4π within it, 2π on a face.
#[inline(always)]
pub fn aabb(low: Vec3<f64>, high: Vec3<f64>) -> f64 {
    let size = high - low;
    let middle = low + size * 0.5;
    let [x, y, z] = [Vec3::new(size.x, 0.0, 0.0), Vec3::new(0.0, size.y, 0.0), Vec3::new(0.0, 0.0, size.z)];
    let within = [(low.x, high.x), (low.y, high.y), (low.z, high.z)];
    if within.iter().all(|&(l, h)| l <= 0.0 && h >= 0.0) {
        // Half of it on a face, a quarter on an edge, an eighth on a corner.
        let borders = within.iter().filter(|&&(l, h)| l == 0.0 || h == 0.0).count();
        return 4.0 * PI / (1 << borders) as f64;
    }
    let mut sum = 0.0;
    for (axis, (u, v), (l, h)) in [(x, (y, z), within[0]), (y, (z, x), within[1]), (z, (x, y), within[2])] {
        // The one face of each pair that may be seen: none between both.
        if l > 0.0 {
            sum += rectangle(middle - axis * 0.5, v, u);
        } else if h < 0.0 {
            sum += rectangle(middle + axis * 0.5, u, v);
        }
    }
    let nan = (low + high).dot(Vec3::splat(0.0));
    let inverted = size.x < 0.0 || size.y < 0.0 || size.z < 0.0;
    if inverted { f64::NAN } else { sum.abs() + nan }
}

/// Of one polygon from many points; positive where its front is seen.
pub fn polygon_many<T: Real>(
    watch: &mut dyn Watch,
    corners: &[Vec3<f64>],
    points: &[[T; 3]],
    out: &mut [[T; 1]],
) -> Result<(), Interrupted> {
    let mut normal = Vec3::splat(0.0);
    for pair in corners[1..].windows(2) {
        normal = normal + (pair[0] - corners[0]).cross(pair[1] - corners[0]);
    }
    parallel::for_each(watch, (points, out), 1 << 12, |_, (points, out)| {
        dispatch!(_s => {
            for i in 0..out.len() {
                let point = Vec3::from(points[i].map(T::to_f64));
                let first = corners[0] - point;
                if normal.dot(first) == 0.0 {
                    out[i] = [T::of(if within(corners, normal, point) { 2.0 * PI } else { 0.0 })];
                    continue;
                }
                let mut sum = 0.0;
                for pair in corners[1..].windows(2) {
                    sum += triangle(first, pair[0] - point, pair[1] - point);
                }
                out[i] = [T::of(sum)];
            }
        })
    })
}

/// Whether a polygon goes round a point of its plane, to which no side of it is known.
fn within(corners: &[Vec3<f64>], normal: Vec3<f64>, point: Vec3<f64>) -> bool {
    let n = normal.to_array().map(f64::abs);
    // Along the axis closest to the normal it keeps its shape best.
    let (x, y) = match (n[0] >= n[1] && n[0] >= n[2], n[1] >= n[2]) {
        (true, _) => (1, 2),
        (false, true) => (2, 0),
        (false, false) => (0, 1),
    };
    let flat = |v: Vec3<f64>| {
        let v = (v - point).to_array();
        [v[x], v[y]]
    };
    let mut turns = 0;
    for (i, &corner) in corners.iter().enumerate() {
        let (a, b) = (flat(corner), flat(corners[(i + 1) % corners.len()]));
        let side = a[0] * b[1] - a[1] * b[0];
        if a[1] <= 0.0 && b[1] > 0.0 && side > 0.0 {
            turns += 1;
        } else if a[1] > 0.0 && b[1] <= 0.0 && side < 0.0 {
            turns -= 1;
        }
    }
    turns != 0
}
