//! Generators, sequences, and warps with their densities.
