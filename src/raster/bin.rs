//! Triangles to tiles: which triangles each tile must look at, in the order of their faces.
//!
//! Faces are taken in chunks whose bounds depend on nothing but their number. A chunk drops what is culled, empty or
//! between samples, cuts what crosses the near, far and guard planes, and sorts the rest by tile.

use super::clip;
use super::samples::SUBPIXEL_BITS;
use super::setup::{Edges, OUTSIDE, Screen, area};
use super::tile::{TILE, TILE_BITS};
use super::{Cull, Options};
use crate::real::Real;

/// One piece of a triangle that had to be cut.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    pub face: u32,
    /// Vertices in subpixels.
    pub vertices: [[i32; 2]; 3],
    /// The pixel about which the original triangle's planes are taken.
    pub reference: [i32; 2],
}

/// Set in an entry that indexes [`Bins::pieces`] instead of the faces.
pub const PIECE: u32 = 1 << 31;

/// The triangles of one chunk by tile.
#[derive(Default)]
pub struct Bins {
    /// Where each tile's entries start; one more than there are tiles.
    starts: Vec<u32>,
    entries: Vec<u32>,
    pub pieces: Vec<Piece>,
    /// Tile and entry in the order of the faces, before they are sorted.
    pairs: Vec<(u32, u32)>,
}

impl Bins {
    pub fn entries(&self, tile: usize) -> &[u32] {
        &self.entries[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }

    /// A counting sort by tile, which keeps the order of the faces.
    fn sort(&mut self, tiles: usize) {
        self.starts.clear();
        self.starts.resize(tiles + 1, 0);
        for &(tile, _) in &self.pairs {
            self.starts[tile as usize] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            (*start, sum) = (sum, sum + *start);
        }
        self.entries.clear();
        self.entries.resize(self.pairs.len(), 0);
        for &(tile, entry) in &self.pairs {
            let at = &mut self.starts[tile as usize];
            self.entries[*at as usize] = entry;
            *at += 1;
        }
        // Each start has moved on to the next one.
        self.starts.copy_within(..tiles, 1);
        self.starts[0] = 0;
    }
}

/// What binning needs to know of the picture.
pub struct Grid {
    pub columns: usize,
    pub rows: usize,
    cull: Cull,
    /// The least and the greatest sample position in a pixel, in subpixels.
    sample_range: [i32; 2],
    size: [i32; 2],
}

impl Grid {
    pub fn new(options: &Options, samples: &[[i32; 2]]) -> Self {
        let all = || samples.iter().flatten().copied();
        Self {
            columns: options.width.div_ceil(TILE),
            rows: options.height.div_ceil(TILE),
            cull: options.cull,
            sample_range: [all().min().unwrap_or(0), all().max().unwrap_or(0)],
            size: [options.width as i32, options.height as i32],
        }
    }

    pub fn tiles(&self) -> usize {
        self.columns * self.rows
    }

    /// The first and last pixel along an axis with a sample between `low` and `high`; empty if first > last.
    #[inline(always)]
    pub fn pixels(&self, low: i32, high: i32, axis: usize) -> [i32; 2] {
        let [first, last] = self.sample_range;
        let from = (low - last + ((1 << SUBPIXEL_BITS) - 1)) >> SUBPIXEL_BITS;
        let to = (high - first) >> SUBPIXEL_BITS;
        [from.max(0), to.min(self.size[axis] - 1)]
    }

    /// The bounds of a triangle in pixels that hold samples.
    #[inline(always)]
    pub fn bounds(&self, v: &[[i32; 2]; 3]) -> [[i32; 2]; 2] {
        let mut bounds = [[0; 2]; 2];
        for axis in 0..2 {
            let low = v[0][axis].min(v[1][axis]).min(v[2][axis]);
            let high = v[0][axis].max(v[1][axis]).max(v[2][axis]);
            bounds[axis] = self.pixels(low, high, axis);
        }
        bounds
    }

    #[inline(always)]
    fn culled(&self, area: i64) -> bool {
        // Counter-clockwise with y up is clockwise with y down reversed: the front has negative area here.
        match self.cull {
            Cull::None => area == 0,
            Cull::Back => area >= 0,
            Cull::Front => area <= 0,
        }
    }

