//! Bindings of `shadow`: what lookups share is here, a file for each of the faces.

mod closed;
mod field;
mod maps;
mod moments;
mod chart;
mod compared;
mod paged;
mod rays;
mod soft;

use crate::real::Real;
use crate::shadow::anchor::Bias;
use crate::shadow::pattern::{Kind, Pattern};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pub use chart::Chart;
/// Constant, slope, normal offset, plane.
pub type Granted = (f64, f64, f64, bool);
/// Kind, samples, seed.
pub type Taps<'a> = (&'a str, usize, Option<u64>);

pub fn bias<T: Real>((constant, slope, normal_offset, plane): Granted) -> Bias<T> {
    Bias { constant: T::of(constant), slope: T::of(slope), normal_offset: T::of(normal_offset), plane }
}

pub fn pattern<T: Real>((kind, samples, seed): Taps<'_>) -> PyResult<Pattern<T>> {
    let kind = match kind {
        "vogel" => Kind::Vogel,
        "box" => Kind::Box,
        "grid" => Kind::Grid,
        "tent" => Kind::Tent,
        "poisson" => Kind::Poisson,
        _ => return Err(PyValueError::new_err("kernel: unknown")),
    };
    Ok(Pattern::new(kind, samples, seed))
}

/// Calls `$f::<T, true>` or `$f::<T, false>`.
macro_rules! by_projection {
    ($perspective:expr, $t:ident, $f:ident, ($($arg:expr),*)) => {
        if $perspective { $f::<$t, true>($($arg),*) } else { $f::<$t, false>($($arg),*) }
    };
}
use by_projection;

#[pymodule]
pub mod shadow {
    #[pymodule_export]
    use super::closed::half_plane;
    #[pymodule_export]
    use super::compared::hard;
    #[pymodule_export]
    use super::compared::pcf;
    #[pymodule_export]
    use super::field::distance_field;
    #[pymodule_export]
    use super::maps::cascades;
    #[pymodule_export]
    use super::maps::cube_faces;
    #[pymodule_export]
    use super::maps::quantize_depth;
    #[pymodule_export]
    use super::maps::shadow_map;
    #[pymodule_export]
    use super::maps::span;
    #[pymodule_export]
    use super::moments::chebyshev_bound;
    #[pymodule_export]
    use super::moments::exponential_variance;
    #[pymodule_export]
    use super::moments::filtered;
    #[pymodule_export]
    use super::moments::moment_bound;
    #[pymodule_export]
    use super::moments::moment_map;
    #[pymodule_export]
    use super::moments::moment_quantize;
    #[pymodule_export]
    use super::paged::page_levels;
    #[pymodule_export]
    use super::paged::page_marks;
    #[pymodule_export]
    use super::paged::page_settle;
    #[pymodule_export]
    use super::paged::shadow_pages;
    #[pymodule_export]
    use super::rays::ray_traced;
    #[pymodule_export]
    use super::soft::pcss;
}
