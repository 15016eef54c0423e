//! Generators, sequences, and warps with their densities.
//!
//! - [`generator`]: a random number for every (seed, pixel, sample, dimension)
//! - [`sobol`]: Sobol' sequences and Owen's scrambling (`joe_kuo` holds their direction numbers)
//! - [`disk`], [`triangle`], [`sphere`], [`hemisphere`], [`cosine_hemisphere`], [`cone`], [`spherical_triangle`],
//!   [`spherical_rectangle`]: the unit square warped onto each, with inverses and densities
//! - [`area_to_solid_angle`]: a density of another measure
//! - [`tabulated`], [`alias_table`]: points and indices in proportion to given weights

pub mod alias_table;
pub mod area_to_solid_angle;
pub mod cone;
pub mod cosine_hemisphere;
pub mod disk;
pub mod generator;
pub mod hemisphere;
mod joe_kuo;
pub mod sobol;
pub mod sphere;
pub mod spherical_rectangle;
pub mod spherical_triangle;
pub mod tabulated;
pub mod triangle;

use crate::real::Real;

/// A point of the closed unit square as it is; NaN beyond it, where no warp holds.
#[inline(always)]
fn in_square<T: Real>(u: [T; 2]) -> [T; 2] {
    let unit = T::zero()..=T::one();
    if unit.contains(&u[0]) && unit.contains(&u[1]) { u } else { [T::NAN; 2] }
}
