//! Shadow maps and their filters, and shadows by rays. Every lookup returns the lit fraction of the light, in [0, 1].
//!
//! - [`shadow_map`](mod@shadow_map): depth as the light sees it
//! - [`hard`]: one comparison
//! - [`pcf`]: percentage-closer filtering over a fixed width
//! - [`pcss`]: percentage-closer soft shadows, whose width follows from the blockers
//! - [`ray_traced`](mod@ray_traced): rays to the light
//!
//! The parts: `lookup` (the map, the bias, and the taps that all filters share), `pattern` (where the taps of a filter lie),
//! `fit` (what a map's window must hold).

#[cfg_attr(not(feature = "python"), allow(dead_code))] // the face fits, the kernels do not
pub(crate) mod fit;
pub mod hard;
pub(crate) mod lookup;
pub(crate) mod pattern;
pub mod pcf;
pub mod pcss;
pub mod ray_traced;
pub mod shadow_map;
