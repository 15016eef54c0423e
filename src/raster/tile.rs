//! Coverage and depth in one tile: the samples' nearest depths and the triangles they belong to, small enough for
//! the cache.
//!
//! Edge functions are brought to the tile's corner in 64 bits and divided by 256, rounded down, which no longer changes
//! their sign at samples; over a tile they then fit 32 bits, since edges that pass the tile by are dropped first.
//! Triangles come in the order of their faces, and only a strictly nearer depth replaces another: of equal
//! depths the lowest face wins.

use super::bin::{Bins, Grid, PIECE};
use super::samples::{SUBPIXEL_BITS, SUBPIXELS};
use super::setup::{Edges, Planes, Screen, area, planes};
use crate::real::Real;

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

    /// Starts an empty tile.
    fn clear(&mut self, index: usize, scene: &Scene<T>) {
        (self.x, self.y) = (index % scene.grid.columns * TILE, index / scene.grid.columns * TILE);
        self.width = TILE.min(scene.screen.width - self.x);
        self.height = TILE.min(scene.screen.height - self.y);
        self.depth.fill(T::INFINITY);
        self.ids.fill(NONE);
        self.visible.clear();
    }

    /// Draws all triangles of tile `index`.
    #[inline(always)]
    pub fn draw(&mut self, index: usize, scene: &Scene<T>) {
        self.clear(index, scene);
        for bins in scene.bins {
            for &entry in bins.entries(index) {
                if entry & PIECE == 0 {
                    let face = scene.faces[entry as usize];
                    let [i, j, k] = [face[0] as usize, face[1] as usize, face[2] as usize];
                    let vertices = [scene.snapped[i], scene.snapped[j], scene.snapped[k]];
                    self.draw_triangle(scene, &vertices, || {
                        let clip = [scene.clip[i], scene.clip[j], scene.clip[k]];
                        let [x, y] = vertices[farthest(&clip)];
                        let reference = [x >> SUBPIXEL_BITS, y >> SUBPIXEL_BITS];
                        planes(entry as i32, clip, reference, scene.screen)
                    });
                } else {
                    let piece = bins.pieces[(entry & !PIECE) as usize];
                    self.draw_triangle(scene, &piece.vertices, || {
                        // Cut triangles are few and may be huge: their planes are worth double precision.
                        let clip = scene.faces[piece.face as usize].map(|k| scene.clip[k as usize]);
                        let clip = clip.map(|v| v.map(|c| c.to_f64()));
                        planes(piece.face as i32, clip, piece.reference, scene.screen).to()
                    });
                }
            }
        }
    }

    #[inline(always)]
    fn draw_triangle(&mut self, scene: &Scene<T>, v: &[[i32; 2]; 3], planes: impl Fn() -> Planes<T>) {
        let v = if area(v) > 0 { *v } else { [v[0], v[2], v[1]] };
        let [[x0, x1], [y0, y1]] = scene.grid.bounds(&v);
        let (tx, ty) = (self.x as i32, self.y as i32);
        let (x0, x1) = ((x0 - tx).max(0), (x1 - tx).min(self.width as i32 - 1));
        let (y0, y1) = ((y0 - ty).max(0), (y1 - ty).min(self.height as i32 - 1));
        let mut edges = Edges::new(&v, [tx << SUBPIXEL_BITS, ty << SUBPIXEL_BITS]);
        // Edges of small triangles fit 32 bits over the tile as they are; others only if they cross it.
        if large(&v) {
            for i in 0..3 {
                let (least, most) = edges.range(i, (TILE as i64) << SUBPIXEL_BITS);
                if most < 0 {
                    return;
                }
                if least >= 0 {
                    (edges.a[i], edges.b[i], edges.c[i]) = (0, 0, 0);
                }
            }
        }
        let id = self.visible.len() as u32;
        for sample in 0..self.samples.len() {
            let [sx, sy] = self.samples[sample];
            let mut corner = [0i32; 3];
            let mut steps = [[0i32; LANES]; 3];
            for i in 0..3 {
                let c = edges.c[i] + edges.a[i] as i64 * sx as i64 + edges.b[i] as i64 * sy as i64;
                corner[i] = (c >> SUBPIXEL_BITS) as i32;
                for l in 0..LANES {
                    steps[i][l] = edges.a[i] * l as i32;
                }
            }
            for y in y0..=y1 {
                let mut x = x0;
                while x <= x1 {
                    let mut e = [0i32; 3];
                    for i in 0..3 {
                        e[i] = corner[i] + edges.b[i] * y + edges.a[i] * x;
                    }
                    let outside = outside(e, &steps);
                    if outside.iter().fold(-1, |all, &lane| all & lane) >= 0 {
                        if self.visible.len() as u32 == id {
                            self.visible.push(planes());
                        }
                        self.test(id, &outside, sample, x as usize, y as usize);
                    }
                    x += LANES as i32;
                }
            }
        }
    }

    /// Depth test of eight pixels of triangle `id`, of which those with a negative mark are outside.
    #[inline(always)]
    fn test(&mut self, id: u32, outside: &[i32; LANES], sample: usize, x: usize, y: usize) {
        let [ox, oy] = self.offset(sample);
        let p = self.visible[id as usize];
        // Pixels and offsets are small multiples of 1/16: these differences are exact.
        let dx = T::of((self.x + x) as f64) + ox - p.reference[0];
        let dy = T::of((self.y + y) as f64) + oy - p.reference[1];
        let at = (sample * TILE + y) * PITCH + x;
        let depth: &mut [T; LANES] = (&mut self.depth[at..at + LANES]).try_into().expect("eight lanes");
        let ids: &mut [u32; LANES] = (&mut self.ids[at..at + LANES]).try_into().expect("eight lanes");
        for l in 0..LANES {
            let z = p.depth_at(dx + T::of(l as f64), dy);
            let nearer = (outside[l] >= 0) & (z < depth[l]);
            depth[l] = T::select(nearer, z, depth[l]);
            ids[l] = if nearer { id } else { ids[l] };
        }
    }
}

/// The vertex with the largest `w`, where the weights are smallest: planes taken about it lose least by cancellation.
#[inline(always)]
fn farthest<T: Real>(clip: &[[T; 4]; 3]) -> usize {
    let i = usize::from(clip[1][3] > clip[0][3]);
    if clip[2][3] > clip[i][3] { 2 } else { i }
}

/// Whether edge functions could exceed 32 bits over a tile that the triangle touches.
#[inline(always)]
fn large(v: &[[i32; 2]; 3]) -> bool {
    let limit = (TILE as u32) << SUBPIXEL_BITS;
    let mut span = 0;
    for axis in 0..2 {
        let low = v[0][axis].min(v[1][axis]).min(v[2][axis]);
        let high = v[0][axis].max(v[1][axis]).max(v[2][axis]);
        span = low.abs_diff(high).max(span);
    }
    span >= limit
}

/// Negative at those of eight pixels that an edge function `e + step` excludes.
#[inline(always)]
fn outside(e: [i32; 3], steps: &[[i32; LANES]; 3]) -> [i32; LANES] {
    let mut out = [0; LANES];
    for l in 0..LANES {
        out[l] = (e[0] + steps[0][l]) | (e[1] + steps[1][l]) | (e[2] + steps[2][l]);
    }
    out
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
