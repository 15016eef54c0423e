//! Barycentric coordinates of points in triangles in space: the areas opposite each vertex over the whole, taken in
//! the triangle's plane, into which points off it are projected.
//!
//! Degenerate triangles (zero area) have none: the result is NaN.
//!
//! C. Ericson, *Real-Time Collision Detection*, 2005, section 3.4.

use crate::real::Real;
use crate::vec::Vec3;

/// Coordinates `(u, v, w)` of `p`, which weigh `a`, `b`, `c` and sum to one.
#[inline(always)]
pub fn barycentric<T: Real>(p: Vec3<T>, a: Vec3<T>, b: Vec3<T>, c: Vec3<T>) -> Vec3<T> {
    let n = (b - a).cross(c - a);
    let area = n.length_squared();
    let v = n.dot((c - p).cross(a - p)) / area;
    let w = n.dot((a - p).cross(b - p)) / area;
    // Through the area as well, rather than 1 - v - w, so that no vertex is favoured.
    let u = n.dot((b - p).cross(c - p)) / area;
    Vec3::new(u, v, w)
}
