//! The kernels of shadelab: real-time rendering techniques and the references that they approximate.
//!
//! The chapters stand in reading order, from the ground up; a chapter uses only those above it. Kernels are pure Rust,
//! generic over [`real::Real`] (f32, f64), and know nothing of Python; `python` binds them.

pub mod real;
pub mod vec;
pub mod math;
pub mod simd;
pub mod parallel;
pub mod memory;

pub mod transform;
pub mod sampling;
pub mod image;
pub mod color;
pub mod geometry;
pub mod mesh;
pub mod accel;
pub mod brdf;
pub mod light;
pub mod environment;
pub mod raster;
pub mod pathtrace;
pub mod shadow;
pub mod renderer;

#[cfg(feature = "python")]
mod python;
