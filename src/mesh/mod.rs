//! The triangle mesh: normals and primitives. Faces are counter-clockwise seen from outside.
//!
//! - [`normals`]: of faces, and of vertices with three weights
//! - [`primitives`]: box, plane, icosphere, torus

pub mod normals;
pub mod primitives;
