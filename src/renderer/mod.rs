//! From the surfaces that pixels show to the light that they send to the eye.
//!
//! - [`shade`]: deferred shading of any material under any lights

mod lanes;
mod lit;
pub mod shade;
