//! The unit square onto the triangle of barycentrics u, v ≥ 0, u + v ≤ 1, areas in constant proportion.
//!
//! Folding moves points by little and costs no root; the root map (1 − √s, t√s) keeps lines through one corner.
//!
//! E. Heitz, *A low-distortion map between triangle and square*, 2019; P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo
//! techniques for direct lighting calculations*, 1996 (roots).

use super::{below_one, in_square};
use crate::real::Real;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Fold,
    Root,
}

#[inline(always)]
pub fn square_to_triangle<T: Real>(u: [T; 2], method: Method) -> [T; 2] {
    let ([s, t], half) = (in_square(u), T::of(0.5));
    match method {
        // Each half of the square is pushed down its diagonal's slope; both differences are free of cancellation.
        Method::Fold if t > s => [half * s, t - half * s],
        Method::Fold => [s - half * t, half * t],
        Method::Root => {
            let root = s.sqrt();
            [T::one() - root, t * root]
        }
    }
}

/// The inverse of [`square_to_triangle`] on the triangle, in [0, 1).
#[inline(always)]
pub fn triangle_to_square<T: Real>([u, v]: [T; 2], method: Method) -> [T; 2] {
    let (one, two) = (T::one(), T::of(2.0));
    let square = match method {
        Method::Fold if v > u => [two * u, u + v],
        Method::Fold => [u + v, two * v],
        Method::Root => {
            let root = one - u;
            [root * root, if root == T::zero() { T::zero() } else { v / root }]
        }
    };
    below_one(square)
}

/// The density of the barycentrics: two in the triangle. Per area of a triangle in space it is one over its area.
#[inline(always)]
pub fn square_to_triangle_pdf<T: Real>([u, v]: [T; 2]) -> T {
    let sum = u + v;
    let outside = u < T::zero() || v < T::zero() || sum > T::one();
    if outside { T::zero() } else { T::of(2.0) + sum * T::zero() }
}
