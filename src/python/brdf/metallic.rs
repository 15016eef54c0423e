//! Bindings of the metallic-roughness material.

use crate::brdf::metallic_roughness as material;
use crate::python::array::{In, Out, run};
use crate::real;
use pyo3::prelude::*;

/// Evaluates (`job` "eval"), samples ("sample": `wi` holds the three random numbers) or gives the density ("pdf").
#[pyfunction]
pub fn metallic_roughness(
    py: Python<'_>,
    job: &str,
    wi: &Bound<'_, PyAny>,
    wo: &Bound<'_, PyAny>,
    base_color: &Bound<'_, PyAny>,
    metallic: &Bound<'_, PyAny>,
    roughness: &Bound<'_, PyAny>,
    specular: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let (wi, wo) = (In::<T>::of("wi", wi)?, In::<T>::of("wo", wo)?);
        let base_color = In::<T>::of("base_color", base_color)?;
        let (metallic, roughness) = (In::<T>::of("metallic", metallic)?, In::<T>::of("roughness", roughness)?);
        let specular = In::<T>::of("specular", specular)?;
        let materials = material::Materials {
            base_color: base_color.items()?,
            metallic: metallic.slice()?,
            roughness: roughness.slice()?,
            specular: specular.slice()?,
        };
        let mut out = Out::<T>::of("out", out)?;
        let (wi, wo) = (wi.items()?, wo.items()?);
        match job {
            "eval" => {
                let out = out.items()?;
                run(py, None, |watch| material::metallic_roughness_many(watch, wi, wo, materials, out))
            }
            "sample" => {
                let out = out.items()?;
                run(py, None, |watch| material::metallic_roughness_sample_many(watch, wo, wi, materials, out))
            }
            _ => {
                let out = out.slice()?;
                run(py, None, |watch| material::metallic_roughness_pdf_many(watch, wi, wo, materials, out))
            }
        }
    })
}
