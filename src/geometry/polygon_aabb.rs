//! Does a simple, flat polygon overlap an axis-aligned box? It does if one of its edges does; if none does, the part of
//! its plane within the box lies wholly inside of the polygon or wholly outside, and a line that meets that part decides
//! by how often the polygon winds around it: the box's diagonal most nearly along the normal. All signs are exact.
//!
//! D. Green, D. Hatch, *Fast Polygon-Cube Intersection Testing*, Graphics Gems V, 1995.

use super::predicate::{self, Number, Point};
use super::triangle_aabb::triangle_aabb;
use std::cmp::Ordering;

/// What of a polygon meets the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meeting {
    None = 0,
    Edge = 1,
    Interior = 2,
}

/// The sum of the areas' vectors of the fan around the first vertex, twice: Newell's normal.
fn normal<N: Number>(p: &[Point]) -> [N; 3] {
    let mut sum = [N::of(0.0), N::of(0.0), N::of(0.0)];
    for pair in p[1..].windows(2) {
        let n = predicate::cross(&predicate::between::<N>(p[0], pair[0]), &predicate::between(p[0], pair[1]));
        sum = std::array::from_fn(|i| sum[i].plus(&n[i]));
    }
    sum
}

fn above<N: Number>(p: &[Point], x: Point) -> N {
    predicate::dot(&normal::<N>(p), &predicate::between(p[0], x))
}

/// Whether a polygon winds around the line `a`-`b`, which meets none of its edges; `c` is any point beside the line.
fn winds(p: &[Point], [a, b]: [Point; 2], c: Point) -> bool {
    // Seen along the line: edges that cross the ray from it away from `c`, one way and the other. A corner on the plane of
    // the line and `c` counts with those behind it, so that each edge crosses or does not.
    let ahead = |x: Point| predicate::side(a, b, c, x) > 0.0;
    let mut turns = 0;
    for i in 0..p.len() {
        let (u, v) = (p[i], p[(i + 1) % p.len()]);
        let (from, to) = (ahead(u), ahead(v));
        if from != to {
            let s = predicate::side(a, b, u, v);
            if from && s > 0.0 {
                turns += 1;
            } else if to && s < 0.0 {
                turns -= 1;
            }
        }
    }
    turns != 0
}

pub fn polygon_aabb(p: &[Point], [low, high]: [Point; 2]) -> Meeting {
    let exists = (0..3).all(|i| low[i] <= high[i]);
    if p.is_empty()
        || !(exists
            && p.iter().all(|&v| predicate::finite(v))
            && predicate::finite(low)
            && predicate::finite(high))
    {
        return Meeting::None;
    }
    for i in 0..p.len() {
        let (a, b) = (p[i], p[(i + 1) % p.len()]);
        if triangle_aabb([a, b, b], [low, high]) {
            return Meeting::Edge;
        }
    }
    // The plane must pass between the corners farthest along and against the normal.
    let (quick, mut exactly) = (normal::<predicate::Bounded>(p), None);
    let n: [Ordering; 3] = std::array::from_fn(|i| {
        predicate::sign(quick[i], || {
            exactly.get_or_insert_with(|| normal::<predicate::Expansion>(p))[i].clone()
        })
    });
    let positive = |i: usize| n[i] == Ordering::Greater;
    let against: Point = std::array::from_fn(|i| if positive(i) { low[i] } else { high[i] });
    let along: Point = std::array::from_fn(|i| if positive(i) { high[i] } else { low[i] });
    let side = |x: Point| predicate::sign(above(p, x), || above(p, x));
    if n == [Ordering::Equal; 3] || side(against) == Ordering::Greater || side(along) == Ordering::Less {
        return Meeting::None;
    }
    // The longest component of the normal: what it points along crosses the plane. A box flat within the plane has no
    // diagonal that does, nor has a point: then a line along that axis through it takes the diagonal's place.
    let size = quick.map(|x| x.value.abs());
    let k = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(0);
    let crosses = (0..3).any(|i| n[i] != Ordering::Equal && along[i] != against[i]);
    let step = |p: Point, i: usize| {
        std::array::from_fn(|j| if i == j { p[j] + 1.0_f64.max(p[j].abs()) } else { p[j] })
    };
    let line = if crosses { [against, along] } else { [low, step(low, k)] };
    // Any point beside the line: along the axis that it runs least along.
    let run: Point = std::array::from_fn(|i| (line[1][i] - line[0][i]).abs());
    let beside = (0..3).min_by(|&i, &j| run[i].total_cmp(&run[j])).unwrap_or(0);
    if winds(p, line, step(line[0], beside)) { Meeting::Interior } else { Meeting::None }
}
