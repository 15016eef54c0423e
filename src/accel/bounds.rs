//! The bounds of a scene.

use crate::real::Real;
use rayon::prelude::*;

/// Lists longer than this are worth more than one thread.
pub const LARGE: usize = 1 << 14;

/// The exact bounds of all triangles; zeros if there are none.
pub fn scene_bounds<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]]) -> [[T; 3]; 2] {
    if faces.is_empty() {
        return [[T::zero(); 3]; 2];
    }
    let empty = || [[T::INFINITY; 3], [-T::INFINITY; 3]];
    let merge = |a: [[T; 3]; 2], b: [[T; 3]; 2]| {
        let low = std::array::from_fn(|k| a[0][k].min(b[0][k]));
        [low, std::array::from_fn(|k| a[1][k].max(b[1][k]))]
    };
    let of = |faces: &[[i32; 3]]| {
        let corners = faces.iter().flatten().map(|&i| positions[i as usize]);
        corners.fold(empty(), |b, p| merge(b, [p, p]))
    };
    faces.par_chunks(LARGE).map(of).reduce(empty, merge)
}
