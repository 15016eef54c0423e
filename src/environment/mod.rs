//! Light from all around.
//!
//! - [`panorama`]: equirectangular pictures of radiance: looked up, drawn from by importance

pub mod panorama;
