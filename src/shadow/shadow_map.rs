//! The depth of a scene as a light sees it, linear along the light's axis.
//!
//! Triangles go through the rasteriser with reversed depth: near / depth under perspective, whose rounding is
//! relative to the depth itself at any distance, so that the linear depth has the full precision of the format.
//!
//! L. Williams, *Casting Curved Shadows on Curved Surfaces*, 1978. Y. Wang, S. Molnar, *Second-Depth Shadow Mapping*,
//! 1994. A. Woo, *The Shadow Depth Map Revisited*, Graphics Gems III, 1992 (midpoint).

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::raster::{self, Cull, Options};
use crate::real::Real;
use crate::shadow::texels::Steps;

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

/// Which of the surfaces that a light's ray passes is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    First,
    /// The next behind it (Wang & Molnar 1994).
    Second,
    /// Half way between the two (Woo 1992).
    Midpoint,
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
    surface: Surface,
    depth: &mut [T],
) -> Result<(), Interrupted> {
    let clip = projected(watch, positions, view)?;
    let options = Options { width, height, samples: 1, cull, depth: raster::Depth::Reversed };
    raster::rasterize_depth(watch, &clip, faces, &options, depth)?;
    if surface == Surface::First {
        return linear(watch, view, depth);
    }
    let mut second = vec![T::INFINITY; depth.len()];
    raster::rasterize_behind(watch, &clip, faces, &options, depth, &mut second)?;
    if surface == Surface::Second {
        depth.copy_from_slice(&second);
        return linear(watch, view, depth);
    }
    linear(watch, view, depth)?;
    linear(watch, view, &mut second)?;
    let half = T::of(0.5);
    parallel::for_each(watch, (depth, &second[..]), 1 << 16, |_, (z, behind)| {
        dispatch!(_s => for i in 0..z.len() {
            z[i] = if behind[i] < T::INFINITY { (z[i] + behind[i]) * half } else { T::INFINITY };
        })
    })
}

/// [`shadow_map`] of those pages of 2^`bits` texels square that `table` gives a place in `pages`.
pub fn shadow_pages<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    view: &View,
    [width, height]: [usize; 2],
    table: (&[i32], u32),
    pages: &mut [T],
) -> Result<(), Interrupted> {
    let clip = projected(watch, positions, view)?;
    let options = Options { width, height, samples: 1, cull: Cull::None, depth: raster::Depth::Reversed };
    raster::rasterize_pages(watch, &clip, faces, &options, table, pages)?;
    linear(watch, view, pages)
}

/// Depths in equal steps: 16 bits, or 24 and 32 in 32.
pub fn quantize<T: Real, Q: Copy + Send>(
    watch: &mut dyn Watch,
    depth: &[T],
    steps: &Steps,
    of: impl Fn(u32) -> Q + Sync,
    out: &mut [Q],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (depth, out), 1 << 16, |_, (depth, out)| {
        for (z, out) in depth.iter().zip(out) {
            *out = of(steps.stored(*z));
        }
    })
}

fn projected<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    view: &View,
) -> Result<Vec<[T; 4]>, Interrupted> {
    let mut clip = vec![[T::zero(); 4]; positions.len()];
    parallel::for_each(
        watch,
        (positions, &mut clip[..]),
        1 << 14,
        |_, (p, clip)| dispatch!(_s => project(view, p, clip)),
    )?;
    Ok(clip)
}

fn linear<T: Real>(watch: &mut dyn Watch, view: &View, depth: &mut [T]) -> Result<(), Interrupted> {
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
