//! Path tracing: the reference.
