//! How an oriented box lies to a frustum: as [`super::frustum_aabb`], by its reach along each normal.

use super::frustum_planes::{Verdict, verdict};
use super::plane_obb::Obb;
use crate::real::Real;

#[inline(never)]
pub fn frustum_obb<T: Real>(planes: &[T; 24], b: &Obb) -> Verdict {
    if !b.exists() {
        return Verdict { side: 0, plane: -1 };
    }
    verdict(planes, |n, d| {
        let (mut centre, mut reach, mut magnitude) = (d, 0.0, d.abs());
        for i in 0..3 {
            centre += n[i] * b.center[i];
            magnitude += (n[i] * b.center[i]).abs();
            let (a, h) = (b.axes[i], b.half[i]);
            let (x, y, z) = (n[0] * a[0], n[1] * a[1], n[2] * a[2]);
            reach += h * (x + y + z).abs();
            magnitude += h * (x.abs() + y.abs() + z.abs());
        }
        [centre - reach, centre + reach, magnitude]
    })
}
