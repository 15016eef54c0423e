//! Coverage and depth in one tile: the samples' nearest depths and the triangles they belong to, small enough for
//! the cache.
//!
//! Triangles come in the order of their faces, and only a strictly nearer depth replaces another: of equal
//! depths the lowest face wins.

use super::bin::{Bins, Grid, PIECE, Piece};
use super::region::{Region, edges_cover};
use super::samples::{SUBPIXEL_BITS, SUBPIXELS};
use super::setup::{Planes, Screen, planes, planes_in_lanes};
use crate::real::{Lanes, Real};
use crate::simd::*;
use fearless_simd::{mask32x8, u32x8};

pub const TILE_BITS: u32 = 6;
/// Pixels along a tile's side.
pub const TILE: usize = 1 << TILE_BITS;
/// Pixels that are tested at once.
pub const LANES: usize = 8;
/// Rows are padded, so that lanes may run over the right border.
pub const PITCH: usize = TILE + LANES;

/// No triangle covers the sample.
pub const NONE: u32 = u32::MAX;

/// Nearest depth and triangle of every sample of a tile.
pub struct Tile<T> {
    /// Pixels of the top left corner.
    pub x: usize,
    pub y: usize,
    /// Pixels within the picture.
    pub width: usize,
    pub height: usize,
    samples: &'static [[i32; 2]],
    /// By sample, row and column; less is nearer.
    depth: Vec<T>,
    /// What depths must exceed, of the first sample alone; empty unless asked for.
    before: Vec<T>,
    /// Indices into `visible`.
    ids: Vec<u32>,
    /// Every triangle that covers a sample.
    pub visible: Vec<Planes<T>>,
}

/// Everything that tiles of one picture share.
pub struct Scene<'a, T> {
    pub screen: &'a Screen,
    pub grid: &'a Grid,
    pub clip: &'a [[T; 4]],
    pub snapped: &'a [[i32; 2]],
    pub faces: &'a [[i32; 3]],
    pub bins: &'a [Bins],
}

impl<T: Real> Tile<T> {
    pub fn new(samples: &'static [[i32; 2]]) -> Self {
        let n = samples.len() * TILE * PITCH;
        Tile {
            x: 0,
            y: 0,
            width: 0,
            height: 0,
            samples,
            depth: vec![T::INFINITY; n],
            before: Vec::new(),
            ids: vec![NONE; n],
            visible: Vec::new(),
        }
    }

    /// Number of samples of a pixel.
    pub fn samples(&self) -> usize {
        self.samples.len()
    }

    /// Where a sample lies in its pixel.
    #[inline(always)]
    pub fn offset(&self, sample: usize) -> [T; 2] {
        let [x, y] = self.samples[sample];
        [T::of(x as f64 / SUBPIXELS as f64), T::of(y as f64 / SUBPIXELS as f64)]
    }

    /// Triangle of each pixel in a row of one sample: indices into `visible`, or [`NONE`].
    #[inline(always)]
    pub fn ids(&self, sample: usize, row: usize) -> &[u32] {
        &self.ids[(sample * TILE + row) * PITCH..][..self.width]
    }

    /// Depths of a row of one sample; less is nearer.
    #[inline(always)]
    pub fn depths(&self, sample: usize, row: usize) -> &[T] {
        &self.depth[(sample * TILE + row) * PITCH..][..self.width]
    }

    /// Where on triangle `p` a sample lies.
    #[inline(always)]
    pub fn barycentrics(&self, p: &Planes<T>, sample: usize, x: usize, y: usize) -> [T; 2] {
        let [ox, oy] = self.offset(sample);
        let dx = T::of((self.x + x) as i32 as f64) + ox - p.reference[0];
        let dy = T::of((self.y + y) as i32 as f64) + oy - p.reference[1];
        p.barycentrics_at(dx, dy)
    }

    /// Starts an empty tile.
    pub fn clear(&mut self, index: usize, scene: &Scene<T>) {
        (self.x, self.y) = (index % scene.grid.columns * TILE, index / scene.grid.columns * TILE);
        self.width = TILE.min(scene.screen.width - self.x);
        self.height = TILE.min(scene.screen.height - self.y);
        self.depth.fill(T::INFINITY);
        self.ids.fill(NONE);
        self.visible.clear();
    }

    /// Only what exceeds the depths that `before(x, y, row)` fills in is drawn: one sample a pixel.
    #[inline(always)]
    pub fn keep_behind(&mut self, before: impl Fn(usize, usize, &mut [T])) {
        self.before.clear();
        self.before.resize(TILE * PITCH, -T::INFINITY);
        for y in 0..self.height {
            before(self.x, self.y + y, &mut self.before[y * PITCH..][..self.width]);
        }
    }

