//! Bindings of `brdf`, a file for each group of techniques. Of models by rows: conductor, dielectric, rough_conductor,
//! rough_dielectric, oren_nayar, phong, plastic, principled.

mod facets;
mod ggx;
mod interface;
mod metallic;
mod model;

use pyo3::prelude::*;

#[pymodule]
pub mod brdf {
    #[pymodule_export]
    use super::facets::albedo_table;
    #[pymodule_export]
    use super::facets::kulla_conty;
    #[pymodule_export]
    use super::facets::masking_shadowing;
    #[pymodule_export]
    use super::facets::ndf;
    #[pymodule_export]
    use super::facets::to_metallic_roughness;
    #[pymodule_export]
    use super::facets::to_specular_glossiness;
    #[pymodule_export]
    use super::ggx::ggx;
    #[pymodule_export]
    use super::ggx::ggx_pdf;
    #[pymodule_export]
    use super::ggx::ggx_sample;
    #[pymodule_export]
    use super::interface::fresnel_average_conductor;
    #[pymodule_export]
    use super::interface::fresnel_average_dielectric;
    #[pymodule_export]
    use super::interface::fresnel_conductor;
    #[pymodule_export]
    use super::interface::fresnel_dielectric;
    #[pymodule_export]
    use super::interface::fresnel_schlick;
    #[pymodule_export]
    use super::interface::lambert;
    #[pymodule_export]
    use super::interface::reflect;
    #[pymodule_export]
    use super::interface::refract;
    #[pymodule_export]
    use super::metallic::metallic_roughness;
    #[pymodule_export]
    use super::metallic::metallic_roughness_pdf;
    #[pymodule_export]
    use super::metallic::metallic_roughness_sample;
    #[pymodule_export]
    use super::model::model_eval;
    #[pymodule_export]
    use super::model::model_pdf;
    #[pymodule_export]
    use super::model::model_sample;
    #[pymodule_export]
    use super::model::model_terms;
    #[pymodule_export]
    use super::model::row_width;
}
