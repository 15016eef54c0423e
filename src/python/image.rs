//! Bindings of `image`.
use pyo3::prelude::*;

#[pymodule]
pub mod image {}
