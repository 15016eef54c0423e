//! From vertices in clip space to what coverage and interpolation evaluate: snapped positions, edge functions, and
//! planes over the screen.
//!
//! Coverage is decided on positions snapped to 1/256 pixel, in integers, hence exactly. Depth and barycentrics are
//! those of the original triangle, unsnapped and unclipped: in homogeneous form they need no division by a vertex's
//! `w`, so vertices behind the eye are as good as any.
//!
//! J. Pineda, *A Parallel Algorithm for Polygon Rasterization*, 1988.
//! M. Olano, T. Greer, *Triangle Scan Conversion using 2D Homogeneous Coordinates*, 1997.

use super::samples::SUBPIXELS;
use super::{Depth, MAX_SIZE};
use crate::real::{Lanes, Real};

/// The mark of a vertex that must be clipped, or is not finite.
pub const OUTSIDE: i32 = i32::MIN;

/// How far the guard band reaches beyond the picture, in pixels: coordinates then span at most 2^23 subpixels.
const GUARD: f64 = (MAX_SIZE / 2) as f64;

/// The picture that clip space is mapped to.
#[derive(Clone, Copy, Debug)]
pub struct Screen {
    pub width: usize,
    pub height: usize,
    /// Half the size in pixels.
    pub half: [f64; 2],
    /// The guard planes: `|x| <= guard[0] w`.
    pub guard: [f64; 2],
    pub depth_low: f64,
    pub reversed: bool,
}

impl Screen {
    pub fn new(width: usize, height: usize, depth: Depth) -> Self {
        let half = [width as f64 / 2.0, height as f64 / 2.0];
        Self {
            width,
            height,
            half,
            guard: half.map(|h| 1.0 + GUARD / h),
            depth_low: depth.low(),
            reversed: depth == Depth::Reversed,
        }
    }

    /// The nearest point of the subpixel grid, for a vertex between the clip planes. Row 0 is the top.
    #[inline(always)]
    pub fn snap(&self, v: [f64; 4]) -> [i32; 2] {
        let x = v[0] / v[3] * self.half[0] + self.half[0];
        let y = self.half[1] - v[1] / v[3] * self.half[1];
        [nearest(x * SUBPIXELS as f64), nearest(y * SUBPIXELS as f64)]
    }

    /// [`Screen::snap`], or [`OUTSIDE`] for a vertex that is not strictly between near, far and guard planes.
    #[inline(always)]
    pub fn snap_or_mark(&self, v: [f64; 4]) -> [i32; 2] {
        let [x, y, z, w] = v;
        // Comparisons are false on NaN; the last one refuses an infinite w.
        let inside = (w > 0.0)
            & (z >= self.depth_low * w)
            & (z <= w)
            & (x.abs() <= self.guard[0] * w)
            & (y.abs() <= self.guard[1] * w)
            & (w <= f64::MAX);
        let [x, y] = self.snap(v);
        if inside { [x, y] } else { [OUTSIDE; 2] }
    }
}

/// The nearest integer of magnitude below 2^31: adding 1.5 · 2^52 leaves it in the low bits of the mantissa.
#[inline(always)]
fn nearest(x: f64) -> i32 {
    (x + f64::ROUND_MAGIC).to_bits() as i32
}

/// Twice the signed area in subpixels squared, positive where the vertices run clockwise on the screen (y down).
#[inline(always)]
pub fn area(v: &[[i32; 2]; 3]) -> i64 {
    let (x1, y1) = ((v[1][0] - v[0][0]) as i64, (v[1][1] - v[0][1]) as i64);
    let (x2, y2) = ((v[2][0] - v[0][0]) as i64, (v[2][1] - v[0][1]) as i64);
    x1 * y2 - x2 * y1
}

/// The three edge functions `a x + b y + c` in subpixels; a point is covered where none is negative.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    pub a: [i32; 3],
    pub b: [i32; 3],
    pub c: [i64; 3],
}

