//! Winding numbers: how often a mesh goes round a point, for open and overlapping meshes too.
//!
//! A triangle contributes the solid angle that it spans, over 4π (van Oosterom and Strackee 1983). Far parts of the mesh
//! contribute through their moments: dipoles, quadrupoles and octupoles of the nodes of the tree (Barill et al. 2018),
//! integrated over the triangles, not taken at their centres.
//!
//! **Error.** The potential of a source at a distance `ρ` from a node's centre, seen from `R`, is `Σ ρ^l P_l / R^(l+1)`; the
//! gradient of a term is at most `l ρ^(l-1) / R^(l+1)`, by the inequality of Bernstein and Szegő. What is left out from the
//! fourth term on is therefore at most `A / (4π R²) · (4x³ - 3x⁴) / (1 - x)²` for an area `A` within `x R` of the centre.
//! The allowed error is handed down the tree, to children in proportion to `A / R²`, and a node is taken for its moments where
//! that bound keeps to its share. So the sum keeps to the whole: proven, and in practice smaller by a hundred times.
//!
//! Where a point is so close to a triangle's plane that rounding could turn the sign of the solid angle, an exact
//! predicate decides it. All is computed in double precision.
//!
//! A. Jacobson, L. Kavan, O. Sorkine-Hornung, *Robust Inside-Outside Segmentation using Generalized Winding Numbers*,
//! 2013. G. Barill, N. Dickson, R. Schmidt, D. Levin, A. Jacobson, *Fast Winding Numbers for Soups and Clouds*, 2018.
//! A. van Oosterom, J. Strackee, *The Solid Angle of a Plane Triangle*, 1983.

use super::Bvh;
use super::node::Child;
use crate::accel::block::{BLOCK, Block};
use crate::dispatch;
use crate::math::atan2;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crate::vec::Vec3;

type V = Vec3<f64>;

const PIECE: usize = 256;
const FOUR_PI: f64 = 4.0 * std::f64::consts::PI;
/// Nearer than this, in units of the scene, powers of the distance would vanish.
const NEAREST: f64 = 1e-40;
/// Farther than this a mesh is nothing, and powers of the distance overflow.
const FARTHEST: f64 = 1e60;

/// The moments of every node, in a frame where the scene is of about unit size.
pub struct Moments {
    nodes: Vec<Moment>,
}

/// Area moments about a centre.
#[derive(Clone, Copy)]
struct Moment {
    centre: V,
    /// All triangles lie within.
    radius: f64,
    /// Areas as such, and as vectors.
    area: f64,
    vector: V,
    /// `∫ (y·r) (n·r) dA` as a form in r: xx, yy, zz, xy, yz, zx.
    second: [f64; 6],
    /// `∫ (y·r)² (n·r) dA`: xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz.
    third: [f64; 10],
}

/// The quadratic form `(a·r) (b·r)`.
fn product(a: V, b: V) -> [f64; 6] {
    let mixed = [a.x * b.y + a.y * b.x, a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z];
    [a.x * b.x, a.y * b.y, a.z * b.z, mixed[0], mixed[1], mixed[2]]
}

/// The cubic form `(a·r) q(r)`.
fn times(a: V, q: [f64; 6]) -> [f64; 10] {
    let [xx, yy, zz, xy, yz, zx] = q;
    [
        a.x * xx,
        a.y * yy,
        a.z * zz,
        a.x * xy + a.y * xx,
        a.x * zx + a.z * xx,
        a.y * xy + a.x * yy,
        a.y * yz + a.z * yy,
        a.z * zx + a.x * zz,
        a.z * yz + a.y * zz,
        a.x * yz + a.y * zx + a.z * xy,
    ]
}

fn add<const N: usize>(to: &mut [f64; N], what: [f64; N], weight: f64) {
    to.iter_mut().zip(what).for_each(|(t, w)| *t += weight * w);
}

impl Moment {
    fn none(centre: V) -> Self {
        let zero = Vec3::splat(0.0);
        Moment { centre, radius: 0.0, area: 0.0, vector: zero, second: [0.0; 6], third: [0.0; 10] }
    }

