//! Several maps that share the work: which of them a receiver looks into.
//!
//! Cascades cut the view by depth along its axis, and cross over to the next within a share of each; the six faces of a
//! cube go by the largest component of the direction from the light.
//!
//! F. Zhang et al., *Parallel-Split Shadow Maps for Large-scale Virtual Environments*, VRCIA 2006.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;

/// No map.
pub const NONE: u8 = u8::MAX;

/// The view that cascades cut.
#[derive(Clone, Copy, Debug)]
pub struct Cuts<'a> {
    pub eye: [f64; 3],
    /// The unit vector along which depth is taken.
    pub axis: [f64; 3],
    /// Where each cascade begins, and where the last one ends; at most 255 numbers in order.
    pub splits: &'a [f64],
    /// The last share of a cascade, in which it gives way to the next.
    pub blend: f64,
}

/// For every receiver its cascade, the next where both count ([`NONE`] elsewhere), and the next one's share. Beyond the
/// last there is none; before the first, the first.
pub fn cascades<T: Real>(
    watch: &mut dyn Watch,
    receivers: &[[T; 3]],
    cuts: &Cuts<'_>,
    first: &mut [u8],
    next: &mut [u8],
    share: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (receivers, first, next, share), 1 << 14, |_, (points, first, next, share)| {
        dispatch!(_s => for i in 0..points.len() {
            (first[i], next[i], share[i]) = (NONE, NONE, T::zero());
            let p = points[i];
            let mut depth = 0.0;
            for k in 0..3 {
                depth += (p[k].to_f64() - cuts.eye[k]) * cuts.axis[k];
            }
            for k in 1..cuts.splits.len() {
                let end = cuts.splits[k];
                if depth < end {
                    first[i] = (k - 1) as u8;
                    let into = end - depth;
                    let width = cuts.blend * (end - cuts.splits[k - 1]);
                    if into < width && k + 1 < cuts.splits.len() {
                        next[i] = k as u8;
                        share[i] = T::of(1.0 - into / width);
                    }
                    break;
                }
            }
            // What is no number is told so by the first map.
            if depth.is_nan() {
                first[i] = 0;
            }
        })
    })
}

/// For every receiver the face of a cube about `origin` that it is seen through: +x, -x, +y, -y, +z, -z.
pub fn cube_faces<T: Real>(
    watch: &mut dyn Watch,
    receivers: &[[T; 3]],
    origin: [T; 3],
    faces: &mut [u8],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (receivers, faces), 1 << 14, |_, (points, faces)| {
        dispatch!(_s => for i in 0..points.len() {
            let p = points[i];
            let d = [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]];
            let (mut axis, mut largest) = (0, d[0].abs());
            for k in 1..3 {
                if d[k].abs() > largest {
                    (axis, largest) = (k, d[k].abs());
                }
            }
            faces[i] = 2 * axis as u8 + (d[axis] < T::zero()) as u8;
        })
    })
}
