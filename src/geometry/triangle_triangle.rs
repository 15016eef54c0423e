//! Do two triangles have a point in common? They do if an edge of one meets the other; whether it does is a matter of
//! orientations, all exact: of the edge's ends to the triangle's plane, and of its line to the triangle's edges; in one
//! plane, of the shadows in the coordinate plane that keeps most of it. Triangles without area count as their edges, so
//! every input has its exact answer. Touching counts.
//!
//! T. Möller, *A Fast Triangle-Triangle Intersection Test*, Journal of Graphics Tools 2(2), 1997 (two intervals on the
//! planes' common line); P. Guigue, O. Devillers, *Fast and Robust Triangle-Triangle Overlap Test Using Orientation
//! Predicates*, Journal of Graphics Tools 8(1), 2003 (orientations alone decide).

use super::predicate::{self, Bounded, Expansion, Number, Point};

type Triangle = [Point; 3];

const PLANES: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

fn boxes_touch(a: &[Point], b: &[Point]) -> bool {
    for k in 0..3 {
        let (mut al, mut ah, mut bl, mut bh) = (a[0][k], a[0][k], b[0][k], b[0][k]);
        for p in &a[1..] {
            (al, ah) = (al.min(p[k]), ah.max(p[k]));
        }
        for p in &b[1..] {
            (bl, bh) = (bl.min(p[k]), bh.max(p[k]));
        }
        if al > bh || bl > ah {
            return false;
        }
    }
    true
}

/// A coordinate plane onto which three points do not fall in one line; None if they are in one.
fn shadow([a, b, c]: Triangle) -> Option<[usize; 2]> {
    PLANES.into_iter().find(|&plane| predicate::turn(plane, a, b, c) != 0.0)
}

/// No two of opposite sign.
fn one_side(s: [f64; 3]) -> bool {
    let [a, b, c] = s;
    !((a > 0.0 || b > 0.0 || c > 0.0) && (a < 0.0 || b < 0.0 || c < 0.0))
}

/// Whether a segment meets a triangle with area in whose plane it lies, both seen in a coordinate plane.
fn segment_in_plane(plane: [usize; 2], [p, q]: [Point; 2], t: Triangle) -> bool {
    let turning = predicate::turn(plane, t[0], t[1], t[2]);
    let outside = |k: usize| {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        let beyond = |x: Point| predicate::turn(plane, a, b, x) * turning.signum() < 0.0;
        beyond(p) && beyond(q)
    };
    let side = t.map(|v| predicate::turn(plane, p, q, v));
    let apart = side.iter().all(|&s| s > 0.0) || side.iter().all(|&s| s < 0.0);
    !apart && !(0..3).any(outside)
}

/// Whether two segments have a point in common.
fn segments_meet([p, q]: [Point; 2], [a, b]: [Point; 2]) -> bool {
    if !boxes_touch(&[p, q], &[a, b]) || predicate::side(p, q, a, b) != 0.0 {
        return false;
    }
    let triples = [[p, q, a], [p, q, b], [a, b, p], [a, b, q]];
    match triples.into_iter().find_map(shadow) {
        // All on one line, where boxes that touch are segments that do.
        None => true,
        Some(plane) => {
            let turn = |a, b, c| predicate::turn(plane, a, b, c);
            let apart = |x: f64, y: f64| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
            !apart(turn(p, q, a), turn(p, q, b)) && !apart(turn(a, b, p), turn(a, b, q))
        }
    }
}

/// Whether the segment `p`-`q` meets the triangle `t`; `flat` says that `t` has no area; `sp`, `sq` are its ends' sides.
fn segment_meets([p, q]: [Point; 2], [sp, sq]: [f64; 2], t: Triangle, plane: Option<[usize; 2]>) -> bool {
    let [a, b, c] = t;
    let Some(plane) = plane else {
        return [[a, b], [b, c], [c, a]].into_iter().any(|e| segments_meet([p, q], e));
    };
    if (sp > 0.0 && sq > 0.0) || (sp < 0.0 && sq < 0.0) {
        return false;
    }
    if sp == 0.0 && sq == 0.0 {
        return segment_in_plane(plane, [p, q], t);
    }
    one_side([predicate::side(p, q, a, b), predicate::side(p, q, b, c), predicate::side(p, q, c, a)])
}

