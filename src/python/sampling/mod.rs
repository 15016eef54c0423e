//! Bindings of `sampling`, a file for each of its faces.

mod generators;
mod sequences;
mod warps;

use pyo3::prelude::*;

#[pymodule]
pub mod sampling {
    #[pymodule_export]
    use super::generators::philox;
    #[pymodule_export]
    use super::generators::uniform;
    #[pymodule_export]
    const SOBOL_DIMENSIONS: usize = super::sequences::SOBOL_DIMENSIONS;
    #[pymodule_export]
    use super::sequences::sobol;
    #[pymodule_export]
    use super::warps::cosine_hemisphere_to_square;
    #[pymodule_export]
    use super::warps::disk_to_square;
    #[pymodule_export]
    use super::warps::square_to_cosine_hemisphere;
    #[pymodule_export]
    use super::warps::square_to_cosine_hemisphere_pdf;
    #[pymodule_export]
    use super::warps::square_to_disk;
    #[pymodule_export]
    use super::warps::square_to_disk_pdf;
    #[pymodule_export]
    use super::warps::square_to_triangle;
    #[pymodule_export]
    use super::warps::square_to_triangle_pdf;
    #[pymodule_export]
    use super::warps::triangle_to_square;
}
