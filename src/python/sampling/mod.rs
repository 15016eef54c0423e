//! Bindings of `sampling`, a file for each of its faces.

mod directions;
mod evenness;
mod generators;
mod markov;
mod sequences;
mod sets;
mod tabulated;
mod warps;

use pyo3::prelude::*;

#[pymodule]
pub mod sampling {
    #[pymodule_export]
    use super::directions::{
        area_to_solid_angle, cone_to_square, sphere_to_square, spherical_rectangle_to_square,
        spherical_triangle_to_square, square_to_cone, square_to_cone_pdf, square_to_sphere,
        square_to_sphere_pdf, square_to_spherical_rectangle, square_to_spherical_rectangle_pdf,
        square_to_spherical_triangle, square_to_spherical_triangle_pdf,
    };
    #[pymodule_export]
    use super::evenness::{discrepancy, power_spectrum, star_discrepancy};
    #[pymodule_export]
    use super::generators::{philox, sampler, sampler_names, uniform};
    #[pymodule_export]
    use super::sequences::{halton, latin_hypercube, multi_jittered, r2, sobol, stratified};
    #[pymodule_export]
    use super::sets::{blue_noise_mask, fibonacci_sphere, poisson_disk, vogel_disk};
    #[pymodule_export]
    const SEQUENCE_DIMENSIONS: usize = super::sequences::SEQUENCE_DIMENSIONS;
    #[pymodule_export]
    use super::markov::{gibbs, metropolis_hastings};
    #[pymodule_export]
    use super::tabulated::{Table1D, Table2D, alias_table, sample_alias};
    #[pymodule_export]
    use super::warps::{
        cosine_hemisphere_to_square, disk_to_square, hemisphere_to_square, square_to_cosine_hemisphere,
        square_to_cosine_hemisphere_pdf, square_to_disk, square_to_disk_pdf, square_to_hemisphere,
        square_to_hemisphere_pdf, square_to_triangle, square_to_triangle_pdf, triangle_to_square,
    };
}