impl Edges {
    /// Edges of a triangle with positive [`area`], about `origin`. Points on an edge belong to the triangle if the
    /// edge is a left one, or a horizontal one at the top; the other edges are moved inwards by one unit, the
    /// smallest that an edge function can differ by.
    #[inline(always)]
    pub fn new(v: &[[i32; 2]; 3], origin: [i32; 2]) -> Self {
        let mut e = Edges { a: [0; 3], b: [0; 3], c: [0; 3] };
        for i in 0..3 {
            let (p, q) = (v[i], v[(i + 1) % 3]);
            let (a, b) = (p[1] - q[1], q[0] - p[0]);
            let top_left = (a > 0) | ((a == 0) & (b > 0));
            let (x, y) = ((p[0] - origin[0]) as i64, (p[1] - origin[1]) as i64);
            (e.a[i], e.b[i]) = (a, b);
            e.c[i] = -(a as i64 * x + b as i64 * y) - i64::from(!top_left);
        }
        e
    }

    /// The least and the greatest value of edge `i` over the square `[0, size]²`.
    #[inline(always)]
    pub fn range(&self, i: usize, size: i64) -> (i64, i64) {
        let (a, b) = (self.a[i] as i64 * size, self.b[i] as i64 * size);
        (self.c[i] + a.min(0) + b.min(0), self.c[i] + a.max(0) + b.max(0))
    }
}

/// A function affine over the screen: `a dx + (c + b dy)`, in that order.
pub type Plane<T> = [T; 3];

/// Depth and barycentrics of one triangle over the screen, about a reference pixel of its own.
#[derive(Clone, Copy, Debug)]
pub struct Planes<T> {
    pub face: i32,
    /// Pixels of the reference point.
    pub reference: [T; 2],
    /// The barycentric weights times a common factor that varies over the screen; all positive inside.
    pub weights: [Plane<T>; 3],
    /// `z / w`, negated if reversed, so that less is nearer.
    pub depth: Plane<T>,
    /// The depths that the triangle spans: coverage is snapped, so samples may lie outside it by 1/512 pixel.
    pub depth_range: [T; 2],
}

impl<T: Real> Planes<T> {
    /// The perspective-correct `(u, v)`, within the triangle.
    #[inline(always)]
    pub fn barycentrics_at(&self, dx: T, dy: T) -> [T; 2] {
        let [l0, l1, l2] = clamped(&self.weights, dx, dy);
        // Divided one by one: the reciprocal of a sum near the least number would overflow.
        let sum = l0 + l1 + l2;
        [l1 / sum, l2 / sum]
    }
}

/// The weights at points of a row, none negative and their sum positive.
#[inline(always)]
pub fn clamped<V: Lanes>(weights: &[Plane<V::Elem>; 3], dx: V, dy: V::Elem) -> [V; 3] {
    let weight = |i: usize| {
        let p = weights[i];
        (dx * dx.like(p[0]) + dx.like(p[2] + p[1] * dy)).max(dx.num(0.0))
    };
    let (l0, l1, l2) = (weight(0), weight(1), weight(2));
    // A sliver thinner than the grid may miss the sample by all three: then its first vertex stands for it.
    let missed = (l0 + l1 + l2).less_eq(dx.num(0.0));
    [V::select(missed, dx.num(1.0), l0), l1, l2]
}

/// The planes of a triangle in clip space about the pixel `reference`.
#[inline(always)]
pub fn planes<T: Real>(face: i32, clip: [[T; 4]; 3], reference: [i32; 2], screen: &Screen) -> Planes<T> {
    let reference = [T::of(reference[0] as f64), T::of(reference[1] as f64)];
    let (weights, depth, depth_range) = planes_in_lanes(clip, reference, screen);
    Planes { face, reference, weights, depth, depth_range }
}