    fn add_triangle(&mut self, corners: [V; 3]) {
        let [a, b, c] = corners.map(|p| p - self.centre);
        let vector = (b - a).cross(c - a) * 0.5;
        let sum = a + b + c;
        self.area += vector.length();
        self.vector = self.vector + vector;
        // The integral of y, and of y y: the mean of products over a triangle is (Σ v v + s s) / 12, s being Σ v.
        add(&mut self.second, product(sum, vector), 1.0 / 3.0);
        for y in [a, b, c, sum] {
            add(&mut self.third, times(vector, product(y, y)), 1.0 / 12.0);
        }
        let reach = a.length().max(b.length()).max(c.length());
        self.radius = Lanes::max(reach, self.radius);
    }

    /// Adds the moments of a part about its own centre.
    fn add_part(&mut self, part: &Moment) {
        let d = part.centre - self.centre;
        self.radius = Lanes::max(part.radius + d.length(), self.radius);
        self.area += part.area;
        self.vector = self.vector + part.vector;
        add(&mut self.second, part.second, 1.0);
        add(&mut self.second, product(d, part.vector), 1.0);
        add(&mut self.third, part.third, 1.0);
        add(&mut self.third, times(d, part.second), 2.0);
        add(&mut self.third, times(part.vector, product(d, d)), 1.0);
    }

    /// How far the moments may be from the truth, seen from a point whose square distance is `rr`.
    #[inline(always)]
    fn error(&self, rr: f64) -> f64 {
        let x = self.radius / Lanes::sqrt(rr);
        if !(x < 1.0 && rr > NEAREST * NEAREST) {
            return f64::INFINITY;
        }
        let left = 1.0 - x;
        self.area / (FOUR_PI * rr) * (x * x * x * (4.0 - 3.0 * x)) / (left * left)
    }

    /// The solid angle over 4π, seen from a point at `-r` from the centre.
    #[inline(always)]
    fn winding(&self, r: V, rr: f64) -> f64 {
        let [xx, yy, zz, xy, yz, zx] = self.second;
        let quadratic =
            r.x * (xx * r.x + xy * r.y) + r.y * (yy * r.y + yz * r.z) + r.z * (zz * r.z + zx * r.x);
        let [xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz] = self.third;
        let cubic = r.x * r.x * (xxx * r.x + xxy * r.y + xxz * r.z)
            + r.y * r.y * (yyy * r.y + yyx * r.x + yyz * r.z)
            + r.z * r.z * (zzz * r.z + zzx * r.x + zzy * r.y)
            + xyz * r.x * r.y * r.z;
        // Half the Laplacian of the cubic form.
        let laplacian =
            (3.0 * xxx + yyx + zzx) * r.x + (3.0 * yyy + xxy + zzy) * r.y + (3.0 * zzz + xxz + yyz) * r.z;
        let q = 1.0 / rr;
        let first = self.vector.dot(r);
        let second = (xx + yy + zz) - 3.0 * q * quadratic;
        let third = q * (7.5 * q * cubic - 1.5 * laplacian);
        (first + second + third) * q / Lanes::sqrt(rr) / FOUR_PI
    }
}

impl Moments {
    pub fn new<T: Real>(tree: &Bvh<T>) -> Self {
        use rayon::prelude::*;
        let (origin, scale) = frame(tree);
        let leaves =
            |child: Child| if child.is_leaf() && child != Child::EMPTY { tree.run(child) } else { &[] };
        let of_leaves = |node: &super::Node<T>| {
            let triangles = || {
                let blocks = node.children.iter().flat_map(|&c| leaves(c));
                blocks.flat_map(|b| (0..BLOCK).filter(|&l| b.faces[l] >= 0).map(move |l| corners(b, l)))
            };
            let centres = triangles().map(|[a, b, c]| (a + b + c) * (1.0 / 3.0));
            let (sum, n) = centres.fold((Vec3::splat(0.0), 0.0), |(s, n), c| (s + c, n + 1.0));
            let mean = if n > 0.0 { sum * (1.0 / n) } else { origin };
            let mut moment = Moment::none((mean - origin) * scale);
            triangles().for_each(|t| moment.add_triangle(t.map(|p| (p - origin) * scale)));
            moment
        };
        let mut nodes: Vec<Moment> = tree.nodes.par_iter().with_min_len(256).map(of_leaves).collect();
        // Children stand behind their parents.
        for i in (0..nodes.len()).rev() {
            let inner = tree.nodes[i].children.iter().filter(|c| !c.is_leaf());
            let parts: Vec<Moment> =
                inner.map(|c| nodes[c.index()]).chain((nodes[i].area > 0.0).then_some(nodes[i])).collect();
            let area: f64 = parts.iter().map(|p| p.area).sum();
            if area > 0.0 {
                let sum = parts.iter().fold(Vec3::splat(0.0), |s, p| s + p.centre * p.area);
                let mut all = Moment::none(sum * (1.0 / area));
                parts.iter().for_each(|p| all.add_part(p));
                nodes[i] = all;
            }
        }
        Moments { nodes }
    }

