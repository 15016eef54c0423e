//! How the polygon-aligned tree chooses planes, and cuts triangles by them.
//!
//! A whole triangle's side is exact (`robust::orient3d` on the vertices). Cut ones are followed in double precision; what
//! lies within [`NOISE`] of the scene's size of a plane counts as lying in it.

use crate::accel::cells::{FORK, Triangles, share};
use crate::real::Real;
use robust::{Coord3D, orient3d};
use std::sync::atomic::{AtomicBool, Ordering};

/// Parts of the scene's size that count as nothing.
pub const NOISE: f64 = 2e-14;
/// Planes of triangles with a smaller sine at the first vertex are too uncertain to part by,
const LEAST_SINE: f64 = 2e-3;
/// and of triangles with so small a product of edges, whose square would lose bits.
const LEAST_PRODUCT: f64 = 1e-140;
/// Planes tried, and fragments that they are tried on.
const TRIED: usize = 8;
const TRIED_ON: usize = 64;
/// No face, or no node.
pub const NONE: u32 = u32::MAX;

pub type Point = [f64; 3];

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[derive(Clone, Copy)]
pub struct Plane {
    pub normal: Point,
    pub anchor: Point,
    /// The face whose plane it is; [`NONE`] for planes across an axis.
    pub face: u32,
}

impl Plane {
    #[inline(always)]
    pub fn distance(&self, p: Point) -> f64 {
        dot(self.normal, minus(p, self.anchor))
    }

    /// Of a triangle; None if its normal is uncertain.
    fn of(face: u32, [a, b, c]: [Point; 3]) -> Option<Self> {
        let (e, f) = (minus(b, a), minus(c, a));
        let normal = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        let length = dot(normal, normal).sqrt();
        let product = (dot(e, e) * dot(f, f)).sqrt();
        let certain = length > LEAST_SINE * product && length > LEAST_PRODUCT && product.is_finite();
        certain.then(|| Plane { normal: normal.map(|x| x / length), anchor: a, face })
    }

    pub fn across(axis: usize, at: f64) -> Self {
        let (mut normal, mut anchor) = ([0.0; 3], [0.0; 3]);
        (normal[axis], anchor[axis]) = (1.0, at);
        Plane { normal, anchor, face: NONE }
    }
}

/// A convex part of a face.
pub struct Fragment {
    pub face: u32,
    /// None: all of it.
    pub points: Option<Vec<Point>>,
}

pub enum Part {
    Leaf(Vec<Fragment>),
    /// The plane, what lies in it, and what lies behind it and before it.
    Node(Box<(Plane, Vec<Fragment>, [Part; 2])>),
}

pub struct Builder<'a, T> {
    pub triangles: &'a Triangles<T>,
    /// Distances that count as nothing.
    pub noise: f64,
    pub leaf_size: usize,
    pub max_depth: usize,
    pub stop: &'a AtomicBool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Behind,
    Before,
    Within,
    Across,
}

impl Side {
    /// From whether something lies behind, and whether something lies before.
    fn of(behind: bool, before: bool) -> Self {
        match (behind, before) {
            (true, true) => Side::Across,
            (true, false) => Side::Behind,
            (false, true) => Side::Before,
            (false, false) => Side::Within,
        }
    }
}

pub fn corners<T: Real>(triangles: &Triangles<T>, face: u32) -> [Point; 3] {
    triangles.corners(face).map(|p| p.map(|x| x.to_f64()))
}

/// The side of a point, exactly: positive before the plane.
pub fn exact_side<T: Real>(triangles: &Triangles<T>, plane: &Plane, p: Point) -> f64 {
    if plane.face == NONE {
        return plane.distance(p);
    }
    let coord = |p: Point| Coord3D { x: p[0], y: p[1], z: p[2] };
    let [a, b, c] = corners(triangles, plane.face);
    -orient3d(coord(a), coord(b), coord(c), coord(p))
}

