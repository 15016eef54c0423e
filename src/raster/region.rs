//! The pixels of a tile that a triangle may cover, and its edge functions about the tile's corner.
//!
//! Edge functions are brought to the tile's corner in 64 bits and divided by 256, rounded down, which no longer changes
//! their sign at samples; over a tile they then fit 32 bits, since edges that pass the tile by are dropped first.

use super::bin::Grid;
use super::samples::SUBPIXEL_BITS;
use super::setup::{Edges, area};
use super::tile::{LANES, TILE};
use crate::simd::*;
use fearless_simd::i32x8;

/// Pixels of a tile that a triangle may cover, and its edges about the tile's corner.
pub struct Region {
    pub edges: Edges,
    /// First and last column and row.
    pub x: [i32; 2],
    pub y: [i32; 2],
    /// At most eight by eight pixels.
    pub small: bool,
}

impl Region {
    /// Of a tile whose first pixel and sides are given; none if the triangle covers nothing there.
    #[inline(always)]
    pub fn of(grid: &Grid, corner: [usize; 2], side: [usize; 2], v: &[[i32; 2]; 3]) -> Option<Self> {
        let v = if area(v) > 0 { *v } else { [v[0], v[2], v[1]] };
        let [[x0, x1], [y0, y1]] = grid.bounds(&v);
        let (tx, ty) = (corner[0] as i32, corner[1] as i32);
        let x = [(x0 - tx).max(0), (x1 - tx).min(side[0] as i32 - 1)];
        let y = [(y0 - ty).max(0), (y1 - ty).min(side[1] as i32 - 1)];
        let mut edges = Edges::new(&v, [tx << SUBPIXEL_BITS, ty << SUBPIXEL_BITS]);
        // Edges of small triangles fit 32 bits over the tile as they are; others only if they cross it.
        let large = large(&v);
        if large {
            for i in 0..3 {
                let (least, most) = edges.range(i, (TILE as i64) << SUBPIXEL_BITS);
                if most < 0 {
                    return None;
                }
                if least >= 0 {
                    (edges.a[i], edges.b[i], edges.c[i]) = (0, 0, 0);
                }
            }
        }
        let small = !large & (x[1] - x[0] < LANES as i32) & (y[1] - y[0] < LANES as i32);
        Some(Region { edges, x, y, small })
    }

    /// Edge functions in pixels, rounded down, at a sample of the tile's first pixel.
    #[inline(always)]
    pub fn at_sample(&self, [sx, sy]: [i32; 2]) -> [i32; 3] {
        let mut out = [0; 3];
        for i in 0..3 {
            let e = &self.edges;
            let c = e.c[i] + e.a[i] as i64 * sx as i64 + e.b[i] as i64 * sy as i64;
            out[i] = (c >> SUBPIXEL_BITS) as i32;
        }
        out
    }

    /// Coverage of a small region, eight bits a row.
    #[inline(always)]
    pub fn rows<S: Simd>(&self, s: S, sample: [i32; 2]) -> u64 {
        let corner = self.at_sample(sample);
        let iota = i32x8::from_slice(s, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let Edges { a, b, .. } = self.edges;
        let mut e = [iota; 3];
        for i in 0..3 {
            e[i] = iota * a[i] + (corner[i] + a[i] * self.x[0] + b[i] * self.y[0]);
        }
        let mut rows = 0;
        for y in 0..=self.y[1] - self.y[0] {
            let inside = (e[0] | e[1] | e[2]).simd_ge(i32x8::splat(s, 0)).to_bitmask();
            rows |= inside << (LANES as i32 * y);
            for i in 0..3 {
                e[i] += b[i];
            }
        }
        rows
    }
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

/// Which of the eight pixels from `(x, y)` no edge excludes, by bits.
#[inline(always)]
pub fn edges_cover<S: Simd>(s: S, edges: &Edges, corner: &[i32; 3], x: i32, y: i32) -> u64 {
    let iota = i32x8::from_slice(s, &[0, 1, 2, 3, 4, 5, 6, 7]);
    let mut e = [iota; 3];
    for i in 0..3 {
        e[i] = iota * edges.a[i] + (corner[i] + edges.a[i] * x + edges.b[i] * y);
    }
    (e[0] | e[1] | e[2]).simd_ge(i32x8::splat(s, 0)).to_bitmask()
}
