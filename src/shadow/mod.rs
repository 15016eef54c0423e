//! Shadow maps and their filters, and shadows by rays. Every lookup returns the lit fraction of the light, in [0, 1].
//!
//! - [`shadow_map`](mod@shadow_map): depth as the light sees it
//! - [`cascades`](mod@cascades): several maps that share the work, of a view's depths or of a cube's faces
//! - [`hard`]: one comparison
//! - [`pcf`]: percentage-closer filtering over a fixed width
//! - [`pcss`]: percentage-closer soft shadows, whose width follows from the blockers
//! - [`moment_map`](mod@moment_map): powers or exponentials of depth, which may be filtered beforehand
//! - [`variance`], [`exponential_variance`], [`moment`]: bounds on the lit fraction from two or four moments
//! - [`variance_soft`](mod@variance_soft): the same, as wide as the blockers' mean depth asks for
//! - [`ray_traced`](mod@ray_traced): rays to the light
//!
//! The parts: `lookup` (the map, and where receivers fall), `anchor` (the bias, and the taps that filters share), `pattern` (where the taps of a filter
//! lie), `texels` (what depths are stored as), `filtered` (means of moments over a part of a map), `tested` (the bounds,
//! and lookups by any of them), `fit` (what a map's window must hold).

pub(crate) mod anchor;
pub mod cascades;
pub mod distance_field;
pub mod exponential_variance;
pub(crate) mod filtered;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // the face fits, the kernels do not
pub(crate) mod fit;
pub mod half_plane;
pub mod hard;
pub(crate) mod lookup;
pub mod moment;
pub mod moment_map;
pub(crate) mod pattern;
pub mod pcf;
pub mod pcss;
pub mod ray_traced;
pub mod shadow_map;
pub(crate) mod texels;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // as `fit`
pub(crate) mod tested;
pub mod variance;
pub mod variance_soft;
#[cfg_attr(not(feature = "python"), allow(dead_code))] // as `fit`
pub mod virtual_map;
