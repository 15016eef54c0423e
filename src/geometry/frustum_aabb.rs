//! How an axis-aligned box lies to a frustum: outside if some plane has all of it behind, inside if every plane has all of
//! it in front, by the corners farthest along and against each normal. Rounding is allowed for on both sides, so a box
//! that shows is never called outside, and one that is called inside is so to the last corner. Some large boxes beside an
//! edge of the frustum lie behind no single plane: they are not called outside.
//!
//! U. Assarsson, T. Möller, *Optimized View Frustum Culling Algorithms for Bounding Boxes*, Journal of Graphics Tools 5(1),
//! 2000.

use super::frustum_planes::{Verdict, verdict};
use super::predicate;
use crate::real::Real;

#[inline(never)]
pub fn frustum_aabb<T: Real>(planes: &[T; 24], [low, high]: [[T; 3]; 2]) -> Verdict {
    let (low, high) = (predicate::point(low), predicate::point(high));
    if !(low[0] <= high[0] && low[1] <= high[1] && low[2] <= high[2]) {
        return Verdict { side: 0, plane: -1 };
    }
    verdict(planes, |n, d| {
        let (mut down, mut up, mut magnitude) = (d, d, d.abs());
        for i in 0..3 {
            let (a, b) = (n[i] * low[i], n[i] * high[i]);
            down += a.min(b);
            up += a.max(b);
            magnitude += a.abs().max(b.abs());
        }
        [down, up, magnitude]
    })
}
