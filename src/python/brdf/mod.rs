//! Bindings of `brdf`, a file for each group of techniques. Of models by rows: conductor, dielectric, rough_conductor,
//! rough_dielectric.

mod ggx;
mod interface;
mod metallic;
mod model;

use pyo3::prelude::*;

#[pymodule]
pub mod brdf {
    #[pymodule_export]
    use super::ggx::ggx;
    #[pymodule_export]
    use super::ggx::ggx_pdf;
    #[pymodule_export]
    use super::ggx::ggx_sample;
    #[pymodule_export]
    use super::interface::fresnel_conductor;
    #[pymodule_export]
    use super::interface::fresnel_dielectric;
    #[pymodule_export]
    use super::interface::fresnel_schlick;
    #[pymodule_export]
    use super::interface::lambert;
    #[pymodule_export]
    use super::metallic::metallic_roughness;
    #[pymodule_export]
    use super::model::model_eval;
    #[pymodule_export]
    use super::model::model_pdf;
    #[pymodule_export]
    use super::model::model_sample;
    #[pymodule_export]
    use super::model::row_width;
}
