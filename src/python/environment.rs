//! Bindings of `environment`.

use crate::environment::panorama::Panorama;
use crate::real::Real;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::sync::Arc;

/// A panorama in the precision of its picture, shared with the kernels that look into it.
#[pyclass(frozen)]
pub struct Surroundings(Precision);

enum Precision {
    Single(Arc<Panorama<f32>>),
    Double(Arc<Panorama<f64>>),
}

/// A precision that panoramas are held in.
pub trait Held: Real {
    fn wrap(panorama: Panorama<Self>) -> Surroundings;
    fn pick(held: &Surroundings) -> Option<&Arc<Panorama<Self>>>;
}

macro_rules! held {
    ($t:ty, $variant:ident) => {
        impl Held for $t {
            fn wrap(panorama: Panorama<$t>) -> Surroundings {
                Surroundings(Precision::$variant(Arc::new(panorama)))
            }
            fn pick(held: &Surroundings) -> Option<&Arc<Panorama<$t>>> {
                if let Precision::$variant(p) = &held.0 { Some(p) } else { None }
            }
        }
    };
}
held!(f32, Single);
held!(f64, Double);

impl Surroundings {
    /// The panorama, if it is of this precision.
    pub fn of<T: Held>(&self) -> PyResult<&Arc<Panorama<T>>> {
        T::pick(self).ok_or_else(|| PyTypeError::new_err("the environment is of another precision"))
    }
}

#[pymodule]
pub mod environment {
    use super::{Held, Surroundings};
    use crate::environment::panorama as kernels;
    use crate::python::array::{Arrays, In, Out, run};
    use crate::real;
    use crate::real::Real;
    use pyo3::prelude::*;

    /// From an array (height, width, 3), turned about y by an angle.
    #[pyfunction]
    fn panorama(
        py: Python<'_>,
        radiance: &Bound<'_, PyAny>,
        width: usize,
        angle: f64,
    ) -> PyResult<Surroundings> {
        real!(radiance, T => {
            let pixels = In::<T>::of("radiance", radiance)?.items::<3>()?.to_vec();
            let height = pixels.len() / width.max(1);
            Ok(T::wrap(py.detach(|| kernels::Panorama::new(width, height, pixels, angle))))
        })
    }

    /// ∫ luminance dω.
    #[pyfunction]
    fn power(panorama: &Surroundings) -> f64 {
        match (panorama.of::<f32>(), panorama.of::<f64>()) {
            (Ok(p), _) => p.power().to_f64(),
            (_, Ok(p)) => p.power(),
            _ => f64::NAN,
        }
    }

    /// `out`: radiance and density.
    #[pyfunction]
    fn look(
        py: Python<'_>,
        panorama: &Surroundings,
        directions: &Bound<'_, PyAny>,
        out: Arrays<'_>,
    ) -> PyResult<()> {
        real!(directions, T => {
            let (panorama, given) = (panorama.of::<T>()?, In::<T>::of("directions", directions)?);
            let (mut radiance, mut pdf) = (Out::<T>::of("radiance", &out[0])?, Out::<T>::of("pdf", &out[1])?);
            let (given, radiance, pdf) = (given.items()?, radiance.items()?, pdf.slice()?);
            run(py, None, |watch| kernels::panorama_many(watch, panorama, given, radiance, pdf))
        })
    }

    /// `out`: directions, radiance, densities.
    #[pyfunction]
    fn sample(
        py: Python<'_>,
        panorama: &Surroundings,
        u: &Bound<'_, PyAny>,
        out: Arrays<'_>,
    ) -> PyResult<()> {
        real!(u, T => {
            let (panorama, u) = (panorama.of::<T>()?, In::<T>::of("u", u)?);
            let (mut wi, mut radiance) = (Out::<T>::of("wi", &out[0])?, Out::<T>::of("radiance", &out[1])?);
            let mut pdf = Out::<T>::of("pdf", &out[2])?;
            let (u, wi, radiance, pdf) = (u.items()?, wi.items()?, radiance.items()?, pdf.slice()?);
            run(py, None, |watch| kernels::panorama_sample_many(watch, panorama, u, wi, radiance, pdf))
        })
    }
}
