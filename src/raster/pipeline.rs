//! The stages from clip space to pixels, in order: snap vertices, bin triangles, draw tiles, resolve each tile.

use super::bin::{self, Bins, Grid};
use super::samples;
use super::setup::Screen;
use super::tile::{Scene, Tile};
use super::{Cull, Depth, MAX_SIZE};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::simd::Simd;
use std::sync::{Mutex, PoisonError};

/// The picture and how triangles cover it.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    pub width: usize,
    pub height: usize,
    /// Samples of a pixel: 1, 2, 4 or 8.
    pub samples: usize,
    pub cull: Cull,
    pub depth: Depth,
}

/// What becomes of a tile once its visible triangles are known. Runs inside the SIMD dispatch of its task.
pub trait Resolve<T: Real>: Sync {
    /// Whether triangles must lie behind what [`Resolve::before`] gives.
    const BEHIND: bool = false;

    /// Whether tile `index`, of `columns` to a row, is drawn at all.
    #[inline(always)]
    fn wants(&self, _index: usize, _columns: usize) -> bool {
        true
    }

    /// The depth that pixels of one row of a tile must exceed, where `BEHIND`; less is nearer.
    #[inline(always)]
    fn before(&self, _x: usize, _y: usize, _depth: &mut [T]) {}

    fn resolve<S: Simd>(&self, s: S, tile: &Tile<T>, scene: &Scene<T>);
}

/// Vertices of one task of the first stage.
const VERTICES: usize = 1 << 14;

/// Draws indexed triangles in clip space and hands each tile to `resolve`.
///
/// Every index must lie below `clip.len()`. Triangles with a vertex that is not finite are skipped.
pub fn draw<T: Real>(
    watch: &mut dyn Watch,
    clip: &[[T; 4]],
    faces: &[[i32; 3]],
    options: &Options,
    resolve: &impl Resolve<T>,
) -> Result<(), Interrupted> {
    assert!(
        options.width <= MAX_SIZE && options.height <= MAX_SIZE,
        "pictures are at most {MAX_SIZE} wide and high"
    );
    assert!(faces.len() < bin::PIECE as usize, "at most 2^31 - 1 faces");
    let samples = samples::positions(options.samples).expect("1, 2, 4 or 8 samples");
    let screen = Screen::new(options.width, options.height, options.depth);
    let grid = Grid::new(options, samples);

    let (snapped, bins) = binned(watch, clip, faces, &screen, &grid)?;

    // Draw and resolve tiles. Their buffers wait in a pool, since a tile is far cheaper than fresh memory.
    let scene = Scene { screen: &screen, grid: &grid, clip, snapped: &snapped, faces, bins: &bins };
    let idle: Mutex<Vec<Tile<T>>> = Mutex::new(Vec::new());
    parallel::run(watch, grid.tiles(), |index| {
        if !resolve.wants(index, grid.columns) {
            return;
        }
        let taken = idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut tile = taken.unwrap_or_else(|| Tile::new(samples));
        dispatch!(s => draw_tile(s, &mut tile, index, &scene, resolve));
        idle.lock().unwrap_or_else(PoisonError::into_inner).push(tile);
    })
}

/// Vertices snapped and triangles binned: compiled once a precision, whatever becomes of tiles.
fn binned<T: Real>(
    watch: &mut dyn Watch,
    clip: &[[T; 4]],
    faces: &[[i32; 3]],
    screen: &Screen,
    grid: &Grid,
) -> Result<(Vec<[i32; 2]>, Vec<Bins>), Interrupted> {
    // Snap vertices.
    let mut snapped = vec![[0i32; 2]; clip.len()];
    parallel::for_each(
        watch,
        (clip, &mut snapped[..]),
        VERTICES,
        |_, (clip, snapped)| dispatch!(_s => snap(screen, clip, snapped)),
    )?;

    // Bin triangles, in chunks small enough to balance and large enough that their tables of tiles are cheap.
    let chunk = (faces.len() / 64).clamp(1 << 10, 1 << 15);
    let mut bins: Vec<Bins> = Vec::new();
    bins.resize_with(faces.len().div_ceil(chunk), Bins::default);
    parallel::for_each(watch, &mut bins[..], 1, |i, bins| {
        let faces = &faces[i * chunk..faces.len().min((i + 1) * chunk)];
        dispatch!(_s => bin::bin(screen, grid, clip, &snapped, faces, i * chunk, &mut bins[0]))
    })?;
    Ok((snapped, bins))
}

#[inline(always)]
fn draw_tile<S: Simd, T: Real, R: Resolve<T>>(
    s: S,
    tile: &mut Tile<T>,
    index: usize,
    scene: &Scene<T>,
    resolve: &R,
) {
    tile.clear(index, scene);
    if R::BEHIND {
        tile.keep_behind(|x, y, depth| resolve.before(x, y, depth));
        tile.draw::<S, true>(s, index, scene);
    } else {
        tile.draw::<S, false>(s, index, scene);
    }
    resolve.resolve(s, tile, scene);
}

#[inline(always)]
fn snap<T: Real>(screen: &Screen, clip: &[[T; 4]], snapped: &mut [[i32; 2]]) {
    for (v, out) in clip.iter().zip(snapped) {
        *out = screen.snap_or_mark([v[0].to_f64(), v[1].to_f64(), v[2].to_f64(), v[3].to_f64()]);
    }
}
