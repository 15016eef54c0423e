//! Bindings of interfaces: reflect, refract, Fresnel's reflectances and fresnel_average; Lambert's diffuser.

use crate::brdf::fresnel as kernels;
use crate::brdf::fresnel_average as average;
use crate::brdf::lambert as diffuse;
use crate::brdf::reflect as bent;
use crate::elementwise;
use crate::python::array::{Arrays, In, Out, run};
use crate::real;
use crate::real::Real;
use crate::vec::Vec3;
use pyo3::prelude::*;

#[pyfunction]
pub fn fresnel_schlick(
    py: Python<'_>,
    cos_theta: &Bound<'_, PyAny>,
    f0: &Bound<'_, PyAny>,
    f90: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let c = In::<T>::of("cos_theta", cos_theta)?;
        let (f0, f90) = (In::<T>::of("f0", f0)?, In::<T>::of("f90", f90)?);
        let mut out = Out::<T>::of("out", out)?;
        let (c, f0, f90, out) = (c.slice()?, f0.slice()?, f90.slice()?, out.slice()?);
        run(py, None, |watch| kernels::fresnel_schlick_many(watch, c, f0, f90, out))
    })
}

#[pyfunction]
pub fn lambert(
    py: Python<'_>,
    wi: &Bound<'_, PyAny>,
    wo: &Bound<'_, PyAny>,
    albedo: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let (wi, wo) = (In::<T>::of("wi", wi)?, In::<T>::of("wo", wo)?);
        let albedo = In::<T>::of("albedo", albedo)?;
        let mut out = Out::<T>::of("out", out)?;
        let (wi, wo, albedo, out) = (wi.items()?, wo.items()?, albedo.items()?, out.items()?);
        run(py, None, |watch| diffuse::lambert_many(watch, wi, wo, albedo, out))
    })
}

/// `out`: reflectances across and in the plane, cosine of the refracted ray.
#[pyfunction]
pub fn fresnel_dielectric(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |cos: [T; 1], eta: [T; 1]| -> (s: [T; 1], p: [T; 1], cos_t: [T; 1]) {
        let f = kernels::fresnel_dielectric(kernels::cosine(cos[0]), kernels::index(eta[0]));
        ([f.s], [f.p], [f.cos_t])
    })
}

/// `out`: reflectances across and in the plane.
#[pyfunction]
pub fn fresnel_conductor(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |cos: [T; 1], eta: [T; 1], k: [T; 1]| -> (s: [T; 1], p: [T; 1]) {
        let f = kernels::fresnel_conductor(kernels::cosine(cos[0]), kernels::index(eta[0]), k[0]);
        ([f.s], [f.p])
    })
}

#[pyfunction]
pub fn reflect(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |w: [T; 3], normal: [T; 3]| -> (mirrored: [T; 3]) {
        bent::reflect(w.into(), normal.into()).to_array()
    })
}

/// `out`: the direction, and whether all is reflected.
#[pyfunction]
pub fn refract(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |w: [T; 3], normal: [T; 3], eta: [T; 1]| -> (refracted: [T; 3], total: [bool; 1]) {
            let eta = kernels::index(eta[0]);
            let found = bent::refract(w.into(), normal.into(), eta);
            let total = found.is_none();
            (found.unwrap_or(Vec3::splat(T::NAN)).to_array(), [total])
        }
    )
}

#[pyfunction]
pub fn fresnel_average_dielectric(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |eta: [T; 1]| -> (f: [T; 1]) {
        [T::of(average::fresnel_average_dielectric(eta[0].to_f64()))]
    })
}

#[pyfunction]
pub fn fresnel_average_conductor(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |eta: [T; 1], k: [T; 1]| -> (f: [T; 1]) {
        [T::of(average::fresnel_average_conductor(eta[0].to_f64(), k[0].to_f64()))]
    })
}