    /// From a point to a node's centre, and the square of that.
    #[inline(always)]
    fn seen(&self, node: usize, from: V) -> (V, f64) {
        let r = self.nodes[node].centre - from;
        (r, r.length_squared())
    }

    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Moment>()
    }
}

fn corners<T: Real>(block: &Block<T>, lane: usize) -> [V; 3] {
    block.vertices.map(|v| Vec3::from(v.map(|x| x[lane].to_f64())))
}

/// The solid angles of a run of blocks over 2, seen from `q`. Coordinates are multiplied by `scale`, a power of two.
#[inline(always)]
fn half_angles<T: Real, S: Simd>(s: S, blocks: &[Block<T>], q: V, scale: f64) -> f64 {
    type Four<S> = <f64 as Real>::V4<S>;
    let point = Vec3::new(Four::<S>::splat(s, q.x), Four::<S>::splat(s, q.y), Four::<S>::splat(s, q.z));
    let one = Four::<S>::splat(s, 1.0);
    let mut sum = 0.0;
    for block in blocks {
        // No closures, which would leave the dispatch where they are not inlined.
        let unit = one * scale;
        let a = (corner(s, block, 0) - point) * unit;
        let b = (corner(s, block, 1) - point) * unit;
        let c = (corner(s, block, 2) - point) * unit;
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let volume = la * lb * lc;
        let det = a.dot(b.cross(c));
        let den = volume + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        // The sign matters where the point lies above or below the triangle, next to its plane.
        let near = Lanes::less_eq(Lanes::abs(det), volume * 1e-14) & Lanes::less(den, volume * 1e-3);
        let mut doubtful = Four::<S>::bits(near);
        let mut angles = atan2(det, den).to_array();
        while doubtful != 0 {
            let l = doubtful.trailing_zeros() as usize & (BLOCK - 1);
            doubtful &= doubtful - 1;
            angles[l] = match side(block, l, q) {
                Some(side) if side != 0.0 => angles[l].abs().copysign(side),
                // On the triangle: the mean of both sides.
                Some(_) => 0.0,
                None => angles[l],
            };
        }
        for l in 0..BLOCK {
            if block.faces[l] >= 0 {
                sum += angles[l];
            }
        }
    }
    sum
}

/// A vertex of each of four triangles.
#[inline(always)]
fn corner<T: Real, S: Simd>(s: S, block: &Block<T>, vertex: usize) -> Vec3<<f64 as Real>::V4<S>> {
    let [x, y, z] = &block.vertices[vertex];
    Vec3::new(doubles(s, x), doubles(s, y), doubles(s, z))
}

#[inline(always)]
fn doubles<T: Real, S: Simd>(s: S, x: &[T; BLOCK]) -> <f64 as Real>::V4<S> {
    SimdBase::load_array(s, [x[0].to_f64(), x[1].to_f64(), x[2].to_f64(), x[3].to_f64()])
}

