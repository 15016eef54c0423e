//! Does a triangle overlap an axis-aligned box? The 13 axes that can separate them: the box's three normals by
//! comparison, the triangle's by the orientation of the two extreme corners, and the nine products of edges as
//! orientations in the three coordinate planes. All are exact, so touching counts, and slivers and triangles without
//! area (segments, points) are as good as others.
//!
//! T. Akenine-Möller, *Fast 3D Triangle-Box Overlap Testing*, Journal of Graphics Tools 6(1), 2001.

use super::predicate::{self, Point};

/// The axes of the coordinate plane across axis `k`.
const ACROSS: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// The number of the first axis that separates them: 0-2 the box's normals, 3 the triangle's, 4 + 3 k + e the product of
/// axis `k` with the edge from vertex `e` to the next. -1 where they overlap, -2 where one does not exist.
pub fn separating_axis(t: [Point; 3], [low, high]: [Point; 2]) -> i32 {
    let exists = (0..3).all(|i| low[i] <= high[i]);
    if !(exists && t.into_iter().all(predicate::finite) && predicate::finite(low) && predicate::finite(high))
    {
        return -2;
    }
    for k in 0..3 {
        let (a, b, c) = (t[0][k], t[1][k], t[2][k]);
        if a.min(b).min(c) > high[k] || a.max(b).max(c) < low[k] {
            return k as i32;
        }
    }
    // Twice the areas of the triangle's shadows: the components of its normal.
    let normal = ACROSS.map(|plane| predicate::turn(plane, t[0], t[1], t[2]));
    for k in 0..3 {
        for e in 0..3 {
            let (p, q) = (t[e], t[(e + 1) % 3]);
            let [i, j] = ACROSS[k];
            // The box's corners farthest to the right and to the left of the edge's line.
            let (mut right, mut left) = (low, low);
            (right[i], left[i]) = if q[j] > p[j] { (high[i], low[i]) } else { (low[i], high[i]) };
            (right[j], left[j]) = if q[i] > p[i] { (low[j], high[j]) } else { (high[j], low[j]) };
            // The third vertex lies to the left where the shadow turns counter-clockwise.
            if (normal[k] >= 0.0 && predicate::turn([i, j], p, q, left) < 0.0)
                || (normal[k] <= 0.0 && predicate::turn([i, j], p, q, right) > 0.0)
            {
                return 4 + 3 * k as i32 + e as i32;
            }
        }
    }
    let against: Point = std::array::from_fn(|i| if normal[i] > 0.0 { low[i] } else { high[i] });
    let along: Point = std::array::from_fn(|i| if normal[i] > 0.0 { high[i] } else { low[i] });
    let [a, b, c] = t;
    if predicate::side(a, b, c, against) > 0.0 || predicate::side(a, b, c, along) < 0.0 { 3 } else { -1 }
}

/// Whether they have a point in common.
pub fn triangle_aabb(t: [Point; 3], b: [Point; 2]) -> bool {
    separating_axis(t, b) == -1
}
