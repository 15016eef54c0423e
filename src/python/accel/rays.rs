//! Arrays of rays and of hits.

use crate::accel::query::{AllHits, Found, Query, Rays};
use crate::python::array::{In, Out};
use crate::real::Real;
use numpy::{Element, IntoPyArray};
use pyo3::prelude::*;

/// The arrays of rays, held while a kernel reads them.
pub struct RayArrays<'py, T: Element> {
    origins: In<'py, T>,
    directions: In<'py, T>,
    t_min: In<'py, T>,
    t_max: In<'py, T>,
    ignore_face: In<'py, i32>,
}

impl<'py, T: Real + Element> RayArrays<'py, T> {
    /// From origins, directions, t_min, t_max, ignore_face.
    pub fn of([o, d, low, high, ignore]: &[Bound<'py, PyAny>; 5]) -> PyResult<Self> {
        Ok(RayArrays {
            origins: In::of("origins", o)?,
            directions: In::of("directions", d)?,
            t_min: In::of("t_min", low)?,
            t_max: In::of("t_max", high)?,
            ignore_face: In::of("ignore_face", ignore)?,
        })
    }
    pub fn get(&self) -> PyResult<Rays<'_, T>> {
        self.picture(0)
    }
    /// The rays of a picture's pixels, row by row.
    pub fn picture(&self, width: usize) -> PyResult<Rays<'_, T>> {
        Ok(Rays {
            width,
            origins: self.origins.items()?,
            directions: self.directions.items()?,
            t_min: self.t_min.slice()?,
            t_max: self.t_max.slice()?,
            ignore_face: self.ignore_face.slice()?,
        })
    }
}

/// The arrays of hits, held while a kernel writes them.
pub struct HitArrays<'py, T: Element>(Out<'py, T>, Out<'py, i32>, Out<'py, T>, Out<'py, T>);

impl<'py, T: Real + Element> HitArrays<'py, T> {
    /// From t, face, u, v.
    pub fn of([t, face, u, v]: &[Bound<'py, PyAny>; 4]) -> PyResult<Self> {
        Ok(HitArrays(Out::of("t", t)?, Out::of("face", face)?, Out::of("u", u)?, Out::of("v", v)?))
    }
    pub fn get(&mut self) -> PyResult<Found<'_, T>> {
        Ok(Found { t: self.0.slice()?, face: self.1.slice()?, u: self.2.slice()?, v: self.3.slice()? })
    }
}

/// Offsets, t, face, u, v.
pub fn hit_lists<T: Real + Element>(py: Python<'_>, all: AllHits<T>) -> [Bound<'_, PyAny>; 5] {
    let [t, u, v] = [all.t, all.u, all.v].map(|x| x.into_pyarray(py).into_any());
    [all.offsets.into_pyarray(py).into_any(), t, all.face.into_pyarray(py).into_any(), u, v]
}

/// The query of a name that the face has checked.
pub fn query(name: &str) -> Query {
    match name {
        "closest_hit" => Query::ClosestHit,
        "any_hit" => Query::AnyHit,
        _ => Query::AllHits,
    }
}
