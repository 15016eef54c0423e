//! Binding of ray_implicit, for polynomials.

use crate::geometry::ray_implicit::{DEGREE, Surface};
use crate::parallel::for_each;
use crate::python::array::{Arrays, In, Out, first, next, run, same_length};
use crate::real;
use crate::real::Real;
use crate::vec::Vec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The highest degree that there is room for.
#[pyfunction]
pub fn ray_implicit_degree() -> usize {
    DEGREE
}

/// `given`: origins, directions, t_min, t_max; `out`: t, normals, values, crossings within the interval.
#[pyfunction]
pub fn ray_implicit(
    py: Python<'_>,
    coefficients: Bound<'_, PyAny>,
    shape: [usize; 3],
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let coefficients = In::<f64>::of("surface", &coefficients)?;
    let surface = Surface::new(coefficients.slice()?, shape)
        .ok_or_else(|| PyValueError::new_err("surface: the degree is too high, or zero"))?;
    real!(first(&given)?, T => {
        let (mut given, mut out) = (given.iter(), out.iter());
        let origins = In::<T>::of("origins", next(&mut given)?)?;
        let directions = In::<T>::of("directions", next(&mut given)?)?;
        let low = In::<T>::of("t_min", next(&mut given)?)?;
        let high = In::<T>::of("t_max", next(&mut given)?)?;
        let mut t = Out::<T>::of("t", next(&mut out)?)?;
        let mut normals = Out::<T>::of("normal", next(&mut out)?)?;
        let mut values = Out::<T>::of("value", next(&mut out)?)?;
        let mut crossings = Out::<i32>::of("crossings", next(&mut out)?)?;
        let rays = (origins.items::<3>()?, directions.items::<3>()?, low.slice()?, high.slice()?);
        let out = (t.slice()?, normals.items::<3>()?, values.slice()?, crossings.slice()?);
        same_length(&[rays.0.len(), rays.1.len(), rays.2.len(), rays.3.len()])?;
        same_length(&[rays.0.len(), out.0.len(), out.1.len(), out.2.len(), out.3.len()])?;
        run(py, None, |watch| {
            for_each(watch, (rays, out), 1 << 10, |_, (rays, out)| {
                for i in 0..rays.0.len() {
                    let wide = |v: [T; 3]| Vec3::from(v.map(|x| x.to_f64()));
                    let (o, d, low, high) = (wide(rays.0[i]), wide(rays.1[i]), rays.2[i], rays.3[i]);
                    let finite = rays.0[i].iter().chain(&rays.1[i]).all(|x| x.is_finite());
                    (out.0[i], out.1[i], out.2[i], out.3[i]) = (T::NAN, [T::NAN; 3], T::NAN, 0);
                    if !finite || rays.1[i] == [T::of(0.0); 3] || low.is_nan() || high.is_nan() {
                        continue;
                    }
                    let mut roots = [0.0; DEGREE + 1];
                    let n = surface.meet(o, d, &mut roots);
                    out.0[i] = T::INFINITY;
                    for &root in &roots[..n] {
                        let t = T::of(root);
                        if t > low && t < high {
                            if out.3[i] == 0 {
                                let (value, gradient) = surface.gradient(o + d * root);
                                out.0[i] = t;
                                out.1[i] = gradient.normalize().to_array().map(T::of);
                                out.2[i] = T::of(value);
                            }
                            out.3[i] += 1;
                        }
                    }
                }
            })
        })
    })
}
