//! Bindings of `mesh`.
use pyo3::prelude::*;

#[pymodule]
pub mod mesh {}
