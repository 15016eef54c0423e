//! What is seen at each sample: face, perspective-correct barycentrics and depth; or depth alone, as for a shadow map.

use super::picture::Picture;
use super::pipeline::{Options, Resolve, draw};
use super::tile::{NONE, Scene, Tile};
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
