//! What is seen at each sample: face, perspective-correct barycentrics and depth; or depth alone, as for a shadow map.

use super::picture::Picture;
use super::pipeline::{Options, Resolve, draw};
use super::tile::{NONE, Scene, TILE, TILE_BITS, Tile};
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;
use crate::simd::Simd;

/// Pictures of `height · width · samples` items each. A miss has face -1, zero coordinates and infinite depth.
pub struct Visibility<'a, T> {
    pub face: &'a mut [i32],
    pub u: &'a mut [T],
    pub v: &'a mut [T],
    /// `z / w` in the range of the depth convention.
    pub depth: &'a mut [T],
}

/// Draws indexed triangles in clip space. Every index must lie below `clip.len()`.
pub fn rasterize<T: Real>(
    watch: &mut dyn Watch,
    clip: &[[T; 4]],
    faces: &[[i32; 3]],
    options: &Options,
    out: Visibility<T>,
) -> Result<(), Interrupted> {
    let resolve = All::new(out, options);
    draw(watch, clip, faces, options, &resolve)
}

/// [`rasterize`], depth alone.
pub fn rasterize_depth<T: Real>(
    watch: &mut dyn Watch,
    clip: &[[T; 4]],
    faces: &[[i32; 3]],
    options: &Options,
    depth: &mut [T],
) -> Result<(), Interrupted> {
    let depth = Picture::new(depth, options.width * options.samples, options.height);
    draw(watch, clip, faces, options, &DepthOnly { depth })
}

/// [`rasterize_depth`] of what lies behind `first`, the picture that it gave: the second surface.
pub fn rasterize_behind<T: Real>(
    watch: &mut dyn Watch,
    clip: &[[T; 4]],
    faces: &[[i32; 3]],
    options: &Options,
    first: &[T],
    depth: &mut [T],
) -> Result<(), Interrupted> {
    let options = Options { samples: 1, ..*options };
    assert_eq!(first.len(), options.width * options.height, "a first picture of the same size");
    let reversed = options.depth == super::Depth::Reversed;
    let depth = DepthOnly { depth: Picture::new(depth, options.width, options.height) };
    draw(watch, clip, faces, &options, &Behind { depth, first, width: options.width, reversed })
}

/// [`rasterize_depth`] into pages of 2^`bits` pixels square, at least a tile: `table` says for each page of the picture,
/// row by row, which of `pages` it is, or -1 for one that is not drawn. The picture's sides are multiples of a page's.
pub fn rasterize_pages<T: Real>(
    watch: &mut dyn Watch,
    clip: &[[T; 4]],
    faces: &[[i32; 3]],
    options: &Options,
    (table, bits): (&[i32], u32),
    pages: &mut [T],
) -> Result<(), Interrupted> {
    let options = Options { samples: 1, ..*options };
    let side = 1 << bits;
    assert!(bits >= TILE_BITS && options.width.is_multiple_of(side) && options.height.is_multiple_of(side));
    let columns = options.width >> bits;
    assert_eq!(table.len(), columns * (options.height >> bits), "a table of all pages");
    let height = pages.len() >> bits;
    assert!(table.iter().all(|&slot| slot < 0 || ((slot as usize + 1) << bits) <= height), "pages for all");
    let pages = Picture::new(&mut pages[..height << bits], side, height);
    draw(watch, clip, faces, &options, &Pages { pages, table, bits, columns })
}

struct Behind<'a, T> {
    depth: DepthOnly<'a, T>,
    first: &'a [T],
    width: usize,
    reversed: bool,
}

impl<T: Real> Resolve<T> for Behind<'_, T> {
    const BEHIND: bool = true;

    #[inline(always)]
    fn before(&self, x: usize, y: usize, depth: &mut [T]) {
        let row = &self.first[y * self.width + x..][..depth.len()];
        for (to, &z) in depth.iter_mut().zip(row) {
            // Nothing lies behind what is not there.
            *to = if z < T::INFINITY && self.reversed { -z } else { z };
        }
    }

    #[inline(always)]
    fn resolve<S: Simd>(&self, s: S, tile: &Tile<T>, scene: &Scene<T>) {
        self.depth.resolve(s, tile, scene);
    }
}

