//! Do two oriented boxes overlap? The separating axes of two parallelepipeds: three face normals of each, and the nine
//! cross products of their edges. Each is the cross product of two edges, and the question on each, whether the centres
//! are farther apart than the boxes reach, is the sign of a polynomial, decided exactly. So near-parallel edges, whose
//! product is all rounding in floating point, neither separate boxes that touch nor unite boxes that do not; exactly
//! parallel ones have no product, and ask nothing. The boxes are taken as given, be their axes orthonormal or not.
//!
//! S. Gottschalk, M. Lin, D. Manocha, *OBBTree: A Hierarchical Structure for Rapid Interference Detection*, SIGGRAPH 1996.

use super::plane_obb::Obb;
use super::predicate::{self, Bounded, Expansion, Number, Point};
use std::cmp::Ordering;

/// The edges whose product is the axis of each number: of A (0-2) or of B (3-5).
const AXES: [[usize; 2]; 15] = [
    [1, 2],
    [2, 0],
    [0, 1],
    [4, 5],
    [5, 3],
    [3, 4],
    [0, 3],
    [0, 4],
    [0, 5],
    [1, 3],
    [1, 4],
    [1, 5],
    [2, 3],
    [2, 4],
    [2, 5],
];

fn edge(a: &Obb, b: &Obb, i: usize) -> Point {
    if i < 3 { a.axes[i] } else { b.axes[i - 3] }
}

fn axis<N: Number>(a: &Obb, b: &Obb, k: usize) -> [N; 3] {
    let [i, j] = AXES[k];
    predicate::cross(&predicate::vector(edge(a, b, i)), &predicate::vector(edge(a, b, j)))
}

/// The gap between the boxes' shadows on an axis, in units of its length.
fn gap<N: Number>(a: &Obb, b: &Obb, n: &[N; 3]) -> N {
    let apart = predicate::dot(n, &predicate::between(a.center, b.center)).abs();
    apart.minus(&a.reach(n)).minus(&b.reach(n))
}

/// Sums of absolute components, which bound products.
fn size(v: Point) -> f64 {
    v[0].abs() + v[1].abs() + v[2].abs()
}

/// What separates two boxes, settled by plain arithmetic where a bound of its rounding allows.
struct Pair<'a> {
    a: &'a Obb,
    b: &'a Obb,
    /// From centre to centre.
    apart: Point,
    /// Bounds all products of a unit axis with what it is tested on.
    extent: f64,
}

impl<'a> Pair<'a> {
    fn new(a: &'a Obb, b: &'a Obb) -> Self {
        let (c, d) = (a.center, b.center);
        let apart = [d[0] - c[0], d[1] - c[1], d[2] - c[2]];
        let part = |o: &Obb, i: usize| o.half[i] * size(o.axes[i]);
        let reach = |o: &Obb| part(o, 0) + part(o, 1) + part(o, 2);
        Self { a, b, apart, extent: size(apart) + reach(a) + reach(b) }
    }
    fn separates(&self, k: usize) -> bool {
        let (a, b) = (self.a, self.b);
        let (u, v) = (edge(a, b, AXES[k][0]), edge(a, b, AXES[k][1]));
        // Of axes that are one and the same, as boxes of one frame have them.
        if u == v || (u[0] == -v[0] && u[1] == -v[1] && u[2] == -v[2]) {
            return false;
        }
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let dot = |e: Point| (n[0] * e[0] + n[1] * e[1] + n[2] * e[2]).abs();
        let reach =
            |o: &Obb| o.half[0] * dot(o.axes[0]) + o.half[1] * dot(o.axes[1]) + o.half[2] * dot(o.axes[2]);
        let gap = dot(self.apart) - (reach(a) + reach(b));
        // Fewer than 16 roundings on the way of any term, each of half an epsilon, and one for the bound itself.
        let error = 9.0 * f64::EPSILON * size(u) * size(v) * self.extent;
        if gap.abs() > error && error > 1e-290 { gap > 0.0 } else { self.separates_exactly(k) }
    }
    #[cold]
    #[inline(never)]
    fn separates_exactly(&self, k: usize) -> bool {
        let n = axis::<Expansion>(self.a, self.b, k);
        let parallel = n.iter().all(|x| x.sign() == Ordering::Equal);
        !parallel && gap(self.a, self.b, &n).sign() == Ordering::Greater
    }
}

/// Whether two boxes have a point in common; false where one does not exist.
pub fn obb_obb(a: &Obb, b: &Obb) -> bool {
    let pair = Pair::new(a, b);
    a.exists() && b.exists() && !(0..15).any(|k| pair.separates(k))
}

/// The axis of the widest gap.
#[derive(Clone, Copy, Debug)]
pub struct Separation {
    pub overlap: bool,
    /// 0-2: the faces of A; 3-5: of B; 6 + 3 i + j: edge i of A with edge j of B. -1 where the boxes overlap.
    pub axis: i32,
    /// How far apart along it; minus the least depth where the boxes overlap.
    pub gap: f64,
    /// The unit axis, from A to B.
    pub direction: Point,
}

pub fn separation(a: &Obb, b: &Obb) -> Separation {
    if !(a.exists() && b.exists()) {
        return Separation { overlap: false, axis: -1, gap: f64::NAN, direction: [f64::NAN; 3] };
    }
    let pair = Pair::new(a, b);
    let mut widest = (-1, f64::NEG_INFINITY, [0.0; 3]);
    let mut overlap = true;
    for k in 0..15 {
        let n = axis::<Bounded>(a, b, k);
        let apart = pair.separates(k);
        // Directions of near-parallel edges come out of the exact product; parallel ones have none.
        let direction = if n.iter().any(|x| x.error > 1e-10 * x.value.abs()) {
            axis::<Expansion>(a, b, k).map(|x| x.value())
        } else {
            n.map(|x| x.value)
        };
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            continue;
        }
        let unit = direction.map(|x| x / length);
        let width = gap(a, b, &predicate::vector::<Bounded>(unit)).value;
        // Where rounding of the gap contradicts the sign, its size is below rounding.
        let width = if apart { width.max(f64::MIN_POSITIVE) } else { width.min(0.0) };
        overlap &= !apart;
        if width > widest.1 {
            let along: f64 = (0..3).map(|i| unit[i] * (b.center[i] - a.center[i])).sum();
            widest = (k as i32, width, if along < 0.0 { unit.map(|x| -x) } else { unit });
        }
    }
    let (axis, gap, direction) = widest;
    Separation { overlap, axis: if overlap { -1 } else { axis }, gap, direction }
}
