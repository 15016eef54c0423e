//! The point of a triangle nearest to a point, four triangles at a time, and the rule by which every structure decides.
//!
//! Candidates are the nearest points of the three edges and, where the foot of the perpendicular falls into the triangle, the foot;
//! the least distance wins. Each candidate is a point of the triangle whatever its weights were rounded to, so slivers
//! cost accuracy of the point, never a distance below the true one by more than the rounding of its coordinates.
//!
//! **Exactness.** The squared distance from a box, `Σ max(low - p, p - high, 0)²`, is built of operations that round
//! monotonically, so it never exceeds that from a box inside. A triangle's squared distance is raised to that of its
//! own box, and equal ones go to the lowest face: hence no box can hide the answer, and trees give what brute force does.

use super::block::{BLOCK, Block, corner, splat4};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crate::vec::Vec3;

/// How often the foot of a perpendicular is corrected: after three times slivers of a height of 1e-9 of their length are right
/// to a rounding in double precision, after two not.
const STEPS: usize = 3;

/// The nearest point `(1 - u - v) a + u b + v c` of a face, as far as it is known. None yet: face -1.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<T> {
    /// The squared distance.
    pub square: T,
    pub u: T,
    pub v: T,
    pub face: i32,
    /// 0 inside the face, 1 to 3 on the edges ab, bc, ca, 4 to 6 at the vertices a, b, c.
    pub feature: i32,
    /// The face's vertices.
    pub corners: [[T; 3]; 3],
}

impl<T: Real> Nearest<T> {
    /// Only what is nearer than `max_distance` counts.
    #[inline(always)]
    pub fn within(max_distance: T) -> Self {
        let zero = T::zero();
        let square = if max_distance > zero { max_distance * max_distance } else { zero };
        Nearest { square, u: zero, v: zero, face: -1, feature: 0, corners: [[zero; 3]; 3] }
    }
    #[inline(always)]
    pub fn distance(&self) -> T {
        Lanes::sqrt(self.square)
    }
    #[inline(always)]
    pub fn point(&self) -> [T; 3] {
        let [a, b, c] = self.corners.map(Vec3::from);
        (a * (T::one() - self.u - self.v) + b * self.u + c * self.v).to_array()
    }
}

/// Candidates in lanes.
#[derive(Clone, Copy)]
struct Candidate<V> {
    square: V,
    u: V,
    v: V,
    feature: V,
}

impl<V: Lanes> Candidate<V> {
    #[inline(always)]
    fn or(self, mask: V::Mask, other: Self) -> Self {
        Candidate {
            square: V::select(mask, other.square, self.square),
            u: V::select(mask, other.u, self.u),
            v: V::select(mask, other.v, self.v),
            feature: V::select(mask, other.feature, self.feature),
        }
    }
    /// The nearer of both; `other` also where this is NaN.
    #[inline(always)]
    fn nearer(self, other: Self) -> Self {
        self.or(!self.square.less_eq(other.square), other)
    }
}

/// The nearest point to the origin on the edge from `p` to `q`, whose difference is `e`: its squared distance, and how far along.
#[inline(always)]
fn edge<V: Lanes>(p: Vec3<V>, q: Vec3<V>, e: Vec3<V>) -> (V, V) {
    let (zero, one) = (e.x.num(0.0), e.x.num(1.0));
    // An edge without length gives NaN, which maximum turns into zero.
    let s = (-p.dot(e) / e.dot(e)).max(zero).min(one);
    let at = (p + e * s).length_squared();
    (V::select(s.equal(one), q.length_squared(), at), s)
}

/// The number of a feature: an edge, or the vertex that it starts from or leads to.
#[inline(always)]
fn feature<V: Lanes>(s: V, edge: f64, from: f64, to: f64) -> V {
    let end = V::select(s.equal(s.num(1.0)), s.num(to), s.num(edge));
    V::select(s.equal(s.num(0.0)), s.num(from), end)
}

