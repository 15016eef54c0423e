//! A picture of a matte mesh in one pass: transform, rasterise, interpolate normals, shade, and write nothing but
//! the picture. What a G-buffer would carry through memory stays in the tile.
//!
//! The shade is `color · max(0, n · l)` with the interpolated normal brought to unit length at every sample
//! (J. H. Lambert, *Photometria*, 1760; B. T. Phong, *Illumination for Computer Generated Pictures*, 1975), and a pixel
//! is the mean of its samples.

use super::picture::Picture;
use super::pipeline::{Options, Resolve, draw};
use super::setup::clamped;
use super::tile::{LANES, PITCH, Scene, Tile, columns, run_end};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::*;
use crate::vec::{Mat4, Vec3};

/// What a pixel is made of.
#[derive(Clone, Copy, Debug)]
pub struct Shading<T> {
    /// Unit vector to the light.
    pub to_light: [T; 3],
    /// Linear colour of a surface that faces the light.
    pub color: [T; 3],
    /// Linear colour where there is no surface.
    pub background: [T; 3],
    /// Both sides are lit alike: `|n · l|`.
    pub two_sided: bool,
}

/// How a pixel is stored.
pub trait Pixel<T: Real>: Copy + Send {
    /// From the linear colour, which includes the background, and the fraction of samples covered.
    fn encode(color: [T; 3], coverage: T) -> Self;
}

impl<T: Real> Pixel<T> for [T; 3] {
    #[inline(always)]
    fn encode(color: [T; 3], _: T) -> Self {
        color
    }
}

/// Linear codes of 8 bits, rounded to nearest; the coverage as alpha.
impl<T: Real> Pixel<T> for [u8; 4] {
    #[inline(always)]
    fn encode([r, g, b]: [T; 3], coverage: T) -> Self {
        [code(r), code(g), code(b), code(coverage)]
    }
}

/// The nearest of 256 codes; NaN becomes 0.
#[inline(always)]
fn code<T: Real>(c: T) -> u8 {
    let c = Lanes::min(Lanes::max(c, T::zero()), T::one());
    T::low_bits(c * T::of(255.0) + T::ROUND_MAGIC) as u8
}

/// Draws a mesh as a picture of `height · width` pixels. Every index must lie below the number of vertices.
pub fn render_lambert<T: Real, P: Pixel<T>>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    normals: &[[T; 3]],
    faces: &[[i32; 3]],
    matrix: Mat4<T>,
    options: &Options,
    shading: &Shading<T>,
    out: &mut [P],
) -> Result<(), Interrupted> {
    let mut clip = vec![[T::zero(); 4]; positions.len()];
    parallel::for_each(
        watch,
        (positions, &mut clip[..]),
        1 << 14,
        |_, (positions, clip)| dispatch!(_s => transform(&matrix, positions, clip)),
    )?;
    let out = Picture::new(out, options.width, options.height);
    draw(watch, &clip, faces, options, &Lambert { out, normals, shading: *shading })
}

#[inline(always)]
fn transform<T: Real>(matrix: &Mat4<T>, positions: &[[T; 3]], clip: &mut [[T; 4]]) {
    for (p, out) in positions.iter().zip(clip) {
        *out = matrix.mul_point((*p).into()).to_array();
    }
}

struct Lambert<'a, T, P> {
    out: Picture<'a, P>,
    normals: &'a [[T; 3]],
    shading: Shading<T>,
}

impl<T: Real, P: Pixel<T>> Lambert<'_, T, P> {
    #[inline(always)]
    fn normal(&self, vertex: i32) -> Vec3<T> {
        self.normals[vertex as usize].into()
    }

    /// The cosine at pixels of one triangle; zero where the normal vanishes.
    #[inline(always)]
    fn cosines<V: Lanes<Elem = T>>(&self, weights: &[[T; 3]; 3], n: &[Vec3<T>; 3], dx: V, dy: T) -> V {
        let [w0, w1, w2] = clamped(weights, dx, dy);
        let in_lanes = |v: Vec3<T>| v.map(|c| dx.like(c));
        let normal = (in_lanes(n[0]) * w0 + in_lanes(n[1]) * w1) + in_lanes(n[2]) * w2;
        let cosine = normal.dot(in_lanes(self.shading.to_light.into()));
        let cosine = if self.shading.two_sided { cosine.abs() } else { cosine.max(dx.num(0.0)) };
        // Weights are known up to a factor, which the length takes away.
        let length = normal.length_squared().sqrt();
        cosine / length.max(dx.like(T::MIN_POSITIVE))
    }
}

impl<T: Real, P: Pixel<T>> Resolve<T> for Lambert<'_, T, P> {
    #[inline(always)]
    fn resolve<S: Simd>(&self, s: S, tile: &Tile<T>, scene: &Scene<T>) {
        let columns = columns::<T, S>(s);
        let (zero, one) = (T::V8::splat(s, T::zero()), T::V8::splat(s, T::one()));
        let Shading { color, background, .. } = self.shading;
        let share = T::one() / T::of(tile.samples() as f64);
        for y in 0..tile.height {
            // The sum of cosines, and how many samples are covered; over the tile's width and a lane's overhang.
            let mut sum = [T::zero(); PITCH];
            let mut covered = [T::zero(); PITCH];
            for sample in 0..tile.samples() {
                let [ox, oy] = tile.offset(sample);
                let ids = tile.ids(sample, y);
                let mut end = 0;
                while end < ids.len() {
                    let start = end;
                    end = run_end(ids, start);
                    let Some(p) = tile.visible.get(ids[start] as usize) else { continue };
                    let [i, j, k] = scene.faces[p.face as usize];
                    let n = [self.normal(i), self.normal(j), self.normal(k)];
                    let dy = T::of((tile.y + y) as i32 as f64) + oy - p.reference[1];
                    for x in (start..end).step_by(LANES) {
                        let dx = T::of((tile.x + x) as i32 as f64) + ox - p.reference[0];
                        let cosines = self.cosines(&p.weights, &n, columns + dx, dy);
                        // Lanes beyond the stretch belong to others.
                        let inside = columns.simd_lt(T::of((end - x) as i32 as f64));
                        let add = |to: &mut [T], v: T::V8<S>| {
                            (T::V8::from_slice(s, to) + inside.select(v, zero)).store_slice(to);
                        };
                        add(&mut sum[x..x + LANES], cosines);
                        add(&mut covered[x..x + LANES], one);
                    }
                }
            }
            // Sound: no other tile has these pixels.
            let out = unsafe { self.out.row(tile.x, tile.y + y, tile.width) };
            for (x, out) in out.iter_mut().enumerate() {
                let (shade, coverage) = (sum[x] * share, covered[x] * share);
                let mut mixed = [T::zero(); 3];
                for k in 0..3 {
                    mixed[k] = color[k] * shade + background[k] * (T::one() - coverage);
                }
                *out = P::encode(mixed, coverage);
            }
        }
    }
}
