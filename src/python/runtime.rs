//! Bindings of threads and SIMD levels.
use pyo3::prelude::*;

#[pymodule]
pub mod runtime {
    use crate::{parallel, simd};
    use pyo3::prelude::*;

    /// The number of threads that work is spread over.
    #[pyfunction]
    fn threads() -> usize {
        parallel::threads()
    }

    /// Sets the number of threads; 0 means one a core.
    #[pyfunction]
    fn set_threads(n: usize) {
        parallel::set_threads(n);
    }

    /// The SIMD level in force.
    #[pyfunction]
    fn simd_level() -> &'static str {
        simd::level().name()
    }

    /// The levels that this machine has.
    #[pyfunction]
    fn simd_levels() -> Vec<&'static str> {
        simd::Level::ALL.into_iter().filter(|l| l.available()).map(|l| l.name()).collect()
    }

    /// Forces a level, or the best for None; false if the machine or the build lacks it.
    #[pyfunction]
    #[pyo3(signature = (name=None))]
    fn force_simd(name: Option<&str>) -> bool {
        match name {
            None => simd::force(None),
            Some(n) => simd::Level::from_name(n).is_some_and(|l| simd::force(Some(l))),
        }
    }
}
