//! The unit square onto the unit disk, areas in constant proportion.
//!
//! Concentric squares become concentric circles, which keeps neighbours together and strata compact; or the polar map
//! (√u, 2πv), which tears the disk along a radius. Both reach the rim at one end of their domain and never leave
//! the disk by more than rounding.
//!
//! P. Shirley, K. Chiu, *A low distortion map between disk and square*, 1997.

use super::{below_one, in_square};
use crate::math;
use crate::real::{Lanes, Real};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Concentric,
    Polar,
}

/// The point of the disk, and its distance from the rim as `(1 - r)(1 + r)` before rounding can spoil it.
#[inline(always)]
pub(super) fn point_and_depth<V: Lanes>(u: [V; 2], method: Method) -> ([V; 2], V) {
    let (half, one, two) = (u[0].num(0.5), u[0].num(1.0), u[0].num(2.0));
    let u = in_square(u);
    match method {
        Method::Concentric => {
            // Distances from the square's border, exact near it; radius with a sign, so that a wedge and its mirror
            // image share the formula.
            let border = [
                two * V::select(half.less(u[0]), one - u[0], u[0]),
                two * V::select(half.less(u[1]), one - u[1], u[1]),
            ];
            let [a, b] = [two * u[0] - one, two * u[1] - one];
            // Choices, not branches: which wedge is chance.
            let wide = !border[1].less_eq(border[0]);
            let (r, other) = (V::select(wide, a, b), V::select(wide, b, a));
            let depth = V::select(wide, border[0], border[1]);
            let ratio = other / V::select(r.equal(r.num(0.0)), one, r);
            let (sin, cos) = math::sin_cos_octant(r.num(std::f64::consts::FRAC_PI_4) * ratio);
            let point = [r * V::select(wide, cos, sin), r * V::select(wide, sin, cos)];
            (point, depth * (two - depth))
        }
        Method::Polar => {
            // Counted from the nearer end of the turn: small angles round less.
            let turn = V::select(half.less(u[1]), u[1] - one, u[1]);
            let (sin, cos) = math::sin_cos_turns(turn);
            let r = u[0].sqrt();
            ([r * cos, r * sin], one - u[0])
        }
    }
}

#[inline(always)]
pub fn square_to_disk<V: Lanes>(u: [V; 2], method: Method) -> [V; 2] {
    point_and_depth(u, method).0
}

/// The inverse of [`square_to_disk`] on the disk, in [0, 1).
#[inline(always)]
pub fn disk_to_square<T: Real>(p: [T; 2], method: Method) -> [T; 2] {
    let [x, y] = p;
    let (half, one) = (T::of(0.5), T::one());
    let squared = x * x + y * y;
    let u = match method {
        Method::Concentric => {
            let wide = !(x.abs() <= y.abs());
            let (long, short) = if wide { (x, y) } else { (y, x) };
            let r = squared.sqrt().copysign(long);
            // The angle from the wedge's axis, in wedges.
            let angle = math::atan2(short * one.copysign(long), long.abs()) * T::of(4.0) / T::PI;
            let (a, b) = if wide { (r, r * angle) } else { (r * angle, r) };
            [half * (a + one), half * (b + one)]
        }
        Method::Polar => {
            let turn = math::atan2(y, x) / (T::of(2.0) * T::PI);
            [squared, if turn < T::zero() { turn + one } else { turn }]
        }
    };
    below_one(u)
}

/// The density of the points, per area; the rim counts as inside even where rounding puts a point beyond it.
#[inline(always)]
pub fn square_to_disk_pdf<T: Real>(p: [T; 2]) -> T {
    let squared = p[0] * p[0] + p[1] * p[1];
    let rim = T::one() + T::of(4.0) * T::EPSILON;
    if squared > rim { T::zero() } else { T::one() / T::PI + squared * T::zero() }
}