struct Pages<'a, T> {
    pages: Picture<'a, T>,
    table: &'a [i32],
    bits: u32,
    columns: usize,
}

impl<T: Real> Pages<'_, T> {
    fn slot(&self, x: usize, y: usize) -> i32 {
        self.table[(y >> self.bits) * self.columns + (x >> self.bits)]
    }
}

impl<T: Real> Resolve<T> for Pages<'_, T> {
    fn wants(&self, index: usize, columns: usize) -> bool {
        self.slot(index % columns * TILE, index / columns * TILE) >= 0
    }

    #[inline(always)]
    fn resolve<S: Simd>(&self, _: S, tile: &Tile<T>, scene: &Scene<T>) {
        let sign = if scene.screen.reversed { -T::one() } else { T::one() };
        let (slot, mask) = (self.slot(tile.x, tile.y) as usize, (1 << self.bits) - 1);
        for y in 0..tile.height {
            let row = (slot << self.bits) + ((tile.y + y) & mask);
            // Sound: no other tile has these pixels, and no two pages one slot (the face gives each its own).
            let out = unsafe { self.pages.row(tile.x & mask, row, tile.width) };
            for (to, &z) in out.iter_mut().zip(tile.depths(0, y)) {
                *to = if z < T::INFINITY { sign * z } else { T::INFINITY };
            }
        }
    }
}

pub(crate) struct DepthOnly<'a, T> {
    depth: Picture<'a, T>,
}

impl<T: Real> Resolve<T> for DepthOnly<'_, T> {
    #[inline(always)]
    fn resolve<S: Simd>(&self, _: S, tile: &Tile<T>, scene: &Scene<T>) {
        let n = tile.samples();
        let sign = if scene.screen.reversed { -T::one() } else { T::one() };
        for y in 0..tile.height {
            // Sound: no other tile has these pixels.
            let out = unsafe { self.depth.row(tile.x * n, tile.y + y, tile.width * n) };
            for sample in 0..n {
                for (x, &z) in tile.depths(sample, y).iter().enumerate() {
                    out[x * n + sample] = if z < T::INFINITY { sign * z } else { T::INFINITY };
                }
            }
        }
    }
}

/// Writes every picture of a [`Visibility`].
pub(crate) struct All<'a, T> {
    face: Picture<'a, i32>,
    u: Picture<'a, T>,
    v: Picture<'a, T>,
    depth: DepthOnly<'a, T>,
}

impl<'a, T> All<'a, T> {
    pub fn new(out: Visibility<'a, T>, options: &Options) -> Self {
        let (w, h) = (options.width * options.samples, options.height);
        All {
            face: Picture::new(out.face, w, h),
            u: Picture::new(out.u, w, h),
            v: Picture::new(out.v, w, h),
            depth: DepthOnly { depth: Picture::new(out.depth, w, h) },
        }
    }
}

impl<T: Real> Resolve<T> for All<'_, T> {
    #[inline(always)]
    fn resolve<S: Simd>(&self, s: S, tile: &Tile<T>, scene: &Scene<T>) {
        self.depth.resolve(s, tile, scene);
        let n = tile.samples();
        for y in 0..tile.height {
            let (at, row, width) = (tile.x * n, tile.y + y, tile.width * n);
            // Sound: no other tile has these pixels.
            let (face, u, v) = unsafe {
                (self.face.row(at, row, width), self.u.row(at, row, width), self.v.row(at, row, width))
            };
            for sample in 0..n {
                for (x, &id) in tile.ids(sample, y).iter().enumerate() {
                    let i = x * n + sample;
                    (face[i], u[i], v[i]) = (-1, T::zero(), T::zero());
                    if id != NONE {
                        let p = &tile.visible[id as usize];
                        let [pu, pv] = tile.barycentrics(p, sample, x, y);
                        (face[i], u[i], v[i]) = (p.face, pu, pv);
                    }
                }
            }
        }
    }
}
