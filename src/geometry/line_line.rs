//! Where two lines come nearest to each other: the parameters are determinants over the squared cross product of the
//! directions. The cross product is right to a few units of the last place, however near to parallel the lines are, so
//! that they are parallel only if they are.
//!
//! R. Goldman, *Intersection of Two Lines in Three-Space*, Graphics Gems, 1990.

use crate::math::exact::{all_finite, cross, dot, exponent, largest, scaled};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// The nearest points of two lines, as parameters and as points.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<T> {
    pub s: T,
    pub t: T,
    pub distance: T,
    pub points: [Vec3<T>; 2],
    pub parallel: bool,
}

impl<T: Real> Nearest<T> {
    pub const NAN: Self = {
        let point = Vec3::new(T::NAN, T::NAN, T::NAN);
        Self { s: T::NAN, t: T::NAN, distance: T::NAN, points: [point; 2], parallel: false }
    };
}

/// Of parallel lines, the first one's origin and the point across. NaN or infinity, or a direction of no length, give
/// NaN.
#[inline(always)]
pub fn line_line<T: Real>([o1, d1]: [Vec3<T>; 2], [o2, d2]: [Vec3<T>; 2]) -> Nearest<T> {
    let proper = all_finite(o1) & all_finite(d1) & all_finite(o2) & all_finite(d2);
    let (l1, l2) = (largest(d1), largest(d2));
    if !proper || l1 < T::MIN_POSITIVE || l2 < T::MIN_POSITIVE {
        return Nearest::NAN;
    }
    // Powers of two, so that no digit is lost.
    let w = o2 - o1;
    let (e1, e2, ew) = (exponent(l1), exponent(l2), exponent(largest(w)));
    let (a, b, w) = (d1 * T::exp2i(-e1), d2 * T::exp2i(-e2), w * T::exp2i(-ew));
    let n = cross(a, b);
    let size = largest(n);
    let parallel = size == T::zero();
    let (s, t, distance) = if parallel {
        let t = -dot(w, b) / b.dot(b);
        (T::zero(), t, (w + b * t).length())
    } else {
        // The cross product of almost parallel lines is short: its square could vanish.
        let en = exponent(size);
        let n = n * T::exp2i(-en);
        let squared = n.dot(n);
        let s = scaled(dot(n, cross(w, b)) / squared, -en);
        let t = scaled(dot(n, cross(w, a)) / squared, -en);
        (s, t, dot(n, w).abs() / squared.sqrt())
    };
    let (s, t) = (scaled(s, ew - e1), scaled(t, ew - e2));
    let points = [o1 + d1 * s, o2 + d2 * t];
    Nearest { s, t, distance: scaled(Lanes::abs(distance), ew), points, parallel }
}
