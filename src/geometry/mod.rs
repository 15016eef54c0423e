//! Rays against primitives, and barycentric coordinates. Each test stands alone, works on the user's scalars in
//! their precision, and says where it is exact.
//!
//! - [`barycentric`]: coordinates of points in triangles

pub mod barycentric;
