//! Cameras and pixel filters as the face hands them over, and their rays and offsets as arrays.

use crate::elementwise;
use crate::pathtrace::Pinhole;
use crate::pathtrace::camera::{Camera, Pose};
use crate::pathtrace::filter::{Filter, Shape};
use crate::python::array::{Arrays, unknown};
use crate::real::Real;
use crate::vec::Vec3;
use pyo3::prelude::*;

/// The pinhole's eye, corner, right and down; the lens' radii; one over the distance of focus.
type PoseTuple = ([[f64; 3]; 4], [[f64; 3]; 2], f64);
/// The camera at time 0, at time 1 if it moves, and when the shutter opens and closes.
pub type CameraTuple = (PoseTuple, Option<PoseTuple>, [f64; 2]);
/// Name, radius, and a Gaussian's standard deviation.
pub type FilterTuple = (String, f64, f64);

fn vector<T: Real>(v: [f64; 3]) -> Vec3<T> {
    v.map(T::of).into()
}

fn pose<T: Real>((pinhole, lens, inverse_focus): PoseTuple) -> Pose<T> {
    let [eye, corner, right, down] = pinhole.map(vector);
    Pose {
        pinhole: Pinhole { eye, corner, right, down },
        lens: lens.map(vector),
        inverse_focus: T::of(inverse_focus),
    }
}

pub fn camera<T: Real>((start, end, shutter): CameraTuple) -> Camera<T> {
    Camera { start: pose(start), end: end.map(pose), shutter: shutter.map(T::of) }
}

pub fn filter((name, radius, deviation): FilterTuple) -> PyResult<Filter> {
    let shape = match name.as_str() {
        "box" => Shape::Box,
        "tent" => Shape::Tent,
        "gaussian" => Shape::Gaussian(deviation),
        "blackman_harris" => Shape::BlackmanHarris,
        _ => return Err(unknown("filter", &name)),
    };
    Ok(Filter::new(shape, radius))
}

#[pyfunction]
pub fn camera_rays(py: Python<'_>, camera: CameraTuple, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |at: [T; 2], lens: [T; 2], time: [T; 1]| -> (origin: [T; 3], direction: [T; 3]) {
        let ray = self::camera::<T>(camera).ray(at[0], at[1], lens, time[0]);
        (ray.origin, ray.direction)
    })
}

#[pyfunction]
pub fn pixel_filter_sample(
    py: Python<'_>,
    filter: FilterTuple,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let filter = self::filter(filter)?;
    elementwise!(py, given, out, |u: [T; 1]| -> (x: [T; 1]) {
        [if (0.0..=1.0).contains(&u[0].to_f64()) { filter.warp1(u[0]) } else { T::NAN }]
    })
}

#[pyfunction]
pub fn pixel_filter_density(
    py: Python<'_>,
    filter: FilterTuple,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let filter = self::filter(filter)?;
    elementwise!(py, given, out, |x: [T; 1]| -> (density: [T; 1]) { [T::of(filter.density(x[0].to_f64()))] })
}
