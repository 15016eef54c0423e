//! Bindings of rays: ray_triangle.

use crate::geometry as kernels;
use crate::geometry::ray_triangle::Method;
use crate::python::array::{In, Out, run};
use crate::real;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// `out`: t, u, v.
#[pyfunction]
pub fn ray_triangle(
    py: Python<'_>,
    method: &str,
    rays: [Bound<'_, PyAny>; 2],
    triangles: [Bound<'_, PyAny>; 3],
    interval: [Bound<'_, PyAny>; 2],
    out: [Bound<'_, PyAny>; 3],
) -> PyResult<()> {
    let method = match method {
        "watertight" => Method::Watertight,
        "moller_trumbore" => Method::MollerTrumbore,
        "plane" => Method::Plane,
        _ => return Err(PyValueError::new_err(format!("method: unknown, got {method:?}"))),
    };
    real!(&rays[0], T => {
        let [o, d] = &rays;
        let (o, d) = (In::<T>::of("origins", o)?, In::<T>::of("directions", d)?);
        let [a, b, c] = &triangles;
        let (a, b, c) = (In::<T>::of("a", a)?, In::<T>::of("b", b)?, In::<T>::of("c", c)?);
        let [low, high] = &interval;
        let (low, high) = (In::<T>::of("t_min", low)?, In::<T>::of("t_max", high)?);
        let [t, u, v] = &out;
        let (mut t, mut u, mut v) = (Out::<T>::of("t", t)?, Out::<T>::of("u", u)?, Out::<T>::of("v", v)?);
        let (rays, triangles) = ([o.items()?, d.items()?], [a.items()?, b.items()?, c.items()?]);
        let (interval, out) = ([low.slice()?, high.slice()?], [t.slice()?, u.slice()?, v.slice()?]);
        run(py, None, |watch| {
            kernels::ray_triangle::ray_triangle_many(watch, method, rays, triangles, interval, out)
        })
    })
}
