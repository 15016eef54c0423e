//! Barycentric coordinates of points in triangles in space: the areas opposite each vertex over the whole, taken in
//! the triangle's plane, into which points off it are projected.
//!
//! Degenerate triangles (zero area) have none: the result is NaN.
//!
//! C. Ericson, *Real-Time Collision Detection*, 2005, section 3.4.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
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

/// [`barycentric`] over arrays of equal length.
pub fn barycentric_many<T: Real>(
    watch: &mut dyn Watch,
    points: &[[T; 3]],
    triangles: [&[[T; 3]]; 3],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    let [a, b, c] = triangles;
    parallel::for_each(
        watch,
        (points, a, b, c, out),
        1 << 14,
        |_, (p, a, b, c, out)| dispatch!(_s => body(p, a, b, c, out)),
    )
}

#[inline(always)]
fn body<T: Real>(p: &[[T; 3]], a: &[[T; 3]], b: &[[T; 3]], c: &[[T; 3]], out: &mut [[T; 3]]) {
    for i in 0..out.len() {
        out[i] = barycentric(p[i].into(), a[i].into(), b[i].into(), c[i].into()).to_array();
    }
}
