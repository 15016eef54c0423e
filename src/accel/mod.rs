//! Acceleration structures for ray queries.