/// Weights, depth and range of depth of one triangle a lane.
#[inline(always)]
pub fn planes_in_lanes<V: Lanes>(
    clip: [[V; 4]; 3],
    reference: [V; 2],
    screen: &Screen,
) -> ([[V; 3]; 3], [V; 3], [V; 2]) {
    let like = clip[0][0];
    let (zero, one) = (like.num(0.0), like.num(1.0));
    // A common factor changes neither depth nor weights, and keeps the products in range.
    let mut largest = like.like(V::Elem::MIN_POSITIVE);
    for i in 0..3 {
        for k in 0..4 {
            largest = largest.max(clip[i][k].abs());
        }
    }
    let factor = one / largest;
    // Homogeneous pixel coordinates about the reference: small numbers near the triangle, so little cancels.
    let (hx, hy) = (like.num(screen.half[0]), like.num(screen.half[1]));
    let (kx, ky) = (hx - reference[0], hy - reference[1]);
    let mut v = clip;
    for i in 0..3 {
        let (x, y, w) = (clip[i][0] * factor, clip[i][1] * factor, clip[i][3] * factor);
        v[i] = [x * hx + w * kx, w * ky - y * hy, clip[i][2] * factor, w];
    }
    let mut weights = [[zero; 3]; 3];
    let mut determinant = zero;
    for i in 0..3 {
        let (p, q) = (v[(i + 1) % 3], v[(i + 2) % 3]);
        weights[i] = [p[1] * q[3] - p[3] * q[1], p[3] * q[0] - p[0] * q[3], p[0] * q[1] - p[1] * q[0]];
        determinant = determinant + v[i][3] * weights[i][2];
    }
    // The depth of the vertex farthest from the eye's plane anchors the depth plane: only differences to it are
    // interpolated, so a triangle of constant depth keeps it to the bit.
    let mut farthest = v[0][3];
    let mut anchor = v[0][2] / v[0][3];
    let (mut low, mut high, mut behind) = (anchor, anchor, v[0][3].less_eq(zero));
    for i in 1..3 {
        let ratio = v[i][2] / v[i][3];
        anchor = V::select(farthest.less(v[i][3]), ratio, anchor);
        farthest = farthest.max(v[i][3]);
        (low, high) = (low.min(ratio), high.max(ratio));
        behind = behind | v[i][3].less_eq(zero);
    }
    let sign = if screen.reversed { -one } else { one };
    let inverse = sign / determinant;
    let mut depth = [zero, zero, sign * anchor];
    for i in 0..3 {
        let difference = (v[i][2] - anchor * v[i][3]) * inverse;
        for k in 0..3 {
            depth[k] = depth[k] + weights[i][k] * difference;
        }
    }
    // Behind the eye `z / w` bounds nothing; what is left of the triangle lies between near and far.
    let least = like.num(screen.depth_low);
    low = V::select(behind, least, low.max(least));
    high = V::select(behind, one, high.min(one));
    let range = if screen.reversed { [-high, -low] } else { [low, high] };
    // No determinant, no planes: the triangle is edge-on to within rounding, and its anchor stands for it.
    let sound = zero.less(determinant.abs()) & inverse.abs().less_eq(like.like(V::Elem::MAX));
    let flip = V::select(determinant.less(zero), -one, one);
    for i in 0..3 {
        for k in 0..3 {
            weights[i][k] = V::select(sound, weights[i][k] * flip, if k == 2 { one } else { zero });
        }
        depth[i] = V::select(sound, depth[i], if i == 2 { sign * anchor } else { zero });
    }
    (weights, depth, range)
}

impl Planes<f64> {
    /// Rounded to the precision of the picture; the weights' common factor is chosen such that they fit it.
    pub fn to<T: Real>(self) -> Planes<T> {
        let largest = self.weights.iter().flatten().fold(f64::MIN_POSITIVE, |m, c| m.max(c.abs()));
        let weights = self.weights.map(|p| p.map(|c| T::of(c / largest)));
        Planes {
            face: self.face,
            reference: self.reference.map(T::of),
            weights,
            depth: self.depth.map(T::of),
            depth_range: self.depth_range.map(T::of),
        }
    }
}
