//! The rasterisation pipeline: coverage, depth, interpolation, G-buffer.
