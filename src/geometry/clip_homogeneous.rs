//! What of a polygon in clip space lies within the volume that shows, `-w ≤ x, y, z ≤ w` (or `0 ≤ z ≤ w`), before the
//! division by `w`: there edges are still straight, also those that pass behind the eye, where `w` is negative. Corners
//! carry attributes along. `w ± x` has the right sign in floating point, so sides are exact; and as new corners are put
//! onto their border exactly, what comes out satisfies the inequalities to the bit.
//!
//! J. Blinn, M. Newell, *Clipping Using Homogeneous Coordinates*, SIGGRAPH 1978.

use super::clip_polygon::Polygon;
use crate::transform::projection::Depth;

/// The six borders: an axis, and the sign of `w` on it (0 where the border is `z = 0`).
#[derive(Clone, Copy, Debug)]
pub struct Border {
    axis: usize,
    /// The border is `axis = limit · w`, the inside where `side · (limit · w - axis) ≥ 0`.
    limit: f64,
    side: f64,
}

/// Left, right, bottom, top, near, far.
pub fn borders(depth: Depth) -> [Border; 6] {
    let at = |axis, limit, side| Border { axis, limit, side };
    let (near, far) = match depth {
        Depth::Standard => (at(2, -1.0, -1.0), at(2, 1.0, 1.0)),
        Depth::ZeroToOne => (at(2, 0.0, -1.0), at(2, 1.0, 1.0)),
        Depth::Reversed => (at(2, 1.0, 1.0), at(2, 0.0, -1.0)),
    };
    [at(0, -1.0, -1.0), at(0, 1.0, 1.0), at(1, -1.0, -1.0), at(1, 1.0, 1.0), near, far]
}

impl Border {
    fn distance(&self, p: &[f64]) -> f64 {
        self.side * (self.limit * p[3] - p[self.axis])
    }
}

/// The borders beyond which a point lies, as bits in their order.
pub fn region(borders: &[Border; 6], p: &[f64]) -> u8 {
    borders.iter().enumerate().map(|(k, b)| ((b.distance(p) < 0.0) as u8) << k).sum()
}

/// Keeps what of a polygon lies within the borders whose bits are set in `wanted`. Near and far come first, which leaves
/// nothing behind the eye to the others.
pub fn clip_homogeneous(polygon: &mut Polygon, borders: &[Border; 6], wanted: u8) {
    for k in [4, 5, 0, 1, 2, 3] {
        if wanted >> k & 1 == 0 {
            continue;
        }
        let b = borders[k];
        polygon.clip(|p| b.distance(p), |p| p[b.axis] = b.limit * p[3]);
    }
}

/// Puts coordinates that a later border's rounding moved past an earlier one back onto it, after rounding to the precision
/// of the output.
pub fn settle(borders: &[Border; 6], wanted: u8, p: &mut [f64]) {
    for (k, b) in borders.iter().enumerate() {
        if wanted >> k & 1 == 1 && b.distance(p) < 0.0 {
            p[b.axis] = b.limit * p[3];
        }
    }
}
