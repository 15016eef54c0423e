//! Does a ball overlap a triangle? It does if a vertex, the inner part of an edge, or the inner part of the face is within
//! reach; each condition is the sign of a polynomial without division, decided exactly. Touching counts, and triangles
//! without area are their edges.

use super::predicate::{self, Number, Point};
use std::cmp::Ordering::{Greater, Less};

/// Beyond the radius from a point.
#[inline(always)]
fn beyond_point<N: Number>(c: Point, r: f64, a: Point) -> N {
    let d = predicate::between::<N>(a, c);
    predicate::dot(&d, &d).minus(&N::of(r).times(&N::of(r)))
}

/// How far `c` lies past `a` in the direction from `a` to `b`.
#[inline(always)]
fn past<N: Number>(c: Point, a: Point, b: Point) -> N {
    predicate::dot(&predicate::between::<N>(a, c), &predicate::between(a, b))
}

/// Beyond the radius from the line through `a` and `b`.
#[inline(always)]
fn beyond_line<N: Number>(c: Point, r: f64, a: Point, b: Point) -> N {
    let (d, e) = (predicate::between::<N>(a, c), predicate::between::<N>(a, b));
    let n = predicate::cross(&d, &e);
    let reach = N::of(r).times(&N::of(r)).times(&predicate::dot(&e, &e));
    predicate::dot(&n, &n).minus(&reach)
}

#[inline(always)]
fn normal<N: Number>([a, b, c]: [Point; 3]) -> [N; 3] {
    predicate::cross(&predicate::between(a, b), &predicate::between(a, c))
}

/// Beyond the radius from the triangle's plane.
#[inline(always)]
fn beyond_plane<N: Number>(c: Point, r: f64, t: [Point; 3]) -> N {
    let n = normal::<N>(t);
    let height = predicate::dot(&n, &predicate::between(t[0], c));
    let reach = N::of(r).times(&N::of(r)).times(&predicate::dot(&n, &n));
    height.times(&height).minus(&reach)
}

/// How far `c` lies inside of the edge from vertex `k` to the next, in the triangle's plane.
#[inline(always)]
fn inside<N: Number>(c: Point, t: [Point; 3], k: usize) -> N {
    let (a, b) = (t[k], t[(k + 1) % 3]);
    predicate::dot(&normal::<N>(t), &predicate::cross(&predicate::between(a, b), &predicate::between(a, c)))
}

pub fn sphere_triangle(c: Point, r: f64, t: [Point; 3]) -> bool {
    if !(predicate::finite(c) && r >= 0.0 && t.into_iter().all(predicate::finite)) {
        return false;
    }
    if r == f64::INFINITY {
        return true;
    }
    // Beyond reach along an axis: since rounding is monotone, a difference of at most `r` does not round above it.
    let far = (0..3).any(|i| {
        let [a, b, d] = t.map(|p| p[i] - c[i]);
        a.min(b).min(d) > r || a.max(b).max(d) < -r
    });
    if far {
        return false;
    }
    if t.iter().any(|&a| predicate::sign(beyond_point(c, r, a), || beyond_point(c, r, a)) != Greater) {
        return true;
    }
    for k in 0..3 {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        if a != b
            && predicate::sign(past(c, a, b), || past(c, a, b)) != Less
            && predicate::sign(past(c, b, a), || past(c, b, a)) != Less
            && predicate::sign(beyond_line(c, r, a, b), || beyond_line(c, r, a, b)) != Greater
        {
            return true;
        }
    }
    let flat = (0..3).all(|k| predicate::turn([k, (k + 1) % 3], t[0], t[1], t[2]) == 0.0);
    !flat
        && (0..3).all(|k| predicate::sign(inside(c, t, k), || inside(c, t, k)) != Less)
        && predicate::sign(beyond_plane(c, r, t), || beyond_plane(c, r, t)) != Greater
}
