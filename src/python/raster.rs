//! Bindings of `raster`.
use pyo3::prelude::*;

#[pymodule]
pub mod raster {}
