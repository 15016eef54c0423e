//! Bindings of `brdf`.
use pyo3::prelude::*;

#[pymodule]
pub mod brdf {}
