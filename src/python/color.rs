//! Bindings of `color`.
use pyo3::prelude::*;

#[pymodule]
pub mod color {}