impl<T: Real> Builder<'_, T> {
    fn points(&self, fragment: &Fragment) -> Vec<Point> {
        fragment.points.clone().unwrap_or_else(|| corners(self.triangles, fragment.face).to_vec())
    }

    fn centre(&self, fragment: &Fragment) -> Point {
        let mean =
            |points: &[Point], k: usize| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64;
        match &fragment.points {
            None => std::array::from_fn(|k| mean(&corners(self.triangles, fragment.face), k)),
            Some(points) => std::array::from_fn(|k| mean(points, k)),
        }
    }

    /// The side of a fragment, with round-off as nothing.
    fn rough_side(&self, plane: &Plane, points: &[Point]) -> Side {
        let distances = || points.iter().map(|&p| plane.distance(p));
        Side::of(distances().any(|d| d < -self.noise), distances().any(|d| d > self.noise))
    }

    fn side(&self, plane: &Plane, fragment: &Fragment) -> Side {
        let sides = corners(self.triangles, fragment.face).map(|p| exact_side(self.triangles, plane, p));
        let whole = Side::of(sides.iter().any(|&s| s < 0.0), sides.iter().any(|&s| s > 0.0));
        // The side of the whole is that of a part; a triangle that is cut may still have this part on one side.
        if whole == Side::Across { self.rough_side(plane, &self.points(fragment)) } else { whole }
    }

    /// The parts behind and before a plane.
    fn cut(&self, plane: &Plane, fragment: &Fragment) -> [Fragment; 2] {
        let points = self.points(fragment);
        let (mut behind, mut before) = (Vec::new(), Vec::new());
        for (i, &p) in points.iter().enumerate() {
            let q = points[(i + 1) % points.len()];
            let (s, t) = (plane.distance(p), plane.distance(q));
            if s <= self.noise {
                behind.push(p);
            }
            if s >= -self.noise {
                before.push(p);
            }
            if (s < -self.noise && t > self.noise) || (s > self.noise && t < -self.noise) {
                let w = s / (s - t);
                let x = std::array::from_fn(|k| p[k] + (q[k] - p[k]) * w);
                behind.push(x);
                before.push(x);
            }
        }
        [behind, before].map(|points| Fragment { face: fragment.face, points: Some(points) })
    }

    /// How ill a plane parts the fragments at `tried`, and how many of these lie on the side that has fewer.
    fn badness(&self, plane: &Plane, tried: &[Vec<Point>]) -> (usize, usize) {
        let (mut behind, mut before, mut across) = (0, 0, 0usize);
        for points in tried {
            match self.rough_side(plane, points) {
                Side::Behind => behind += 1,
                Side::Before => before += 1,
                Side::Across => across += 1,
                Side::Within => {}
            }
        }
        (8 * across + usize::abs_diff(behind, before), usize::min(behind, before))
    }

    fn best_plane(&self, fragments: &[Fragment]) -> Option<Plane> {
        let n = fragments.len();
        let spread = |most: usize, i: usize| i * n / most.min(n);
        let tried: Vec<_> =
            (0..TRIED_ON.min(n)).map(|i| self.points(&fragments[spread(TRIED_ON, i)])).collect();
        let own = |i: usize| {
            let face = fragments[spread(TRIED, i)].face;
            Plane::of(face, corners(self.triangles, face))
        };
        let rate = |plane: Plane| (self.badness(&plane, &tried), plane);
        let polygon = (0..TRIED.min(n)).filter_map(own).map(rate).min_by_key(|(b, _)| b.0);
        match polygon {
            Some(((_, fewer), plane)) if n <= 16 || 8 * fewer >= tried.len() => return Some(plane),
            _ => {}
        }
        let across = (0..3).filter_map(|axis| {
            let mut centres: Vec<f64> = fragments.iter().map(|f| self.centre(f)[axis]).collect();
            let (_, &mut at, _) = centres.select_nth_unstable_by(n / 2, f64::total_cmp);
            let plane = Plane::across(axis, at);
            // Of no use if nothing lies on one of its sides alone.
            let rated = rate(plane);
            (rated.0.1 > 0).then_some(rated)
        });
        across.min_by_key(|(b, _)| b.0).or(polygon).map(|(_, plane)| plane)
    }

    /// Parts the fragments of a cell, which may grow to `allowed`.
    pub fn part(&self, fragments: Vec<Fragment>, depth: usize, allowed: usize) -> Part {
        let n = fragments.len();
        if n <= self.leaf_size || depth >= self.max_depth || self.stop.load(Ordering::Relaxed) {
            return Part::Leaf(fragments);
        }
        let Some(plane) = self.best_plane(&fragments) else { return Part::Leaf(fragments) };
        let sides: Vec<Side> = fragments.iter().map(|f| self.side(&plane, f)).collect();
        let count = |side: Side| sides.iter().filter(|&&s| s == side).count();
        let across = count(Side::Across);
        let most = usize::max(count(Side::Behind), count(Side::Before)) + across;
        if n + across > allowed || most == n {
            return Part::Leaf(fragments);
        }
        let (mut behind, mut before, mut within) = (Vec::new(), Vec::new(), Vec::new());
        for (fragment, side) in fragments.into_iter().zip(sides) {
            match side {
                Side::Behind => behind.push(fragment),
                Side::Before => before.push(fragment),
                Side::Within => within.push(fragment),
                Side::Across => {
                    let [b, f] = self.cut(&plane, &fragment);
                    behind.push(b);
                    before.push(f);
                }
            }
        }
        let allowed = share(allowed - within.len(), &[behind.len(), before.len()]);
        let behind = || self.part(behind, depth + 1, allowed[0]);
        let before = || self.part(before, depth + 1, allowed[1]);
        let halves = if n > FORK { rayon::join(behind, before).into() } else { [behind(), before()] };
        Part::Node(Box::new((plane, within, halves)))
    }
}
