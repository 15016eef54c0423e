//! Virtual shadow maps: of a map too large to be held, the pages that a view looks into.
//!
//! A view's receivers choose the level whose texels are about as large as their pixels, mark the pages that their
//! filters read, and, at a lookup, take the next coarser level where theirs is not there.
//!
//! A. Lefohn, S. Sengupta, J. Owens, *Resolution-Matched Shadow Maps*, TOG 2007.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::shadow::lookup::Map;
use std::sync::atomic::{AtomicU8, Ordering};

/// Where the view is from, and how large a pixel is at unit distance.
#[derive(Clone, Copy, Debug)]
pub struct Pixels {
    pub eye: [f64; 3],
    pub size: f64,
}

/// The level of `count` whose texels are at most as large as the pixel at each receiver; 0 has those of `map`.
pub fn levels<T: Real, const PERSPECTIVE: bool>(
    watch: &mut dyn Watch,
    map: &Map<'_, T>,
    receivers: &[[T; 3]],
    pixels: &Pixels,
    count: usize,
    out: &mut [u8],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (receivers, out), 1 << 14, |_, (points, out)| {
        dispatch!(_s => for i in 0..points.len() {
            out[i] = level::<T, PERSPECTIVE>(map, points[i], pixels, count);
        })
    })
}

#[inline(always)]
fn level<T: Real, const PERSPECTIVE: bool>(
    map: &Map<'_, T>,
    point: [T; 3],
    pixels: &Pixels,
    count: usize,
) -> u8 {
    // Without a place on the map any level answers.
    let Some(foot) = map.foot::<PERSPECTIVE>(point) else { return 0 };
    let mut squared = 0.0;
    for k in 0..3 {
        let d = point[k].to_f64() - pixels.eye[k];
        squared += d * d;
    }
    let texel = map.larger_texel() * if PERSPECTIVE { foot.depth } else { T::one() };
    let (pixel, mut texel) = (pixels.size * squared.sqrt(), texel.to_f64());
    let mut level = 0;
    while level + 1 < count && texel * 2.0 <= pixel {
        texel *= 2.0;
        level += 1;
    }
    level as u8
}

/// Marks the pages, 2^`bits` texels square and `columns` to a row, that receivers and filters `border` texels about them
/// read.
pub fn mark<T: Real, const PERSPECTIVE: bool>(
    watch: &mut dyn Watch,
    map: &Map<'_, T>,
    receivers: &[[T; 3]],
    border: T,
    bits: u32,
    marks: &[AtomicU8],
) -> Result<(), Interrupted> {
    let columns = map.size()[0].div_ceil(1 << bits);
    parallel::for_each(watch, receivers, 1 << 14, |first, points| {
        for i in 0..points.len() {
            if map.skips(first + i) {
                continue;
            }
            let Some(foot) = map.foot::<PERSPECTIVE>(points[i]) else { continue };
            let (Some([x0, x1]), Some([y0, y1])) =
                (pages(foot.x, border, map.size()[0], bits), pages(foot.y, border, map.size()[1], bits))
            else {
                continue;
            };
            for y in y0..=y1 {
                for x in x0..=x1 {
                    // Sound in any order: all write the same.
                    marks[y * columns + x].store(1, Ordering::Relaxed);
                }
            }
        }
    })
}

/// The first and last page of those that hold a place and what lies `border` about it; `None` off the map.
#[inline(always)]
fn pages<T: Real>(x: T, border: T, size: usize, bits: u32) -> Option<[usize; 2]> {
    let (low, high) = ((x - border).to_f64(), (x + border).to_f64());
    if !(high >= 0.0 && low < size as f64) {
        return None;
    }
    let page = |x: f64| (if x < 0.0 { 0.0 } else { x } as usize).min(size - 1) >> bits;
    Some([page(low), page(high)])
}

/// Moves receivers whose page is not there on to the level `next`.
pub fn settle<T: Real, const PERSPECTIVE: bool>(
    watch: &mut dyn Watch,
    map: &Map<'_, T>,
    receivers: &[[T; 3]],
    next: u8,
    out: &mut [u8],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (receivers, out), 1 << 14, |first, (points, out)| {
        for i in 0..points.len() {
            if map.skips(first + i) {
                continue;
            }
            if let Some(foot) = map.foot::<PERSPECTIVE>(points[i])
                && map.holds(foot.x, foot.y)
                && !map.resident(foot.x, foot.y)
            {
                out[i] = next;
            }
        }
    })
}
