//! Colour: transfer functions, luminance, tone mapping. Values are linear and scene-referred unless a function
//! says otherwise, with sRGB primaries and white D65.
//!
//! - [`transfer`]: linear light to encoded signal and back
//! - [`tone_map`]: scene radiance to display light
//! - [`luminance`]: the Y of linear RGB

pub mod transfer;
pub mod tone_map;
pub mod luminance;
