//! Bindings of `brdf`.
use pyo3::prelude::*;

#[pymodule]
pub mod brdf {
    use crate::brdf::{fresnel, ggx as rough, lambert as diffuse, metallic_roughness as material};
    use crate::python::array::{In, Out, run};
    use crate::real;
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    #[pyfunction]
    fn fresnel_schlick(
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
            run(py, None, |watch| fresnel::fresnel_schlick_many(watch, c, f0, f90, out))
        })
    }

    #[pyfunction]
    fn lambert(
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

    #[pyfunction]
    fn ggx(
        py: Python<'_>,
        wi: &Bound<'_, PyAny>,
        wo: &Bound<'_, PyAny>,
        alpha: &Bound<'_, PyAny>,
        f0: &Bound<'_, PyAny>,
        masking: &str,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let masking = match masking {
            "height_correlated" => rough::Masking::HeightCorrelated,
            "separable" => rough::Masking::Separable,
            other => return Err(PyValueError::new_err(format!("masking: unknown {other:?}"))),
        };
        real!(out, T => {
            let (wi, wo) = (In::<T>::of("wi", wi)?, In::<T>::of("wo", wo)?);
            let (alpha, f0) = (In::<T>::of("alpha", alpha)?, In::<T>::of("f0", f0)?);
            let mut out = Out::<T>::of("out", out)?;
            let (wi, wo, alpha, f0, out) = (wi.items()?, wo.items()?, alpha.slice()?, f0.items()?, out.items()?);
            run(py, None, |watch| rough::ggx_many(watch, wi, wo, alpha, f0, masking, out))
        })
    }

    #[pyfunction]
    fn ggx_sample(
        py: Python<'_>,
        wo: &Bound<'_, PyAny>,
        u: &Bound<'_, PyAny>,
        alpha: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(out, T => {
            let (wo, u, alpha) = (In::<T>::of("wo", wo)?, In::<T>::of("u", u)?, In::<T>::of("alpha", alpha)?);
            let mut out = Out::<T>::of("out", out)?;
            let (wo, u, alpha, out) = (wo.items()?, u.items()?, alpha.slice()?, out.items()?);
            run(py, None, |watch| rough::ggx_sample_many(watch, wo, u, alpha, out))
        })
    }

    #[pyfunction]
    fn ggx_pdf(
        py: Python<'_>,
        wi: &Bound<'_, PyAny>,
        wo: &Bound<'_, PyAny>,
        alpha: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(out, T => {
            let (wi, wo, alpha) = (In::<T>::of("wi", wi)?, In::<T>::of("wo", wo)?, In::<T>::of("alpha", alpha)?);
            let mut out = Out::<T>::of("out", out)?;
            let (wi, wo, alpha, out) = (wi.items()?, wo.items()?, alpha.slice()?, out.slice()?);
            run(py, None, |watch| rough::ggx_pdf_many(watch, wi, wo, alpha, out))
        })
    }

    /// Evaluates (`job` "eval"), samples ("sample": `wi` holds the three random numbers) or gives the density ("pdf").
    #[pyfunction]
    fn metallic_roughness(
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
}
