//! Bindings of the pictures that textured lights show.

use crate::light::picture::{MOST, Picture};
use crate::python::array::{In, run, unknown};
use crate::real;
use crate::real::Real;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::any::Any;
use std::sync::Arc;

/// A picture in one precision, made ready once and shared by all calls.
#[pyclass(frozen)]
pub struct LightPicture(Arc<dyn Any + Send + Sync>);

impl LightPicture {
    pub fn of<T: Real>(&self) -> PyResult<Arc<Picture<T>>> {
        let held = self.0.clone().downcast::<Picture<T>>();
        held.map_err(|_| PyTypeError::new_err("the light's picture is of another precision"))
    }
}

/// From texels (height, width, 3).
#[pyfunction]
pub fn light_picture(py: Python<'_>, texels: &Bound<'_, PyAny>, width: usize) -> PyResult<LightPicture> {
    real!(texels, T => {
        let texels = In::<T>::of("texture", texels)?.items::<3>()?.to_vec();
        if width == 0 || texels.is_empty() || width > MOST || texels.len() / width > MOST {
            return Err(unknown("texture", "size"));
        }
        let mut made = None;
        run(py, None, |watch| {
            made = Some(Picture::<T>::new(watch, texels, width)?);
            Ok(())
        })?;
        let picture = made.ok_or_else(|| unknown("texture", "picture"))?;
        Ok(LightPicture(Arc::new(picture)))
    })
}