    /// Lists a triangle in every tile that it may cover.
    #[inline(always)]
    fn list(&self, v: &[[i32; 2]; 3], entry: u32, pairs: &mut Vec<(u32, u32)>) {
        let area = area(v);
        if self.culled(area) {
            return;
        }
        let [[x0, x1], [y0, y1]] = self.bounds(v);
        if x0 > x1 || y0 > y1 {
            return;
        }
        let tile = |p: i32| p as usize >> TILE_BITS;
        let (columns, rows) = (tile(x0)..tile(x1) + 1, tile(y0)..tile(y1) + 1);
        if columns.len() * rows.len() <= 2 {
            for row in rows {
                for column in columns.clone() {
                    pairs.push(((row * self.columns + column) as u32, entry));
                }
            }
        } else {
            self.list_large(v, area, entry, columns, rows, pairs);
        }
    }

    /// As [`Grid::list`], without the tiles that lie beyond an edge.
    fn list_large(
        &self,
        v: &[[i32; 2]; 3],
        area: i64,
        entry: u32,
        columns: std::ops::Range<usize>,
        rows: std::ops::Range<usize>,
        pairs: &mut Vec<(u32, u32)>,
    ) {
        let v = if area > 0 { *v } else { [v[0], v[2], v[1]] };
        let size = 1i32 << (TILE_BITS + SUBPIXEL_BITS);
        for row in rows {
            for column in columns.clone() {
                let edges = Edges::new(&v, [column as i32 * size, row as i32 * size]);
                if (0..3).all(|i| edges.range(i, size as i64).1 >= 0) {
                    pairs.push(((row * self.columns + column) as u32, entry));
                }
            }
        }
    }
}

/// Bins the faces `first..first + faces.len()`.
#[inline(always)]
pub fn bin<T: Real>(
    screen: &Screen,
    grid: &Grid,
    clip: &[[T; 4]],
    snapped: &[[i32; 2]],
    faces: &[[i32; 3]],
    first: usize,
    bins: &mut Bins,
) {
    for (i, face) in faces.iter().enumerate() {
        let v = [snapped[face[0] as usize], snapped[face[1] as usize], snapped[face[2] as usize]];
        if (v[0][0] == OUTSIDE) | (v[1][0] == OUTSIDE) | (v[2][0] == OUTSIDE) {
            let triangle = face.map(|k| clip[k as usize].map(|c| c.to_f64()));
            bin_clipped(screen, grid, triangle, (first + i) as u32, bins);
        } else {
            grid.list(&v, (first + i) as u32, &mut bins.pairs);
        }
    }
    bins.sort(grid.tiles());
}

#[inline(never)]
fn bin_clipped(screen: &Screen, grid: &Grid, triangle: [[f64; 4]; 3], face: u32, bins: &mut Bins) {
    let polygon = clip::clip(triangle, screen);
    let corners = &polygon.vertices[..polygon.len];
    if corners.is_empty() {
        return;
    }
    let mut v = [[0i32; 2]; clip::MAX_VERTICES];
    let mut farthest = 0;
    for (i, corner) in corners.iter().enumerate() {
        v[i] = screen.snap(*corner);
        if corner[3] > corners[farthest][3] {
            farthest = i;
        }
    }
    let reference = v[farthest].map(|c| c >> SUBPIXEL_BITS);
    for vertices in fan(&v[..corners.len()]) {
        let entry = PIECE | bins.pieces.len() as u32;
        grid.list(&vertices, entry, &mut bins.pairs);
        bins.pieces.push(Piece { face, vertices, reference });
    }
}

/// The triangles of a convex polygon. Snapping may push one corner inwards by a subpixel; the apex is chosen such that
/// all triangles turn the same way, so that they still cover the polygon and nothing else.
fn fan(v: &[[i32; 2]]) -> impl Iterator<Item = [[i32; 2]; 3]> {
    let n = v.len();
    let from =
        move |apex: usize| (1..n - 1).map(move |i| [v[apex], v[(apex + i) % n], v[(apex + i + 1) % n]]);
    let even = |apex: usize| {
        let (mut some_left, mut some_right) = (false, false);
        for t in from(apex) {
            some_left |= area(&t) < 0;
            some_right |= area(&t) > 0;
        }
        !(some_left && some_right)
    };
    let apex = (0..n).find(|&i| even(i)).unwrap_or(0);
    from(apex)
}
