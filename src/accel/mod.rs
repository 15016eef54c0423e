//! Acceleration structures for ray queries.
//!
//! All answer by one protocol, [`structure::Structure`], and alike to the bit.
//!
//! - [`Bvh`]: a tree of boxes; nearest and any hit, singly or in batches
//! - [`brute_force`]: every triangle, by the same rule: what every structure must return
//! - [`uniform_grid`], [`octree`], [`kd_tree`], [`bsp_tree`]: space parted into cells
//! - [`offset_ray`]: origins moved off their surface, so that rays do not meet it again

mod batch;
mod block;
mod bounds;
mod nearest;
mod cells;
mod halving;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // as those of `query`
pub(crate) mod lists;
mod met;
mod radix;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // points come from Python alone
pub(crate) mod pseudonormals;
mod ray;
pub(crate) mod structure;

pub mod brute_force;
pub mod bsp_tree;
pub mod bvh;
pub mod morton;
pub mod kd_tree;
pub mod octree;
pub mod offset_ray;
pub mod uniform_grid;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // arrays of rays come from Python alone
pub(crate) mod query;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // as those of `query`
mod squares;

use crate::real::Real;
pub use bvh::Bvh;
pub use structure::Structure;

/// A ray; hits lie in the open interval `(t_min, t_max)`, in units of the direction's length, and not on `ignore_face`.
#[derive(Clone, Copy, Debug)]
pub struct Ray<T> {
    pub origin: [T; 3],
    pub direction: [T; 3],
    pub t_min: T,
    pub t_max: T,
    /// -1: none.
    pub ignore_face: i32,
}

impl<T: Real> Ray<T> {
    /// All that lies ahead.
    #[inline(always)]
    pub fn new(origin: [T; 3], direction: [T; 3]) -> Self {
        Ray { origin, direction, t_min: T::zero(), t_max: T::INFINITY, ignore_face: -1 }
    }
}

/// The point `(1 - u - v) a + u b + v c` of a face. A miss has face -1, and `t` infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<T> {
    pub t: T,
    pub u: T,
    pub v: T,
    pub face: i32,
}

impl<T: Real> Hit<T> {
    #[inline(always)]
    pub fn miss() -> Self {
        Hit { t: T::INFINITY, u: T::zero(), v: T::zero(), face: -1 }
    }
    /// What a ray gets that is none: NaN or infinity in its origin or direction, NaN in its interval, no direction.
    #[inline(always)]
    pub fn no_ray() -> Self {
        Hit { t: T::NAN, u: T::NAN, v: T::NAN, face: -1 }
    }
    #[inline(always)]
    pub fn is_hit(&self) -> bool {
        self.face >= 0
    }
}
