//! What of a polygon lies within a convex window, half-plane by half-plane: corners inside stay, and where an edge passes
//! the border a corner is made. In the plane the window is a convex polygon; in space, any number of planes whose fronts
//! hold it. Sides are exact, so a corner on the border is inside and makes no second one. New corners are computed from
//! the end nearer to the border, whichever way the edge runs, so that polygons that share an edge share what is left of it.
//!
//! A polygon that is not convex may fall in parts: they stay joined by edges along the border, of no area.
//!
//! I. Sutherland, G. Hodgman, *Reentrant Polygon Clipping*, Communications of the ACM 17(1), 1974.

use super::predicate::{self, Bounded, Expansion, Number};

/// A polygon in the making: rows of coordinates, with attributes behind them that are carried along.
#[derive(Default)]
pub struct Polygon {
    pub rows: Vec<f64>,
    spare: Vec<f64>,
    width: usize,
}

impl Polygon {
    /// Starts anew from rows of `width` numbers; false if one is NaN or infinite.
    pub fn load(&mut self, width: usize, rows: impl Iterator<Item = f64>) -> bool {
        self.width = width;
        self.rows.clear();
        self.rows.extend(rows);
        self.rows.iter().all(|x| x.is_finite())
    }
    /// The number of corners.
    pub fn corners(&self) -> usize {
        self.rows.len() / self.width
    }
    fn row(&self, i: usize) -> &[f64] {
        &self.rows[i * self.width..(i + 1) * self.width]
    }
    /// Keeps what has no negative distance from a border. `mend` puts new corners onto it.
    pub fn clip(&mut self, distance: impl Fn(&[f64]) -> f64, mend: impl Fn(&mut [f64])) {
        let n = self.corners();
        let mut out = std::mem::take(&mut self.spare);
        out.clear();
        if n > 0 {
            let first = distance(self.row(0));
            let mut dp = first;
            for i in 0..n {
                let (p, q) = (self.row(i), self.row((i + 1) % n));
                let dq = if i + 1 == n { first } else { distance(q) };
                if dp >= 0.0 {
                    out.extend_from_slice(p);
                }
                // A segment, which touching leaves, has one edge, not two.
                let again = n == 2 && i == 1;
                if (dp < 0.0) != (dq < 0.0) && dp != 0.0 && dq != 0.0 && !again {
                    // From the end nearer to the border, so that either side of it computes the same.
                    let (a, b, t) = if (dp.abs(), p) < (dq.abs(), q) {
                        (p, q, dp / (dp - dq))
                    } else {
                        (q, p, dq / (dq - dp))
                    };
                    let at = out.len();
                    out.extend(a.iter().zip(b).map(|(&a, &b)| a + t * (b - a)));
                    mend(&mut out[at..]);
                }
                dp = dq;
            }
        }
        self.spare = std::mem::replace(&mut self.rows, out);
    }
}

/// Twice the area of the triangle `a`, `b`, `p`: positive to the left of the line from `a` to `b`.
fn left<N: Number>(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> N {
    let d = |u: f64, v: f64| N::of(u).minus(&N::of(v));
    d(b[0], a[0]).times(&d(p[1], a[1])).minus(&d(b[1], a[1]).times(&d(p[0], a[0])))
}

fn left_of(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> f64 {
    predicate::value(left::<Bounded>(a, b, p), || left::<Expansion>(a, b, p))
}

/// Which way a convex window turns: 1 counter-clockwise, -1 clockwise; None if it turns both ways, more than once, or
/// not at all.
pub fn turning(window: &[[f64; 2]]) -> Option<f64> {
    let n = window.len();
    let mut seen = 0.0;
    // Repeated corners have no direction: each turn is taken at a corner that differs from the one before.
    let distinct: Vec<[f64; 2]> =
        (0..n).filter(|&i| window[i] != window[(i + 1) % n]).map(|i| window[i]).collect();
    let n = distinct.len();
    // Once around, the border runs to the right and back once: a star that winds twice does so twice.
    let ahead = |i: usize| {
        let (p, q) = (distinct[i % n], distinct[(i + 1) % n]);
        p[0] < q[0] || (p[0] == q[0] && p[1] < q[1])
    };
    if (0..n).filter(|&i| ahead(i) != ahead(i + 1)).count() > 2 {
        return None;
    }
    for i in 0..n {
        let turn = left_of(distinct[i], distinct[(i + 1) % n], distinct[(i + 2) % n]);
        if turn * seen < 0.0 {
            return None;
        }
        seen = if turn == 0.0 { seen } else { turn.signum() };
    }
    (seen != 0.0).then_some(seen)
}

/// Keeps what of a polygon in the plane lies in a convex window that turns one way.
pub fn clip_to_window(polygon: &mut Polygon, window: &[[f64; 2]], turning: f64) {
    for (i, &a) in window.iter().enumerate() {
        let b = window[(i + 1) % window.len()];
        if a == b {
            continue;
        }
        polygon.clip(
            |p| turning * left_of(a, b, [p[0], p[1]]),
            |p| {
                // On a border along an axis, exactly.
                for k in 0..2 {
                    if a[k] == b[k] {
                        p[k] = a[k];
                    }
                }
            },
        );
    }
}

/// Keeps what of a polygon in space lies in front of planes `n · x + d = 0`.
pub fn clip_to_planes(polygon: &mut Polygon, planes: &[[f64; 4]]) {
    for &[a, b, c, d] in planes {
        let n = [a, b, c];
        let height = |p: &[f64]| {
            let p = [p[0], p[1], p[2]];
            predicate::value(super::plane_aabb::height::<Bounded>(n, d, p), || {
                super::plane_aabb::height::<Expansion>(n, d, p)
            })
        };
        polygon.clip(height, |_| {});
    }
}
