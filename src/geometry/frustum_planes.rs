//! The six planes of what a projection shows, out of its matrix: `-w ≤ x ≤ w` in clip space is `(row 3 + row 0) · p ≥ 0`
//! and `(row 3 - row 0) · p ≥ 0` before it, and so on. Left, right, bottom, top, near, far, of unit normals that point
//! inwards. A plane at infinity (the far one of an infinite projection) has no normal: it comes as `(0, 0, 0, 1)`, in front
//! of which everything lies.
//!
//! G. Gribb, K. Hartmann, *Fast Extraction of Viewing Frustum Planes from the World-View-Projection Matrix*, 2001.

use super::predicate;
use crate::real::Real;
use crate::transform::projection::Depth;

#[inline(never)]
pub fn frustum_planes<T: Real>(matrix: [T; 16], depth: Depth) -> [T; 24] {
    let row =
        |i: usize| predicate::four([matrix[4 * i], matrix[4 * i + 1], matrix[4 * i + 2], matrix[4 * i + 3]]);
    let (x, y, z, w) = (row(0), row(1), row(2), row(3));
    let plus = |a: [f64; 4]| [w[0] + a[0], w[1] + a[1], w[2] + a[2], w[3] + a[3]];
    let minus = |a: [f64; 4]| [w[0] - a[0], w[1] - a[1], w[2] - a[2], w[3] - a[3]];
    let (near, far) = match depth {
        Depth::Standard => (plus(z), minus(z)),
        Depth::ZeroToOne => (z, minus(z)),
        Depth::Reversed => (minus(z), z),
    };
    let mut out = [T::zero(); 24];
    for (k, plane) in [plus(x), minus(x), plus(y), minus(y), near, far].into_iter().enumerate() {
        for (i, v) in normalized(plane).into_iter().enumerate() {
            out[4 * k + i] = T::of(v);
        }
    }
    out
}

fn normalized([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    let largest = a.abs().max(b.abs()).max(c.abs());
    if largest == 0.0 {
        return [0.0, 0.0, 0.0, if d.is_nan() || d == 0.0 { d } else { d.signum() }];
    }
    // Through the largest component, so that squares neither overflow nor vanish.
    let (x, y, z) = (a / largest, b / largest, c / largest);
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length, d / largest / length]
}

/// How something lies to a frustum.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// 1 inside, -1 outside, 0 neither for certain.
    pub side: i8,
    /// The first plane that it lies wholly behind; -1 if none.
    pub plane: i32,
}

/// `height(n, d)` gives the lowest and the highest height over the plane `n · x + d = 0` of what is tested, and the sum of
/// the magnitudes that make it up. Planes are off by their rounding, and heights by theirs: what is not clear of both is
/// neither outside nor inside.
#[inline(always)]
pub fn verdict<T: Real>(planes: &[T; 24], height: impl Fn([f64; 3], f64) -> [f64; 3]) -> Verdict {
    // A coefficient's rounding to T, twice over, and some 13 of double precision on the way to it and to a height.
    let unit = T::EPSILON.to_f64() + 8.0 * f64::EPSILON;
    let mut inside = true;
    for k in 0..6 {
        let [a, b, c, d] =
            predicate::four([planes[4 * k], planes[4 * k + 1], planes[4 * k + 2], planes[4 * k + 3]]);
        let [low, high, magnitude] = height([a, b, c], d);
        let margin = unit * magnitude + f64::MIN_POSITIVE;
        if high < -margin {
            return Verdict { side: -1, plane: k as i32 };
        }
        // Written so that NaN is neither.
        inside &= low > margin;
    }
    Verdict { side: inside as i8, plane: -1 }
}
