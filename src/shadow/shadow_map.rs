//! The depth of a scene as a light sees it, linear along the light's axis.
//!
//! Triangles go through the rasteriser with reversed depth: near / depth under perspective, whose rounding is
//! relative to the depth itself at any distance, so that the linear depth has the full precision of the format.
//!
//! L. Williams, *Casting Curved Shadows on Curved Surfaces*, 1978.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::raster::{self, Cull, Options};
use crate::real::Real;

/// The light's view: see `lookup` for the frame and the window.
#[derive(Clone, Copy)]
pub struct View {
    pub origin: [f64; 3],
    /// Unit vectors: right, up, axis.
    pub frame: [[f64; 3]; 3],
    /// Left, right, bottom, top.
    pub window: [f64; 4],
    /// Nothing nearer or farther is drawn; `far` matters to orthographic views alone.
    pub near: f64,
    pub far: f64,
    pub perspective: bool,
}

/// Depth at every texel centre of `width` × `height`, infinite where there is nothing. Indices must lie below
/// `positions.len()`.
pub fn shadow_map<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    view: &View,
    [width, height]: [usize; 2],
    cull: Cull,
    depth: &mut [T],
) -> Result<(), Interrupted> {
    let mut clip = vec![[T::zero(); 4]; positions.len()];
    parallel::for_each(
        watch,
        (positions, &mut clip[..]),
        1 << 14,
        |_, (p, clip)| dispatch!(_s => project(view, p, clip)),
    )?;
    let options = Options { width, height, samples: 1, cull, depth: raster::Depth::Reversed };
    raster::rasterize_depth(watch, &clip, faces, &options, depth)?;
    parallel::for_each(watch, depth, 1 << 16, |_, z| dispatch!(_s => linearise(view, z)))
}

/// Into clip space, in double precision whatever the positions' own.
#[inline(always)]
fn project<T: Real>(view: &View, positions: &[[T; 3]], clip: &mut [[T; 4]]) {
    let [left, right, bottom, top] = view.window;
    for (p, out) in positions.iter().zip(clip) {
        let mut local = [0.0; 3];
        for (row, l) in view.frame.iter().zip(&mut local) {
            for k in 0..3 {
                *l += row[k] * (p[k].to_f64() - view.origin[k]);
            }
        }
        let [x, y, d] = local;
        let (z, w) =
            if view.perspective { (view.near, d) } else { ((view.far - d) / (view.far - view.near), 1.0) };
        let cx = (2.0 * x - (left + right) * w) / (right - left);
        let cy = (2.0 * y - (bottom + top) * w) / (top - bottom);
        *out = [T::of(cx), T::of(cy), T::of(z), T::of(w)];
    }
}

/// From reversed depth to depth; infinity stays.
#[inline(always)]
fn linearise<T: Real>(view: &View, depth: &mut [T]) {
    let (near, far) = (T::of(view.near), T::of(view.far));
    let range = T::of(view.far - view.near);
    for z in depth {
        let linear = if view.perspective { near / *z } else { far - *z * range };
        *z = if *z < T::INFINITY { linear } else { T::INFINITY };
    }
}
