//! Generators, sequences, and warps with their densities.
//!
//! - [`generator`]: a random number for every (seed, pixel, sample, dimension)
//! - [`sobol`]: Sobol' sequences and Owen's scrambling ([`joe_kuo`]: their direction numbers)

pub mod generator;
pub mod joe_kuo;
pub mod sobol;
