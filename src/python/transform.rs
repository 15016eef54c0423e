//! Bindings of `transform`.
use pyo3::prelude::*;

#[pymodule]
pub mod transform {}
