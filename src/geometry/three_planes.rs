//! The point where three planes `n · x + d = 0` meet, by Cramer's rule. Its determinants are evaluated exactly where
//! double precision would lose their digits, so the point is right for the coefficients as given, however near the
//! planes come to a common line; how far it moves when the coefficients do is another matter, which the condition tells.
//!
//! R. Goldman, *Intersection of Three Planes*, Graphics Gems, 1990.

use super::predicate::{self, Bounded, Expansion, Number, Point};
use crate::real::Real;

fn determinant<N: Number>(rows: [Point; 3]) -> N {
    let [a, b, c] = rows;
    predicate::dot(
        &predicate::vector::<N>(a),
        &predicate::cross(&predicate::vector(b), &predicate::vector(c)),
    )
}

/// Shewchuk's bounds do not cover what underflows; determinants of unit-sized rows do not.
fn exactly(rows: [Point; 3]) -> f64 {
    predicate::value(determinant::<Bounded>(rows), || determinant::<Expansion>(rows))
}

/// The rows scaled by powers of two to a largest component in [1, 2), and the scale of each.
fn scaled(planes: [[f64; 4]; 3]) -> Option<[[f64; 4]; 3]> {
    let mut out = planes;
    for p in &mut out {
        let largest = p[0].abs().max(p[1].abs()).max(p[2].abs());
        if !(largest >= f64::MIN_POSITIVE && predicate::finite(*p)) {
            return None;
        }
        let scale = f64::from_bits((2046 << 52) - (largest.to_bits() & (0x7ff << 52)));
        for x in p {
            *x *= scale;
        }
    }
    Some(out)
}

/// The point, and the determinant of the unit normals: the volume they span, 1 where they are orthogonal, 0 where no
/// point or no single one exists (the point is NaN then).
#[inline(never)]
pub fn three_planes<T: Real>(planes: [[T; 4]; 3]) -> ([T; 3], T) {
    let (p, volume) =
        solve([predicate::four(planes[0]), predicate::four(planes[1]), predicate::four(planes[2])]);
    ([T::of(p[0]), T::of(p[1]), T::of(p[2])], T::of(volume))
}

fn solve(planes: [[f64; 4]; 3]) -> (Point, f64) {
    let Some(planes) = scaled(planes) else { return ([f64::NAN; 3], f64::NAN) };
    let rows: [Point; 3] = std::array::from_fn(|i| [planes[i][0], planes[i][1], planes[i][2]]);
    let whole = exactly(rows);
    let length = |n: Point| (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    if whole == 0.0 {
        return ([f64::NAN; 3], 0.0);
    }
    let point = std::array::from_fn(|k| {
        let replaced = std::array::from_fn(|i| {
            let mut row = rows[i];
            row[k] = -planes[i][3];
            row
        });
        exactly(replaced) / whole
    });
    (point, whole / (length(rows[0]) * length(rows[1]) * length(rows[2])))
}
