//! Binary space partitioning, by planes across axes or by the planes of the triangles themselves.

mod aligned;
mod fragment;
mod polygon;

pub use aligned::build as axis_aligned;
pub use polygon::PolygonTree;