    /// Draws all triangles of tile `index`, which was cleared.
    ///
    /// Enters the level anew: compiled once a level and precision, whatever becomes of the tile.
    #[inline(never)]
    pub fn draw<S: Simd, const BEHIND: bool>(&mut self, s: S, index: usize, scene: &Scene<T>) {
        s.vectorize(
            #[inline(always)]
            || self.draw_here::<S, BEHIND>(s, index, scene),
        )
    }

    #[inline(always)]
    fn draw_here<S: Simd, const BEHIND: bool>(&mut self, s: S, index: usize, scene: &Scene<T>) {
        let mut batch = Batch { triangles: [Small::default(); LANES], len: 0 };
        for bins in scene.bins {
            for &entry in bins.entries(index) {
                if entry & PIECE != 0 {
                    self.draw_batch::<S, BEHIND>(s, scene, &mut batch);
                    self.draw_piece::<S, BEHIND>(s, scene, &bins.pieces[(entry & !PIECE) as usize]);
                    continue;
                }
                let [i, j, k] = scene.faces[entry as usize];
                let vertices =
                    [scene.snapped[i as usize], scene.snapped[j as usize], scene.snapped[k as usize]];
                let Some(region) = self.region(scene.grid, &vertices) else { continue };
                if self.samples.len() == 1 && region.small {
                    let rows = region.rows(s, self.samples[0]);
                    if rows != 0 {
                        let [x, y] = [region.x[0] as u16, region.y[0] as u16];
                        batch.triangles[batch.len] = Small { face: entry, rows, x, y };
                        batch.len += 1;
                        if batch.len == LANES {
                            self.draw_batch::<S, BEHIND>(s, scene, &mut batch);
                        }
                    }
                } else {
                    self.draw_batch::<S, BEHIND>(s, scene, &mut batch);
                    self.draw_region::<S, BEHIND>(s, &region, || scene.planes(entry));
                }
            }
        }
        self.draw_batch::<S, BEHIND>(s, scene, &mut batch);
    }

    /// Cut triangles are few and may be huge: their planes are worth double precision.
    #[inline(always)]
    fn draw_piece<S: Simd, const BEHIND: bool>(&mut self, s: S, scene: &Scene<T>, piece: &Piece) {
        if let Some(region) = self.region(scene.grid, &piece.vertices) {
            self.draw_region::<S, BEHIND>(s, &region, || {
                let clip = scene.faces[piece.face as usize].map(|k| scene.clip[k as usize]);
                let clip = clip.map(|v| v.map(|c| c.to_f64()));
                planes(piece.face as i32, clip, piece.reference, scene.screen).to()
            });
        }
    }

    /// The planes of up to eight small triangles at once, then their depth tests one by one.
    #[inline(always)]
    fn draw_batch<S: Simd, const BEHIND: bool>(&mut self, s: S, scene: &Scene<T>, batch: &mut Batch) {
        if batch.len == 0 {
            return;
        }
        // Unused lanes repeat the first triangle.
        let mut clip = [[[T::zero(); LANES]; 4]; 3];
        let mut reference = [[T::zero(); LANES]; 2];
        for l in 0..LANES {
            let face = batch.triangles[if l < batch.len { l } else { 0 }].face;
            let (v, [x, y]) = scene.triangle(face);
            for i in 0..3 {
                for k in 0..4 {
                    clip[i][k][l] = v[i][k];
                }
            }
            reference[0][l] = T::of(x as f64);
            reference[1][l] = T::of(y as f64);
        }
        let lanes = |a: &[T; LANES]| T::V8::from_slice(s, a);
        let zero = T::V8::splat(s, T::zero());
        let mut v = [[zero; 4]; 3];
        for i in 0..3 {
            for k in 0..4 {
                v[i][k] = lanes(&clip[i][k]);
            }
        }
        let (weights, depth, range) =
            planes_in_lanes(v, [lanes(&reference[0]), lanes(&reference[1])], scene.screen);
        let first = self.visible.len();
        for (l, t) in batch.triangles[..batch.len].iter().enumerate() {
            let mut p = Planes {
                face: t.face as i32,
                reference: [reference[0][l], reference[1][l]],
                weights: [[T::zero(); 3]; 3],
                depth: [T::zero(); 3],
                depth_range: [range[0].as_slice()[l], range[1].as_slice()[l]],
            };
            for i in 0..3 {
                for k in 0..3 {
                    p.weights[i][k] = weights[i][k].as_slice()[l];
                }
                p.depth[i] = depth[i].as_slice()[l];
            }
            self.visible.push(p);
        }
        for (l, t) in batch.triangles[..batch.len].iter().enumerate() {
            let (mut rows, mut y) = (t.rows, t.y as usize);
            let p = self.visible[first + l];
            while rows != 0 {
                if rows & 0xff != 0 {
                    self.test::<S, BEHIND>(s, (first + l) as u32, &p, rows & 0xff, 0, t.x as usize, y);
                }
                rows >>= LANES;
                y += 1;
            }
        }
        batch.len = 0;
    }

    #[inline(always)]
    fn region(&self, grid: &Grid, v: &[[i32; 2]; 3]) -> Option<Region> {
        Region::of(grid, [self.x, self.y], [self.width, self.height], v)
    }

