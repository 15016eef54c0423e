//! Bindings of `pathtrace`.
use pyo3::prelude::*;

#[pymodule]
pub mod pathtrace {}
