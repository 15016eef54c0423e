//! Bindings of `shadow`: a map as the face hands it over.

use crate::python::array::In;
use crate::real::Real;
use crate::shadow::lookup::Map;
use crate::shadow::texels::{Pages, Steps, Texels};
use numpy::Element;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Origin (3), rows right, up, axis (9), window (4) and near (1) of a map.
type Geometry = [f64; 17];

/// Depths; geometry; whether perspective; low, step and nothing of stored integers; table of pages, its page's side as a
/// power of two, width and height of the whole; which map each receiver looks into, and which one this is.
#[derive(FromPyObject)]
pub struct Chart<'py>(
    Bound<'py, PyAny>,
    Geometry,
    pub bool,
    Option<(f64, f64, u32)>,
    Option<(Bound<'py, PyAny>, u32, [usize; 2])>,
    Option<(Bound<'py, PyAny>, u8)>,
);

enum Depths<'py, T: Element> {
    Real(In<'py, T>),
    Short(In<'py, u16>, Steps),
    Long(In<'py, u32>, Steps),
    Paged(In<'py, T>, In<'py, i32>, u32),
}

/// The arrays of a [`Chart`], held readable.
pub struct Held<'py, T: Element> {
    depths: Depths<'py, T>,
    size: [usize; 2],
    chosen: Option<(In<'py, u8>, u8)>,
    geometry: Geometry,
}

impl<'py> Chart<'py> {
    pub fn held<T: Real + Element>(&self) -> PyResult<Held<'py, T>> {
        let Chart(array, geometry, _, steps, table, chosen) = self;
        let (depths, size) = match (steps, table) {
            (_, &Some((ref table, bits, size))) => {
                (Depths::Paged(In::of("pages", array)?, In::of("table", table)?, bits), size)
            }
            (&Some((low, step, nothing)), _) => {
                let steps = Steps { low, step, nothing };
                if let Ok(short) = In::<u16>::of("depth", array) {
                    let size = size(short.shape())?;
                    (Depths::Short(short, steps), size)
                } else {
                    let long = In::<u32>::of("depth", array)?;
                    let size = size(long.shape())?;
                    (Depths::Long(long, steps), size)
                }
            }
            (None, None) => {
                let depth = In::<T>::of("depth", array)?;
                let size = size(depth.shape())?;
                (Depths::Real(depth), size)
            }
        };
        let chosen = match chosen {
            Some((array, own)) => Some((In::of("chosen", array)?, *own)),
            None => None,
        };
        Ok(Held { depths, size, chosen, geometry: *geometry })
    }
}

impl<T: Real + Element> Held<'_, T> {
    pub fn map(&self) -> PyResult<Map<'_, T>> {
        let texels = match &self.depths {
            Depths::Real(d) => Texels::Real(d.slice()?),
            Depths::Short(d, steps) => Texels::Short(d.slice()?, *steps),
            Depths::Long(d, steps) => Texels::Long(d.slice()?, *steps),
            Depths::Paged(pages, table, bits) => Texels::Paged(
                Pages::new(pages.slice()?, table.slice()?, *bits, self.size)
                    .ok_or_else(|| PyValueError::new_err("table: does not fit the pages"))?,
            ),
        };
        let map = placed(texels, self.size, &self.geometry)?;
        Ok(match &self.chosen {
            Some((chosen, own)) => map.only(chosen.slice()?, *own),
            None => map,
        })
    }
}

fn size(shape: &[usize]) -> PyResult<[usize; 2]> {
    match shape {
        &[height, width] => Ok([width, height]),
        _ => Err(PyValueError::new_err("depth: expected shape (H, W)")),
    }
}

fn placed<'a, T: Real>(texels: Texels<'a, T>, size: [usize; 2], g: &Geometry) -> PyResult<Map<'a, T>> {
    let at = |i: usize| T::of(g[i]);
    let three = |i: usize| [at(i), at(i + 1), at(i + 2)];
    let frame = [three(3), three(6), three(9)];
    Map::new(texels, size, three(0), frame, [at(12), at(13), at(14), at(15)], at(16))
        .ok_or_else(|| PyValueError::new_err("window: expected left < right and bottom < top"))
}
