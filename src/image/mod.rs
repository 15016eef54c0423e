//! Pictures as arrays of linear values: filters, sums over rectangles, pyramids, and how far two pictures differ.
//!
//! - [`gaussian_filter`](mod@gaussian_filter): separable
//! - [`summed_area_table`](mod@summed_area_table): sums over all rectangles
//! - [`mip_chain`]: a picture at half the size, again and again
//! - [`error_metrics`]: root mean square, relative mean square, symmetric mean absolute percentage error

pub mod error_metrics;
pub mod gaussian_filter;
pub mod mip_chain;
pub mod summed_area_table;
