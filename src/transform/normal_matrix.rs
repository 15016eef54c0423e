//! The matrix that carries normals: the cofactors of the linear part, which are the inverse transpose times the
//! determinant and exist where the inverse does not (a scene flattened onto a plane keeps its normals).
//!
//! The determinant's sign is taken out, so that a mirrored normal still points to the side that was outside.

use crate::real::Real;
use crate::vec::Mat3;

/// The normal matrix of `m`, up to a positive factor.
#[inline(always)]
pub fn normal_matrix<T: Real>(m: Mat3<T>) -> Mat3<T> {
    // Scaled to a largest entry of one first, so that products neither overflow nor vanish.
    let largest = m.0.iter().flat_map(|c| c.to_array()).fold(T::zero(), |a, x| x.abs().max(a));
    let m = Mat3(m.0.map(|c| c.map(|x| x / largest)));
    let cofactors = m.cofactor();
    if m.determinant() < T::zero() { Mat3(cofactors.0.map(|c| -c)) } else { cofactors }
}
