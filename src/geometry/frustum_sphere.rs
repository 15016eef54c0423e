//! How a ball lies to a frustum: as [`super::frustum_aabb`], by its radius.

use super::frustum_planes::{Verdict, verdict};
use super::predicate;
use crate::real::Real;

#[inline(never)]
pub fn frustum_sphere<T: Real>(planes: &[T; 24], center: [T; 3], radius: T) -> Verdict {
    let (c, r) = (predicate::point(center), radius.to_f64());
    if !(predicate::finite(c) && r >= 0.0) {
        return Verdict { side: 0, plane: -1 };
    }
    verdict(planes, |n, d| {
        let (x, y, z) = (n[0] * c[0], n[1] * c[1], n[2] * c[2]);
        // Planes need not be of unit normals, and one at infinity is not.
        let reach = r * (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        let centre = x + y + z + d;
        [centre - reach, centre + reach, x.abs() + y.abs() + z.abs() + d.abs() + reach]
    })
}
