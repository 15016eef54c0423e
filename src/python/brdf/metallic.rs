//! Bindings of the metallic-roughness material.

use crate::brdf::{self, metallic_roughness::Material};
use crate::lanewise;
use crate::python::array::Arrays;
use crate::real::Lanes;
use pyo3::prelude::*;

/// `given`: wi, wo, base colour, metallic, roughness, specular.
#[pyfunction]
pub fn metallic_roughness(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |wi: 3, wo: 3, color: 3, metallic: 1, roughness: 1, specular: 1| -> (f: 3) {
        let lobes = material(color, [metallic[0], roughness[0], specular[0]]).lobes();
        lobes.eval(wi.into(), wo.into()).to_array()
    })
}

/// `given`: wo, three random numbers, base colour, metallic, roughness, specular. NaN where `wo` is below the horizon.
#[pyfunction]
pub fn metallic_roughness_sample(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |wo: 3, u: 3, color: 3, metallic: 1, roughness: 1, specular: 1| -> (wi: 3) {
        let material = material(color, [metallic[0], roughness[0], specular[0]]);
        let spoilt = spoil(material.metallic, wo[2]);
        let wi = material.lobes().sample_of_both(wo.into(), u);
        [wi.x + spoilt, wi.y + spoilt, wi.z + spoilt]
    })
}

/// `given`: as of `metallic_roughness`.
#[pyfunction]
pub fn metallic_roughness_pdf(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    lanewise!(py, given, out, |wi: 3, wo: 3, color: 3, metallic: 1, roughness: 1, specular: 1| -> (pdf: 1) {
        let material = material(color, [metallic[0], roughness[0], specular[0]]);
        // Zeros of what is not seen know no NaN.
        [material.lobes().pdf(wi.into(), wo.into()) + material.metallic * wi[2].num(0.0)]
    })
}

#[inline(always)]
fn material<V: Lanes>(color: [V; 3], [metallic, roughness, specular]: [V; 3]) -> Material<V> {
    Material { base_color: brdf::color(color), metallic, roughness, specular }.checked()
}

/// Zero; NaN where a parameter is, or the direction is not above the horizon.
#[inline(always)]
fn spoil<V: Lanes>(parameter: V, z: V) -> V {
    let zero = z.num(0.0);
    V::select(zero.less(z), parameter * zero, z.like(<V::Elem as crate::real::Real>::NAN))
}
