//! Bindings of `accel`.
use pyo3::prelude::*;

#[pymodule]
pub mod accel {}
