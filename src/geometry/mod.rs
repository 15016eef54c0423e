//! Rays against primitives, and barycentric coordinates. Each test stands alone, works on the user's scalars in
//! their precision, and says where it is exact.
//!
//! - [`barycentric`]: coordinates of points in triangles
//! - [`ray_sphere`]: a ray against a sphere: robust, quadratic, geometric
//! - [`ray_triangle`]: a ray against a triangle: watertight, Möller-Trumbore, plane

pub mod barycentric;
pub mod ray_sphere;
pub mod ray_triangle;

pub(crate) use crate::math::exact;
