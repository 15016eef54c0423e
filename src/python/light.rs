//! Bindings of `light`.
use pyo3::prelude::*;

#[pymodule]
pub mod light {}
