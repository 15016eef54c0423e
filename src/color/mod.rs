//! Transfer functions and tone mapping.