/// The exact sign of the volume between a triangle and a point; None where its products overflow or vanish.
#[inline(never)]
fn side<T: Real>(block: &Block<T>, lane: usize, q: V) -> Option<f64> {
    let all = corners(block, lane);
    let largest =
        all.iter().chain([&q]).fold(0.0, |m: f64, p| m.max(p.x.abs()).max(p.y.abs()).max(p.z.abs()));
    if !(1e-80..1e90).contains(&largest) {
        return None;
    }
    let [a, b, c, d] = [all[0], all[1], all[2], q].map(|p| robust::Coord3D { x: p.x, y: p.y, z: p.z });
    // Positive where d lies below the plane, a, b, c running counter-clockwise from above: where the volume is.
    Some(robust::orient3d(a, b, c, d))
}

/// The winding number of a point, within `max_error` of the sum over all triangles; exact without moments.
#[inline(always)]
fn winding<T: Real, S: Simd>(
    s: S,
    tree: &Bvh<T>,
    moments: Option<&Moments>,
    max_error: f64,
    p: V,
    frame: (V, f64),
    stack: &mut Vec<(usize, f64)>,
) -> f64 {
    let (origin, scale) = frame;
    let local = (p - origin) * scale;
    if !(local.x.abs().max(local.y.abs()).max(local.z.abs()) < FARTHEST) {
        return 0.0;
    }
    let Some(moments) = moments else {
        return half_angles(s, &tree.blocks, p, scale) * (2.0 / FOUR_PI);
    };
    let (mut sum, mut angles) = (0.0, 0.0);
    let (r, rr) = moments.seen(0, local);
    if moments.nodes[0].error(rr) <= max_error {
        return moments.nodes[0].winding(r, rr);
    }
    stack.clear();
    stack.push((0, max_error));
    while let Some((node, budget)) = stack.pop() {
        let children = &tree.nodes[node].children;
        let mut below = [(0, Vec3::splat(0.0), 0.0, 0.0); super::node::WIDTH];
        let (mut n, mut weights) = (0, 0.0);
        for &child in children {
            if child == Child::EMPTY {
                continue;
            }
            if child.is_leaf() {
                angles += half_angles(s, tree.run(child), p, scale);
                continue;
            }
            let ((r, rr), moment) = (moments.seen(child.index(), local), &moments.nodes[child.index()]);
            let weight = moment.area / (rr + moment.radius * moment.radius + NEAREST);
            below[n] = (child.index(), r, rr, weight);
            (n, weights) = (n + 1, weights + weight);
        }
        for &(child, r, rr, weight) in &below[..n] {
            let share = if weights > 0.0 { budget * weight / weights } else { 0.0 };
            let moment = &moments.nodes[child];
            if moment.error(rr) <= share {
                sum += moment.winding(r, rr);
            } else {
                stack.push((child, share));
            }
        }
    }
    sum + angles * (2.0 / FOUR_PI)
}

/// The winding numbers of arrays of points; with moments, within `max_error`; else exact.
pub fn winding_numbers<T: Real>(
    watch: &mut dyn Watch,
    tree: &Bvh<T>,
    moments: Option<&Moments>,
    max_error: f64,
    points: &[[T; 3]],
    out: &mut [T],
) -> Result<(), Interrupted> {
    let piece = if moments.is_some() { PIECE } else { ((PIECE << 10) / tree.faces().max(1 << 10)).max(1) };
    let frame = frame(tree);
    parallel::for_each(watch, (points, out), piece, |_, (points, out): (&[[T; 3]], &mut [T])| {
        let mut stack = Vec::new();
        dispatch!(s => for (p, out) in points.iter().zip(out) {
            *out = if p.iter().all(|x| x.is_finite()) {
                T::of(winding(s, tree, moments, max_error, Vec3::from(p.map(|x| x.to_f64())), frame, &mut stack))
            } else {
                T::NAN
            };
        })
    })
}

/// The middle of the scene, and a power of two that brings it to about unit size.
fn frame<T: Real>(tree: &Bvh<T>) -> (V, f64) {
    let [low, high] = tree.bounds().map(|p| Vec3::from(p.map(|x| x.to_f64())));
    let extent = high - low;
    let extent = Lanes::max(Lanes::max(extent.x, extent.y), extent.z);
    let scale = if extent > 0.0 { f64::exp2i(-extent.split_exponent().1) } else { 1.0 };
    ((low + high) * 0.5, scale)
}