fn volume<N: Number>([a, b, c]: Triangle, d: Point) -> N {
    let n = predicate::cross(&predicate::between::<N>(a, b), &predicate::between(a, c));
    predicate::dot(&n, &predicate::between(a, d))
}

/// Where the line of `p` and `q` crosses the plane of `t`.
fn crossing([p, q]: [Point; 2], t: Triangle) -> Point {
    let height = |x: Point| predicate::value(volume::<Bounded>(t, x), || volume::<Expansion>(t, x));
    let (hp, hq) = (height(p), height(q));
    let s = hp / (hp - hq);
    // From the nearer end, so that an end in the plane is itself.
    if s < 0.5 {
        std::array::from_fn(|i| p[i] + s * (q[i] - p[i]))
    } else {
        let s = hq / (hp - hq);
        std::array::from_fn(|i| q[i] + s * (q[i] - p[i]))
    }
}

/// How two triangles meet.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    pub overlap: bool,
    /// In one plane, or one of them has no area.
    pub coplanar: bool,
    /// The common segment where they overlap in different planes (its ends are one where they touch in a point), else NaN.
    pub segment: [Point; 2],
}

/// `wanted`: whether the segment is asked for.
pub fn triangle_triangle(a: Triangle, b: Triangle, wanted: bool) -> Meeting {
    let nothing = [[f64::NAN; 3]; 2];
    let proper = a.iter().all(|&p| predicate::finite(p)) && b.iter().all(|&p| predicate::finite(p));
    let mut out = Meeting { overlap: false, coplanar: false, segment: nothing };
    if !proper || (!boxes_touch(&a, &b) && !wanted) {
        return out;
    }
    let side = |t: Triangle, p: Point| predicate::side(t[0], t[1], t[2], p);
    let sides = |t: Triangle, of: Triangle| [side(t, of[0]), side(t, of[1]), side(t, of[2])];
    let apart = |[x, y, z]: [f64; 3]| (x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0);
    let sa = sides(b, a);
    if apart(sa) {
        return out;
    }
    let sb = sides(a, b);
    out.coplanar = sa == [0.0; 3] || sb == [0.0; 3];
    if apart(sb) || !boxes_touch(&a, &b) {
        return out;
    }
    let shadows = [shadow(a), shadow(b)];
    // Ends of the segment: an edge of one triangle in the other. The two farthest apart span it.
    let mut ends = [[0.0; 3]; 6];
    let mut found = 0;
    for (t, s, other, plane) in [(a, sa, b, shadows[1]), (b, sb, a, shadows[0])] {
        for i in 0..3 {
            let j = (i + 1) % 3;
            if segment_meets([t[i], t[j]], [s[i], s[j]], other, plane) {
                out.overlap = true;
                if !wanted || out.coplanar {
                    return out;
                }
                // An edge within the other's plane ends where the other's edges cross this triangle's plane, or at
                // vertices, which its neighbouring edges bring.
                if s[i] != 0.0 || s[j] != 0.0 {
                    ends[found] = crossing([t[i], t[j]], other);
                    found += 1;
                }
            }
        }
    }
    if out.overlap {
        out.segment = farthest(&ends[..found]);
    }
    out
}

fn farthest(points: &[Point]) -> [Point; 2] {
    let mut best = (f64::NEG_INFINITY, [[f64::NAN; 3]; 2]);
    for (i, &p) in points.iter().enumerate() {
        for &q in &points[i..] {
            let d: f64 = (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum();
            if d > best.0 {
                best = (d, [p, q]);
            }
        }
    }
    best.1
}
