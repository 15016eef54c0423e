//! Quaternions (x, y, z, w), w the real part: products, rotation, spherical interpolation, matrices and back.
//!
//! Those that rotate may be of any length but zero, since `q` and `s q` are the same rotation.
//!
//! W. Hamilton, *On Quaternions*, 1844; K. Shoemake, *Animating Rotation with Quaternion Curves*, 1985 (slerp);
//! S. Shepperd, *Quaternion from Rotation Matrix*, 1978.

use super::{Rows3, view::orthonormal};
use crate::math::{atan2, sin, sin_cos};
use crate::real::Real;
use crate::vec::{Mat3, Vec3, Vec4};

/// The unit quaternion of a rotation by `angle` about `axis` (of any length).
#[inline(always)]
pub fn from_axis<T: Real>(axis: Vec3<T>, angle: T) -> Vec4<T> {
    let (s, c) = sin_cos(angle * T::of(0.5));
    (axis.normalize() * s).extend(c)
}

/// Hamilton's product: the rotation `b`, then `a`.
#[inline(always)]
pub fn multiply<T: Real>(a: Vec4<T>, b: Vec4<T>) -> Vec4<T> {
    let (u, v) = (a.xyz(), b.xyz());
    (v * a.w + u * b.w + u.cross(v)).extend(a.w * b.w - u.dot(v))
}

#[inline(always)]
pub fn conjugate<T: Real>(q: Vec4<T>) -> Vec4<T> {
    (-q.xyz()).extend(q.w)
}

/// The conjugate over the squared length.
#[inline(always)]
pub fn inverse<T: Real>(q: Vec4<T>) -> Vec4<T> {
    // Of the quaternion with largest component one, so that no square overflows or vanishes.
    let largest = q.x.abs().max(q.y.abs()).max(q.z.abs().max(q.w.abs()));
    let unit = q.map(|c| c / largest);
    let squared = unit.dot(unit);
    conjugate(unit).map(|c| c / squared / largest)
}

/// `q v q⁻¹`.
#[inline(always)]
pub fn rotate<T: Real>(q: Vec4<T>, v: Vec3<T>) -> Vec3<T> {
    let q = q.normalize();
    let t = q.xyz().cross(v) * T::of(2.0);
    v + t * q.w + q.xyz().cross(t)
}

/// The point `t` of the way along the great arc from `a` to `b`, both of unit length; with `shortest` along the arc to
/// the nearer of `b` and `-b`, which rotate alike.
#[inline(always)]
pub fn slerp<T: Real>(a: Vec4<T>, b: Vec4<T>, t: T, shortest: bool) -> Vec4<T> {
    let one = T::one();
    // NaN where there is no quaternion: neither has a length of zero.
    let defined = a.dot(a) * b.dot(b) > T::zero();
    let a = if defined { a } else { a * T::NAN };
    let cosine = a.dot(b);
    let b = if shortest && cosine < T::zero() { -b } else { b };
    if shortest || !(cosine < T::zero()) {
        // The angle from the chords keeps its digits where it is small, and so do the quotients of sines.
        let length = |v: Vec4<T>| v.dot(v).sqrt();
        let angle = T::of(2.0) * atan2(length(a - b), length(a + b));
        let whole = sin(angle);
        let weight = |part: T| if whole > T::MIN_POSITIVE { sin(part * angle) / whole } else { part };
        return a * weight(one - t) + b * weight(t);
    }
    // Beyond a quarter turn on the sphere: from `a` towards the direction across it. Their sum is exact where they are
    // nearly opposite, so the direction keeps its digits, until `b = -a` leaves it open.
    let sum = a + b;
    let across = sum - a * a.dot(sum);
    let sine = across.dot(across).sqrt();
    let open = sine <= T::of(8.0) * T::EPSILON * sum.dot(sum).sqrt();
    let across = if open { Vec4::from([-a.y, a.x, -a.w, a.z]) } else { across.normalize() };
    let across = (across - a * a.dot(across)).normalize();
    let (s, c) = sin_cos(t * atan2(sine, cosine));
    a * c + across * s
}

/// The rotation matrix.
#[inline(always)]
pub fn to_matrix<T: Real>(q: Vec4<T>) -> Rows3<T> {
    let Vec4 { x, y, z, w } = q.normalize();
    let (one, two) = (T::one(), T::of(2.0));
    [
        [one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)],
        [two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)],
        [two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)],
    ]
}

/// The unit quaternion of a rotation matrix, with w ≥ 0; NaN where the matrix is not a rotation (to a thousandth).
#[inline(always)]
pub fn from_matrix<T: Real>(m: Rows3<T>) -> Vec4<T> {
    if rotates(m) { from_rotation(m) } else { Vec4::splat(T::NAN) }
}

/// Whether the columns are orthonormal to a thousandth, and not mirrored.
#[inline(always)]
pub(super) fn rotates<T: Real>(m: Rows3<T>) -> bool {
    let columns = Mat3::from_rows(m);
    orthonormal(columns.0) && columns.determinant() > T::zero()
}

#[inline(always)]
pub(super) fn from_rotation<T: Real>(m: Rows3<T>) -> Vec4<T> {
    let one = T::one();
    let [x, y, z] = [m[0][0], m[1][1], m[2][2]];
    let trace = x + y + z;
    // Four times the largest component times the quaternion: no difference of it cancels.
    let q = if trace >= x.max(y).max(z) {
        [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], one + trace]
    } else if x >= y && x >= z {
        [one + x - y - z, m[0][1] + m[1][0], m[0][2] + m[2][0], m[2][1] - m[1][2]]
    } else if y >= z {
        [m[0][1] + m[1][0], one - x + y - z, m[1][2] + m[2][1], m[0][2] - m[2][0]]
    } else {
        [m[0][2] + m[2][0], m[1][2] + m[2][1], one - x - y + z, m[1][0] - m[0][1]]
    };
    let q = Vec4::from(q).normalize();
    if q.w < T::zero() { -q } else { q }
}
