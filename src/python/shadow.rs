//! Bindings of `shadow`.
use pyo3::prelude::*;

#[pymodule]
pub mod shadow {}
