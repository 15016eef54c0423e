//! The rasterisation pipeline: coverage, depth, interpolation, G-buffer.
//!
//! `pipeline::draw` is the one way from clip space to pixels: vertices are snapped to a grid of 1/256 pixel, triangles
//! clipped and put into tiles, each tile decides coverage and depth in cache, and a `pipeline::Resolve` turns the
//! visible triangles of a tile into whatever picture is wanted. Nothing depends on the number of threads.
//!
//! - [`rasterize`](mod@rasterize): face, barycentrics and depth as pictures; depth alone
//! - [`interpolate`](mod@interpolate): vertex attributes and their screen derivatives
//! - [`g_buffer`](mod@g_buffer): position, normal and material beside them, in one pass
//! - [`render_lambert`](mod@render_lambert): a picture of a matte mesh in one pass
//!
//! The parts: `samples` (where the samples of a pixel lie), `clip` (polygons against near, far and guard planes), `setup`
//! (snapping, edge functions, planes of depth and barycentrics), `bin` (triangles to tiles), `tile` (exact coverage
//! and depth), `picture` (what tiles write into), `pipeline` (the stages in order).

pub mod g_buffer;
pub mod interpolate;
pub mod rasterize;
pub mod render_lambert;

pub(crate) mod bin;
pub(crate) mod clip;
pub(crate) mod picture;
pub(crate) mod pipeline;
mod region;
pub(crate) mod samples;
pub(crate) mod setup;
pub(crate) mod tile;

pub use g_buffer::{GBuffer, Surface, g_buffer};
pub use interpolate::{Attributes, Seen, View, derivatives, interpolate};
pub use pipeline::Options;
pub use rasterize::{Visibility, rasterize, rasterize_behind, rasterize_depth, rasterize_pages};
pub use render_lambert::{Shading, render_lambert};

/// The largest width and height: with the guard band, edge functions over a tile then fit 32 bits.
pub const MAX_SIZE: usize = 16384;

/// Which faces are dropped. Counter-clockwise on the screen, y up, is front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cull {
    None,
    Back,
    Front,
}

/// What `z / w` means: the range between the planes, and which end is near.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// -1 near, 1 far.
    Standard,
    /// 0 near, 1 far.
    ZeroToOne,
    /// 1 near, 0 far.
    Reversed,
}

impl Depth {
    /// `z` of the low plane per unit of w; the high plane is `z = w` in every convention.
    pub fn low(self) -> f64 {
        if self == Depth::Standard { -1.0 } else { 0.0 }
    }
}
