//! Shadow maps and their filters.