    /// Draws a triangle of any size; `planes` is asked for once a sample is covered.
    #[inline(always)]
    fn draw_region<S: Simd, const BEHIND: bool>(
        &mut self,
        s: S,
        region: &Region,
        planes: impl Fn() -> Planes<T>,
    ) {
        let Region { ref edges, x: [x0, x1], y: [y0, y1], .. } = *region;
        let id = self.visible.len() as u32;
        for sample in 0..self.samples.len() {
            let corner = region.at_sample(self.samples[sample]);
            for y in y0..=y1 {
                let mut x = x0;
                while x <= x1 {
                    let bits = edges_cover(s, edges, &corner, x, y);
                    if bits != 0 {
                        if self.visible.len() as u32 == id {
                            self.visible.push(planes());
                        }
                        let p = self.visible[id as usize];
                        self.test::<S, BEHIND>(s, id, &p, bits, sample, x as usize, y as usize);
                    }
                    x += LANES as i32;
                }
            }
        }
    }

    /// Depth test of eight pixels of triangle `id`, of which those in `bits` are covered.
    #[inline(always)]
    fn test<S: Simd, const BEHIND: bool>(
        &mut self,
        s: S,
        id: u32,
        p: &Planes<T>,
        bits: u64,
        sample: usize,
        x: usize,
        y: usize,
    ) {
        let [ox, oy] = self.offset(sample);
        // Pixels and offsets are small multiples of 1/16: these differences are exact.
        let dx = T::of((self.x + x) as i32 as f64) + ox - p.reference[0];
        let dy = T::of((self.y + y) as i32 as f64) + oy - p.reference[1];
        let at = (sample * TILE + y) * PITCH + x;
        let depth = &mut self.depth[at..at + LANES];
        let old = T::V8::from_slice(s, depth);
        let z = columns::<T, S>(s) + dx;
        let z = z * p.depth[0] + (p.depth[2] + p.depth[1] * dy);
        let z = Lanes::max(z, T::V8::splat(s, p.depth_range[0]));
        let z = Lanes::min(z, T::V8::splat(s, p.depth_range[1]));
        let mut bits = z.simd_lt(old).to_bitmask() & bits;
        if BEHIND {
            bits &= z.simd_gt(T::V8::from_slice(s, &self.before[at..at + LANES])).to_bitmask();
        }
        if bits == 0 {
            return;
        }
        let nearer = <T::V8<S> as SimdBase<S>>::Mask::from_bitmask(s, bits);
        nearer.select(z, old).store_slice(depth);
        let ids = &mut self.ids[at..at + LANES];
        let nearer = mask32x8::from_bitmask(s, bits);
        nearer.select(u32x8::splat(s, id), u32x8::from_slice(s, ids)).store_slice(ids);
    }
}

/// 0, 1 … 7.
#[inline(always)]
pub fn columns<T: Real, S: Simd>(s: S) -> T::V8<S> {
    let mut columns = [T::zero(); LANES];
    for l in 0..LANES {
        columns[l] = T::of(l as f64);
    }
    T::V8::from_slice(s, &columns)
}

impl<T: Real> Scene<'_, T> {
    /// Vertices of an uncut face, and the pixel about which its planes are taken: that of the vertex with the largest
    /// `w`, where the weights are smallest, so that least is lost by cancellation.
    #[inline(always)]
    fn triangle(&self, face: u32) -> ([[T; 4]; 3], [i32; 2]) {
        let [i, j, k] = self.faces[face as usize];
        let clip = [self.clip[i as usize], self.clip[j as usize], self.clip[k as usize]];
        let (mut farthest, mut w) = (i, clip[0][3]);
        for (vertex, v) in [(j, clip[1]), (k, clip[2])] {
            farthest = if v[3] > w { vertex } else { farthest };
            w = if v[3] > w { v[3] } else { w };
        }
        let [x, y] = self.snapped[farthest as usize];
        (clip, [x >> SUBPIXEL_BITS, y >> SUBPIXEL_BITS])
    }

    #[inline(always)]
    fn planes(&self, face: u32) -> Planes<T> {
        let (clip, reference) = self.triangle(face);
        planes(face as i32, clip, reference, self.screen)
    }
}

/// A triangle of at most eight by eight pixels whose planes wait to be computed with those of others.
#[derive(Clone, Copy, Default)]
struct Small {
    face: u32,
    /// Top left pixel in the tile, and which pixels are covered from there: eight bits a row.
    x: u16,
    y: u16,
    rows: u64,
}

struct Batch {
    triangles: [Small; LANES],
    len: usize,
}

/// The end of the stretch of equal triangles that starts at `start`.
#[inline(always)]
pub fn run_end(ids: &[u32], start: usize) -> usize {
    let mut end = start + 1;
    while end < ids.len() && ids[end] == ids[start] {
        end += 1;
    }
    end
}
