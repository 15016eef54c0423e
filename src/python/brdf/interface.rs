//! Bindings of interfaces: reflect, refract, Fresnel's reflectances and fresnel_average; Lambert's diffuser.

use crate::brdf::fresnel as kernels;
use crate::brdf::fresnel_average as average;
use crate::brdf::lambert as diffuse;
use crate::brdf::{self, reflect as bent};
use crate::elementwise;
use crate::lanewise;
use crate::python::array::Arrays;
use crate::real::Real;
use crate::vec::Vec3;
use pyo3::prelude::*;

/// `given`: cos θ, f0, f90.
#[pyfunction]
pub fn fresnel_schlick(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |cos: 1, f0: 1, f90: 1| -> (f: 1) {
        [kernels::fresnel_schlick(kernels::cosine(cos[0]), f0[0], f90[0])]
    })
}

/// `given`: wi, wo, albedo.
#[pyfunction]
pub fn lambert(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |wi: 3, wo: 3, albedo: 3| -> (f: 3) {
        diffuse::lambert(wi.into(), wo.into(), brdf::color(albedo)).to_array()
    })
}

/// `out`: reflectances across and in the plane, cosine of the refracted ray.
#[pyfunction]
pub fn fresnel_dielectric(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |cos: 1, eta: 1| -> (s: 1, p: 1, cos_t: 1) {
        let f = kernels::fresnel_dielectric(kernels::cosine(cos[0]), kernels::index(eta[0]));
        ([f.s], [f.p], [f.cos_t])
    })
}

/// `out`: reflectances across and in the plane.
#[pyfunction]
pub fn fresnel_conductor(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |cos: 1, eta: 1, k: 1| -> (s: 1, p: 1) {
        let (eta, k) = (kernels::index(eta[0]), kernels::extinction(k[0]));
        let f = kernels::fresnel_conductor(kernels::cosine(cos[0]), eta, k);
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
        [T::of(average::fresnel_average_dielectric(kernels::index(eta[0]).to_f64()))]
    })
}

#[pyfunction]
pub fn fresnel_average_conductor(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |eta: [T; 1], k: [T; 1]| -> (f: [T; 1]) {
        let (eta, k) = (kernels::index(eta[0]), kernels::extinction(k[0]));
        [T::of(average::fresnel_average_conductor(eta.to_f64(), k.to_f64()))]
    })
}
