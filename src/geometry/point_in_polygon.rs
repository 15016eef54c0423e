//! Where a point lies with respect to a polygon in the plane: how often its border winds around the point and how often a
//! ray to the right crosses it, or that the point is on the border. Convex or not, self-crossing, with repeated and
//! collinear vertices: sides are told by exact orientations, so all three are exact.
//!
//! M. Shimrat, *Algorithm 112: Position of Point Relative to Polygon*, CACM 5(8), 1962; K. Weiler, *An Incremental Angle
//! Point in Polygon Test*, Graphics Gems IV, 1994; J. R. Shewchuk, *Adaptive Precision Floating-Point Arithmetic and
//! Fast Robust Geometric Predicates*, 1997.

use crate::real::Real;
use robust::{Coord, orient2d};

/// What counts as inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// An odd number of crossings.
    EvenOdd,
    /// A winding number other than zero.
    Winding,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    pub on_border: bool,
    /// Turns of the border around the point, counter-clockwise positive; 0 on the border.
    pub winding: i32,
    /// Crossings of the ray to the right; 0 on the border.
    pub crossings: i32,
}

impl Place {
    #[inline(always)]
    pub fn inside(self, rule: Rule) -> bool {
        match rule {
            Rule::EvenOdd => self.crossings % 2 != 0,
            Rule::Winding => self.winding != 0,
        }
    }
}

/// Counts the edges of a closed chain of vertices as seen from a point. `above` tells whether a vertex is above the
/// point, strictly; `turn` has the sign of the turn from the point along an edge, counter-clockwise positive; `beyond`
/// tells whether the point is outside the rectangle around an edge.
#[inline(always)]
pub(crate) fn count<V: Copy>(
    vertices: impl Iterator<Item = V>,
    last: V,
    above: impl Fn(V) -> bool,
    beyond: impl Fn(V, V) -> bool,
    turn: impl Fn(V, V) -> i32,
) -> Place {
    let mut place = Place::default();
    let mut a = last;
    for b in vertices {
        let (from, to) = (above(a), above(b));
        if from != to || !beyond(a, b) {
            let turn = turn(a, b);
            if turn == 0 && !beyond(a, b) {
                return Place { on_border: true, winding: 0, crossings: 0 };
            }
            // Upwards with the point at the left, or downwards with it at the right: the edge is crossed to the right.
            if from != to && (turn > 0) == to {
                place.winding += if to { 1 } else { -1 };
                place.crossings += 1;
            }
        }
        a = b;
    }
    place
}

/// A polygon with NaN or infinity has no inside, nor has a point of that kind a place.
pub fn point_in_polygon<T: Real>([x, y]: [T; 2], polygon: &[[T; 2]]) -> Place {
    let Some(&last) = polygon.last() else { return Place::default() };
    let finite = |p: &[T; 2]| p[0].is_finite() && p[1].is_finite();
    if !finite(&[x, y]) || !polygon.iter().all(finite) {
        return Place::default();
    }
    let wide = |p: [T; 2]| Coord { x: p[0].to_f64(), y: p[1].to_f64() };
    let at = wide([x, y]);
    count(
        polygon.iter().copied(),
        last,
        |p| p[1] > y,
        |a, b| {
            (a[0] < x && b[0] < x)
                || (a[0] > x && b[0] > x)
                || (a[1] < y && b[1] < y)
                || (a[1] > y && b[1] > y)
        },
        |a, b| {
            let turn = orient2d(wide(a), wide(b), at);
            i32::from(turn > 0.0) - i32::from(turn < 0.0)
        },
    )
}
