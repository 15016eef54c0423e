//! Rotations as three angles about coordinate axes, in each of the 24 orders, and back.
//!
//! Capital letters name axes that move with the body (intrinsic): `XYZ` is `Rx(a) Ry(b) Rz(c)`. Small letters name
//! fixed axes (extrinsic): `xyz` turns about x first, and is `Rz(c) Ry(b) Rx(a)`.
//!
//! On the way back the last angle is found after undoing the first, so that the three together give the rotation to
//! rounding even beside gimbal lock, where the first and the last turn about one line and only their sum (or
//! difference) is determined. At the lock itself the angle that stands last in the order is zero.
//!
//! K. Shoemake, *Euler Angle Conversion*, Graphics Gems IV, 1994.

use super::{Rows3, quaternion::rotates};
use crate::math::{atan2, sin_cos};
use crate::real::Real;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    axes: [usize; 3],
    intrinsic: bool,
}

impl Order {
    /// From a name such as `XYZ` or `zxz`; None if two neighbours are the same axis.
    pub fn from_name(name: &str) -> Option<Order> {
        let letters: [u8; 3] = name.as_bytes().try_into().ok()?;
        let intrinsic = letters[0].is_ascii_uppercase();
        let mut axes = [0; 3];
        for (axis, letter) in axes.iter_mut().zip(letters) {
            *axis = (if intrinsic { b"XYZ" } else { b"xyz" }).iter().position(|&l| l == letter)?;
        }
        (axes[0] != axes[1] && axes[1] != axes[2]).then_some(Order { axes, intrinsic })
    }
}

/// The rotation by `angles` about the axes of `order`.
#[inline(always)]
pub fn euler<T: Real>(angles: [T; 3], order: Order) -> Rows3<T> {
    let (one, zero) = (T::one(), T::zero());
    let mut m = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
    for i in 0..3 {
        // Each turn multiplies from the left: about fixed axes the first turn is the innermost.
        let i = if order.intrinsic { 2 - i } else { i };
        let (s, c) = sin_cos(angles[i]);
        let (j, k) = ((order.axes[i] + 1) % 3, (order.axes[i] + 2) % 3);
        for column in 0..3 {
            let (a, b) = (m[j][column], m[k][column]);
            (m[j][column], m[k][column]) = (c * a - s * b, s * a + c * b);
        }
    }
    m
}

/// The angles of a rotation, and whether they stand at gimbal lock (the sine that tells the outer axes apart is below
/// 8 rounding units). NaN where the matrix is not a rotation (to a thousandth). Outer angles lie in [-π, π], the middle one in [-π/2, π/2], or in [0, π] if the outer axes are
/// the same.
#[inline(always)]
pub fn euler_angles<T: Real>(m: Rows3<T>, order: Order) -> ([T; 3], bool) {
    if !rotates(m) {
        return ([T::NAN; 3], false);
    }
    let Order { axes, intrinsic } = order;
    // Turns about fixed axes are those about moving ones in the opposite order.
    let [i, j, last] = if intrinsic { axes } else { [axes[2], axes[1], axes[0]] };
    let k = 3 - i - j;
    // Axes renamed to x, y, z: a mirror if they are not in cyclic order, which turns every angle about.
    let sign = if (i + 1) % 3 == j { T::one() } else { -T::one() };
    let p = [i, j, k];
    let r = |row: usize, column: usize| m[p[row]][p[column]];
    let repeated = last == i;

    // The sine of the middle angle (the cosine where the outer axes differ) times sine and cosine of the first.
    let (y, x) = if repeated { (sign * r(1, 0), -(sign * r(2, 0))) } else { (-r(1, 2), r(2, 2)) };
    let apart = (x * x + y * y).sqrt();
    let locked = apart <= T::of(8.0) * T::EPSILON;
    let middle = if repeated { atan2(sign * apart, r(0, 0)) } else { atan2(r(0, 2), apart) };

    // At the lock the angle that stands first in the order takes all of the turn: `last` here, if axes are fixed.
    let first = if !locked {
        atan2(y, x)
    } else if intrinsic {
        atan2(r(2, 1), r(1, 1))
    } else {
        T::zero()
    };
    let (s, c) = sin_cos(first);
    let undone = |column: usize| c * r(1, column) + s * r(2, column);
    let last = if locked && intrinsic {
        T::zero()
    } else {
        atan2(if repeated { -undone(2) } else { undone(0) }, undone(1))
    };
    let [a, b, c] = [first, middle, last].map(|angle| sign * angle);
    (if intrinsic { [a, b, c] } else { [c, b, a] }, locked)
}
