//! Reflection models: evaluation, sampling, density.
