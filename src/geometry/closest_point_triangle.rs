//! The point of a triangle nearest to a given point, its weights, and the feature that it lies on.
//!
//! It is the projection into the plane where that falls inside, else the nearest point of the edges. The four
//! candidates, all of them points of the triangle, are evaluated and the nearest is taken, so slivers, lines and points, whose plane is uncertain or none, are
//! held by their edges: the distance stays right to rounding.
//!
//! C. Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5 (whose regions these are, decided there by signs).

use super::segment_segment::nearest_on_segment;
use crate::math::exact::{all_finite, cross, dot, exponent, largest, scaled};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Closest<T> {
    pub point: Vec3<T>,
    pub distance: T,
    /// Weights of `a`, `b`, `c`.
    pub weights: [T; 3],
    /// 0 the face; 1, 2, 3 the edges ab, bc, ca; 4, 5, 6 the vertices a, b, c; -1 for NaN.
    pub region: i8,
}

/// NaN or infinity give NaN.
#[inline(always)]
pub fn closest_point_triangle<T: Real>(p: Vec3<T>, [a, b, c]: [Vec3<T>; 3]) -> Closest<T> {
    if !(all_finite(p) & all_finite(a) & all_finite(b) & all_finite(c)) {
        let point = Vec3::new(T::NAN, T::NAN, T::NAN);
        return Closest { point, distance: T::NAN, weights: [T::NAN; 3], region: -1 };
    }
    let corners = [a - p, b - p, c - p];
    let e = exponent(corners.iter().fold(T::zero(), |m, &x| Lanes::max(m, largest(x))));
    let corners = corners.map(|x| x * T::exp2i(-e));
    // Edges from the vertices themselves: the point may be far away.
    let edges = [b - a, c - b, a - c].map(|x| x * T::exp2i(-e));

    let (zero, one) = (T::zero(), T::one());
    let (mut weights, mut region, mut best) = ([zero; 3], 0, T::INFINITY);
    for i in 0..3 {
        let t = nearest_on_segment(corners[i], edges[i]);
        let squared = (corners[i] + edges[i] * t).length_squared();
        if squared < best {
            let j = (i + 1) % 3;
            best = squared;
            weights = [zero; 3];
            (weights[i], weights[j]) = (one - t, t);
            region = if t == zero {
                4 + i
            } else if t == one {
                4 + j
            } else {
                1 + i
            } as i8;
        }
    }

    // The projection: areas opposite each vertex, over the whole.
    let n = cross(edges[0], -edges[2]);
    let size = largest(n);
    if size > zero {
        let n = n * T::exp2i(-exponent(size));
        let area = |i: usize| dot(n, cross(corners[i], edges[i]));
        // What rounds to the outside goes to the border: every candidate is a point of the triangle.
        let w = [area(1), area(2), area(0)].map(|x| Lanes::max(x, zero));
        let sum = w[0] + w[1] + w[2];
        if sum > zero {
            let mut w = w.map(|x| x / sum);
            let foot = |w: [T; 3]| corners[0] + edges[0] * w[1] - edges[2] * w[2];
            // Weights of a sliver are off by a rounding over its height: what that moves lies along its edges, and is
            // taken back by projecting onto each.
            for i in 0..3 {
                let (j, squared) = ((i + 1) % 3, edges[i].length_squared());
                if squared > zero {
                    let s = Lanes::max(Lanes::min(-foot(w).dot(edges[i]) / squared, w[i]), -w[j]);
                    (w[i], w[j]) = (w[i] - s, w[j] + s);
                }
            }
            let squared = foot(w).length_squared();
            if squared < best {
                let [a, b, c] = w.map(|x| usize::from(x > zero));
                (weights, region, best) = (w, [0, 4, 5, 1, 6, 3, 2, 0][a + 2 * b + 4 * c], squared);
            }
        }
    }

    // From the heaviest vertex, so that vertices are exact.
    let [u, v, w] = weights;
    let point = if u >= v && u >= w {
        a + ((b - a) * v + (c - a) * w)
    } else if v >= w {
        b + ((a - b) * u + (c - b) * w)
    } else {
        c + ((a - c) * u + (b - c) * v)
    };
    Closest { point, distance: scaled(best.sqrt(), e), weights, region }
}
