//! The G-buffer: what deferred shading asks of each sample, in one pass.
//!
//! M. Deering et al., *The Triangle Processor and Normal Vector Shader*, 1988.
//! T. Saito, T. Takahashi, *Comprehensible Rendering of 3-D Shapes*, 1990.

use super::interpolate::mix;
use super::picture::Picture;
use super::pipeline::{Options, Resolve, draw};
use super::rasterize::{All, Visibility};
use super::tile::{NONE, Scene, Tile};
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;
use crate::simd::Simd;
use crate::vec::Vec3;

/// The mesh beside its positions in clip space.
#[derive(Clone, Copy)]
pub struct Surface<'a, T> {
    pub positions: &'a [[T; 3]],
    /// At the vertices; without them, each face has its own normal.
    pub normals: Option<&'a [[T; 3]]>,
    /// Of each face; without them, all are 0.
    pub material_ids: Option<&'a [i32]>,
}

/// Pictures of `height · width · samples` items each; where there is no face, `face` and `material` are -1, depth is
/// infinite, and the rest is zero.
pub struct GBuffer<'a, T> {
    pub visibility: Visibility<'a, T>,
    pub position: &'a mut [[T; 3]],
    pub normal: &'a mut [[T; 3]],
    pub material: &'a mut [i32],
}

/// Draws indexed triangles in clip space with their attributes. Indices must be in range.
pub fn g_buffer<T: Real>(
    watch: &mut dyn Watch,
    clip: &[[T; 4]],
    faces: &[[i32; 3]],
    surface: Surface<T>,
    options: &Options,
    out: GBuffer<T>,
) -> Result<(), Interrupted> {
    let (w, h) = (options.width * options.samples, options.height);
    let resolve = Geometry {
        visibility: All::new(out.visibility, options),
        surface,
        position: Picture::new(out.position, w, h),
        normal: Picture::new(out.normal, w, h),
        material: Picture::new(out.material, w, h),
    };
    draw(watch, clip, faces, options, &resolve)
}

struct Geometry<'a, T> {
    visibility: All<'a, T>,
    surface: Surface<'a, T>,
    position: Picture<'a, [T; 3]>,
    normal: Picture<'a, [T; 3]>,
    material: Picture<'a, i32>,
}

impl<T: Real> Geometry<'_, T> {
    /// Position and unit normal at `(u, v)` of a face; a vanishing normal stays zero.
    #[inline(always)]
    fn point(&self, [a, b, c]: [i32; 3], u: T, v: T) -> ([T; 3], [T; 3]) {
        let corners = |values: &[[T; 3]]| [values[a as usize], values[b as usize], values[c as usize]];
        let [pa, pb, pc] = corners(self.surface.positions);
        let normal = match self.surface.normals {
            Some(normals) => blend(corners(normals), u, v),
            None => (Vec3::from(pb) - pa.into()).cross(Vec3::from(pc) - pa.into()),
        };
        let vanishes = normal.x == T::zero() && normal.y == T::zero() && normal.z == T::zero();
        let unit = if vanishes { normal } else { normal.normalize() };
        (blend([pa, pb, pc], u, v).to_array(), unit.to_array())
    }
}

#[inline(always)]
fn blend<T: Real>([a, b, c]: [[T; 3]; 3], u: T, v: T) -> Vec3<T> {
    Vec3::new(mix(a[0], b[0], c[0], u, v), mix(a[1], b[1], c[1], u, v), mix(a[2], b[2], c[2], u, v))
}

impl<T: Real> Resolve<T> for Geometry<'_, T> {
    #[inline(always)]
    fn resolve<S: Simd>(&self, s: S, tile: &Tile<T>, scene: &Scene<T>) {
        self.visibility.resolve(s, tile, scene);
        let n = tile.samples();
        for y in 0..tile.height {
            let (at, row, width) = (tile.x * n, tile.y + y, tile.width * n);
            // Sound: no other tile has these pixels.
            let (position, normal, material) = unsafe {
                (
                    self.position.row(at, row, width),
                    self.normal.row(at, row, width),
                    self.material.row(at, row, width),
                )
            };
            for sample in 0..n {
                for (x, &id) in tile.ids(sample, y).iter().enumerate() {
                    let i = x * n + sample;
                    (position[i], normal[i], material[i]) = ([T::zero(); 3], [T::zero(); 3], -1);
                    if id != NONE {
                        let p = &tile.visible[id as usize];
                        let [u, v] = tile.barycentrics(p, sample, x, y);
                        (position[i], normal[i]) = self.point(scene.faces[p.face as usize], u, v);
                        material[i] = self.surface.material_ids.map_or(0, |ids| ids[p.face as usize]);
                    }
                }
            }
        }
    }
}
