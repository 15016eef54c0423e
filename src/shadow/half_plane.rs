//! The exact share of a flat light that is seen past half-planes: the analytic reference of penumbrae.
//!
//! Seen from a receiver, a half-plane hides the part of the light that lies beyond its plane and on its own side of the
//! plane through the receiver and its edge. What is left of the light's polygon is cut off, half-plane by half-plane,
//! as convex or any other pieces, and measured by area or, with a normal, by Lambert's irradiance. Always in double.
//!
//! I. Sutherland, G. Hodgman, *Reentrant Polygon Clipping*, 1974; J. H. Lambert, *Photometria*, 1760.

use crate::geometry::clip_polygon::Polygon;
use crate::light::polygon::{double, irradiance};
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::shadow::lookup::at;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// A point of the edge, the edge's direction, and a direction from it into the half-plane.
#[derive(Clone, Copy, Debug)]
pub struct HalfPlane {
    pub edge: Vec3<f64>,
    pub along: Vec3<f64>,
    pub into: Vec3<f64>,
}

/// Where both planes are positive the half-plane hides; each is a normal and its distance from the receiver.
struct Hidden {
    beyond: (Vec3<f64>, f64),
    side: (Vec3<f64>, f64),
}

impl HalfPlane {
    /// What it hides from a receiver, in coordinates about it; nothing if the receiver lies in its plane.
    fn hides(&self, from: Vec3<f64>) -> Option<Hidden> {
        let edge = self.edge - from;
        let normal = self.along.cross(self.into);
        // The receiver is at -level, so the light must be beyond the plane on the other side.
        let level = normal.dot(edge);
        if level == 0.0 {
            return None;
        }
        let sign = if level > 0.0 { 1.0 } else { -1.0 };
        // Through the receiver and the edge. At a point of the half-plane it is level times how far in that lies.
        let side = edge.cross(self.along) * sign;
        Some(Hidden { beyond: (normal * sign, level * sign), side: (side, 0.0) })
    }
}

/// Keeps the part of a piece where the plane is positive, or negative.
fn keep(
    piece: &[Vec3<f64>],
    (normal, level): (Vec3<f64>, f64),
    sign: f64,
    work: &mut Polygon,
) -> Vec<Vec3<f64>> {
    if !work.load(3, piece.iter().flat_map(|p| p.to_array())) {
        return Vec::new();
    }
    work.clip(|p| sign * (normal.dot(Vec3::new(p[0], p[1], p[2])) - level), |_| {});
    let kept: Vec<_> = work.rows.chunks_exact(3).map(|p| Vec3::new(p[0], p[1], p[2])).collect();
    if kept.len() < 3 { Vec::new() } else { kept }
}

/// Twice the area as a vector.
fn area(piece: &[Vec3<f64>]) -> Vec3<f64> {
    let mut sum = Vec3::splat(0.0);
    for k in 2..piece.len() {
        sum = sum + (piece[k - 1] - piece[0]).cross(piece[k] - piece[0]);
    }
    sum
}

/// The share of the light, whose corners are given about the receiver.
fn share(light: Vec<Vec3<f64>>, occluders: &[Hidden], normal: Option<Vec3<f64>>) -> f64 {
    let mut work = Polygon::default();
    let whole = area(&light);
    let facing = whole * (1.0 / whole.length());
    let measure = |piece: &[Vec3<f64>]| match normal {
        None => area(piece).dot(facing),
        Some(n) => {
            let frame = Frame::about(n);
            let local: Vec<_> = piece.iter().map(|&p| frame.local(p)).collect();
            irradiance(&local)
        }
    };
    let all = measure(&light);
    if all == 0.0 {
        return 1.0;
    }
    let mut pieces = vec![light];
    for hidden in occluders {
        let mut left = Vec::with_capacity(pieces.len() + 1);
        for piece in pieces {
            let behind = keep(&piece, hidden.beyond, 1.0, &mut work);
            if behind.is_empty() || keep(&behind, hidden.side, 1.0, &mut work).is_empty() {
                left.push(piece);
                continue;
            }
            for part in
                [keep(&piece, hidden.beyond, -1.0, &mut work), keep(&behind, hidden.side, -1.0, &mut work)]
            {
                if !part.is_empty() {
                    left.push(part);
                }
            }
        }
        pieces = left;
    }
    let mut seen = 0.0;
    for piece in &pieces {
        seen += measure(piece);
    }
    (seen / all).clamp(0.0, 1.0)
}

/// The share of the light with these corners that every receiver sees.
pub fn half_plane<T: Real>(
    watch: &mut dyn Watch,
    corners: &[Vec3<f64>],
    occluders: &[HalfPlane],
    receivers: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let piece = ((1 << 14) / (corners.len() * (1 + occluders.len()))).clamp(1, 1 << 10);
    parallel::for_each(watch, (receivers, normals, out), piece, |_, (p, n, out)| {
        for i in 0..out.len() {
            let point = double(p[i]);
            let normal = at(n, i).map(double);
            let given = point + normal.unwrap_or(point);
            out[i] = if (given.x + given.y + given.z).is_finite() {
                let light = corners.iter().map(|&c| c - point).collect();
                let hidden: Vec<_> = occluders.iter().filter_map(|o| o.hides(point)).collect();
                T::of(share(light, &hidden, normal))
            } else {
                T::NAN
            };
        }
    })
}
