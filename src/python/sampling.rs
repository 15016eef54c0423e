//! Bindings of `sampling`.
use pyo3::prelude::*;

#[pymodule]
pub mod sampling {}
