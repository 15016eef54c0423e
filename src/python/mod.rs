//! The module tree that Python sees as `shadelab._kernels`: one submodule a chapter.

pub mod array;

mod accel;
mod brdf;
mod color;
mod environment;
mod geometry;
mod image;
mod light;
mod math;
mod mesh;
mod pathtrace;
mod raster;
mod renderer;
mod runtime;
mod sampling;
mod shadow;
mod transform;

use pyo3::prelude::*;

#[pymodule]
mod _kernels {
    #[pymodule_export]
    use super::{
        accel::accel, brdf::brdf, color::color, environment::environment, geometry::geometry, image::image,
        light::light, math::math, mesh::mesh, pathtrace::pathtrace, raster::raster, renderer::renderer,
        runtime::runtime, sampling::sampling, shadow::shadow, transform::transform,
    };
}
