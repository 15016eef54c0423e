//! Pictures as arrays of linear values: how far two of them differ.
//!
//! - [`error_metrics`]: root mean square, relative mean square, symmetric mean absolute percentage error

pub mod error_metrics;