/// The nearest points of triangles with corners `a`, `b`, `c`, seen from `p`.
#[inline(always)]
fn candidate<V: Lanes>(p: Vec3<V>, [a, b, c]: [Vec3<V>; 3]) -> Candidate<V> {
    let (zero, one) = (p.x.num(0.0), p.x.num(1.0));
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let (a, b, c) = (a - p, b - p, c - p);
    let (d, s) = edge(a, b, ab);
    let mut best = Candidate { square: d, u: s, v: zero, feature: feature(s, 1.0, 4.0, 5.0) };
    let (d, s) = edge(b, c, bc);
    best = best.nearer(Candidate { square: d, u: one - s, v: s, feature: feature(s, 2.0, 5.0, 6.0) });
    let (d, s) = edge(c, a, ca);
    best = best.nearer(Candidate { square: d, u: zero, v: one - s, feature: feature(s, 3.0, 6.0, 4.0) });

    // The foot of the perpendicular. The normal's longest component is scaled to one: its square may overflow or vanish.
    let n = ab.cross(-ca);
    let largest = n.x.abs().max(n.y.abs()).max(n.z.abs());
    let unit = Vec3::new(n.x / largest, n.y / largest, n.z / largest);
    let double_area = n.dot(unit);
    let (mut u, mut v, mut foot) = (zero, zero, a);
    // Again from what is left: on slivers one solution is far from the foot, along the plane. What remains perpendicular
    // is right to the rounding of the corners however ill-conditioned the weights are.
    for _ in 0..STEPS {
        u = u + foot.cross(ca).dot(unit) / double_area;
        v = v + foot.cross(ab).dot(unit) / double_area;
        foot = a + ab * u - ca * v;
    }
    let inside = zero.less(u) & zero.less(v) & (u + v).less(one);
    let foot = Candidate { square: foot.length_squared(), u, v, feature: zero };
    best.or(inside & foot.square.less(best.square), foot)
}

/// Keeps the nearest point to `p` of a leaf's triangles.
#[inline(always)]
pub fn leaf<T: Real, S: Simd>(s: S, blocks: &[Block<T>], p: [T; 3], nearest: &mut Nearest<T>) {
    let point = Vec3::new(splat4(s, p[0]), splat4(s, p[1]), splat4(s, p[2]));
    for block in blocks {
        let order = [0, 1, 2];
        let [a, b, c] = [corner(s, block, 0, order), corner(s, block, 1, order), corner(s, block, 2, order)];
        let corners = [Vec3::from(a), Vec3::from(b), Vec3::from(c)];
        let found = candidate(point, corners);
        let own = own_box(point, corners);
        let square = Lanes::max(found.square, own);
        let end: T::V4<S> = SimdBase::splat(s, nearest.square);
        let mut bits = T::V4::<S>::bits(Lanes::less_eq(square, end));
        let (square, u, v, feature) =
            (square.to_array(), found.u.to_array(), found.v.to_array(), found.feature.to_array());
        while bits != 0 {
            let l = bits.trailing_zeros() as usize & (BLOCK - 1);
            bits &= bits - 1;
            let face = block.faces[l];
            let nearer = square[l] < nearest.square || (square[l] == nearest.square && face < nearest.face);
            // Empty lanes are of face -1.
            if face >= 0 && nearer {
                *nearest = Nearest {
                    square: square[l],
                    u: u[l],
                    v: v[l],
                    face,
                    feature: feature[l].to_f64() as i32,
                    corners: block.vertices.map(|v| v.map(|x| x[l])),
                };
            }
        }
    }
}

/// The squared distances from triangles' own boxes, as [`box_square`] has them: differences round monotonically.
#[inline(always)]
fn own_box<V: Lanes>(p: Vec3<V>, [a, b, c]: [Vec3<V>; 3]) -> V {
    let low = Vec3::new(a.x.min(b.x).min(c.x), a.y.min(b.y).min(c.y), a.z.min(b.z).min(c.z));
    let high = Vec3::new(a.x.max(b.x).max(c.x), a.y.max(b.y).max(c.y), a.z.max(b.z).max(c.z));
    box_square(p, low, high)
}

/// The squared distance from a point to a box.
#[inline(always)]
pub fn box_square<V: Lanes>(p: Vec3<V>, low: Vec3<V>, high: Vec3<V>) -> V {
    let zero = p.x.num(0.0);
    let (below, above) = (low - p, p - high);
    let apart = Vec3::new(
        below.x.max(above.x).max(zero),
        below.y.max(above.y).max(zero),
        below.z.max(above.z).max(zero),
    );
    apart.length_squared()
}
