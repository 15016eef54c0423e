//! Light from all around.
//!
//! - [`panorama`]: equirectangular pictures of radiance: looked up, drawn from by importance

mod guided;
pub mod panorama;
