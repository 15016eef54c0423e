//! The triangle mesh: normals and primitives.
