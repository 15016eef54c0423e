//! Points in the plane sorted by their angle about a centre, counter-clockwise from the direction of x; without angles:
//! half planes and exact orientations order them. What has one direction goes by distance, the centre itself first.
//!
//! Compare R. L. Graham, *An Efficient Algorithm for Determining the Convex Hull of a Finite Planar Set*, 1972.

use crate::real::Real;
use robust::{Coord, orient2d};
use std::cmp::Ordering;

/// Writes the indices of `points` in order; points with NaN or infinity come last.
pub fn sort_by_angle<T: Real>(points: &[[T; 2]], center: [T; 2], order: &mut [i64]) {
    let [cx, cy] = center;
    let wide = |p: [T; 2]| Coord { x: p[0].to_f64(), y: p[1].to_f64() };
    // The centre, the angles of [0, π), those of [π, 2π), none.
    let class = |[x, y]: [T; 2]| match (x.partial_cmp(&cx), y.partial_cmp(&cy)) {
        _ if !(x.is_finite() && y.is_finite()) => 3,
        (None, _) | (_, None) => 3,
        (Some(Ordering::Equal), Some(Ordering::Equal)) => 0,
        (_, Some(Ordering::Greater)) | (Some(Ordering::Greater), Some(Ordering::Equal)) => 1,
        _ => 2,
    };
    // Of two points in one direction, the nearer one is between the centre and the other.
    let farther = |a: [T; 2], b: [T; 2]| {
        let along = |c: T, a: T, b: T| if a > c { a > b } else { a < b };
        (a[0] != b[0] && along(cx, a[0], b[0])) || (a[1] != b[1] && along(cy, a[1], b[1]))
    };
    order.iter_mut().enumerate().for_each(|(i, o)| *o = i as i64);
    order.sort_unstable_by(|&i, &j| {
        let (a, b) = (points[i as usize], points[j as usize]);
        let half = class(a);
        half.cmp(&class(b)).then_with(|| {
            let turn = if half == 1 || half == 2 { orient2d(wide(center), wide(a), wide(b)) } else { 0.0 };
            match turn {
                x if x > 0.0 => Ordering::Less,
                x if x < 0.0 => Ordering::Greater,
                _ if half == 3 || a == b => i.cmp(&j),
                _ => {
                    if farther(a, b) {
                        Ordering::Greater
                    } else {
                        Ordering::Less
                    }
                }
            }
        })
    });
}
