//! The nearest point of the mesh: branch and bound, a node's eight boxes in lanes, the nearest child first.

use super::Bvh;
use super::node::{Child, Entry, Stack, key};
use super::single::{next, planes, splat8};
use crate::accel::nearest::{Nearest, box_square, leaf};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Pieces, Watch};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crate::vec::Vec3;

/// Points a task.
const PIECE: usize = 256;

impl<T: Real> Bvh<T> {
    /// Coordinates of points beyond this would overflow when squared.
    pub const LARGEST_POINT: f64 = if T::DOUBLE { 1e150 } else { 1e18 };

    /// The point of the mesh nearest to `p`, which must be a [`Self::is_point`], if it is nearer than `max_distance`.
    #[inline(always)]
    pub fn closest_point<S: Simd>(&self, s: S, p: [T; 3], max_distance: T) -> Nearest<T> {
        let mut nearest = Nearest::within(max_distance);
        let point = Vec3::new(splat8::<T, S>(s, p[0]), splat8::<T, S>(s, p[1]), splat8::<T, S>(s, p[2]));
        let mut stack = Stack::new();
        stack.push(Entry::new(T::zero(), Child::ROOT));
        while let Some(entry) = stack.pop() {
            if entry.after(key(nearest.square)) {
                continue;
            }
            let child = entry.child();
            if child.is_leaf() {
                leaf(s, self.run(child), p, &mut nearest);
                continue;
            }
            let node = self.node(child);
            let low = Vec3::new(planes(s, node, 0, 0), planes(s, node, 0, 1), planes(s, node, 0, 2));
            let high = Vec3::new(planes(s, node, 1, 0), planes(s, node, 1, 1), planes(s, node, 1, 2));
            // Empty slots are at infinity.
            let squares = box_square(point, low, high);
            let mask = Lanes::less_eq(squares, splat8::<T, S>(s, nearest.square));
            let below = Lanes::less(squares, splat8::<T, S>(s, T::INFINITY));
            let (mut bits, squares) = (T::V8::<S>::bits(mask & below), squares.to_array());
            let base = stack.len();
            while let Some(other) = next(&mut bits, node, &squares) {
                stack.insert(base, other);
            }
        }
        nearest
    }

    /// [`Self::closest_point`] by every triangle: what it must equal to the bit.
    #[inline(always)]
    pub fn closest_point_of_all<S: Simd>(&self, s: S, p: [T; 3], max_distance: T) -> Nearest<T> {
        let mut nearest = Nearest::within(max_distance);
        leaf(s, &self.blocks, p, &mut nearest);
        nearest
    }

    /// Whether `p` is finite and not so far away that its squared distance overflows.
    #[inline(always)]
    pub fn is_point(p: [T; 3]) -> bool {
        p.iter().all(|&x| Lanes::abs(x) <= T::of(Self::LARGEST_POINT))
    }
}

/// Where nearest points go.
pub struct Found<'a, T> {
    pub point: &'a mut [[T; 3]],
    pub distance: &'a mut [T],
    pub face: &'a mut [i32],
    pub u: &'a mut [T],
    pub v: &'a mut [T],
    pub feature: &'a mut [i32],
}

impl<T: Real> Found<'_, T> {
    #[inline(always)]
    fn put(&mut self, i: usize, nearest: Option<Nearest<T>>) {
        let nan = [T::NAN; 3];
        (self.point[i], self.distance[i], self.face[i], self.u[i], self.v[i], self.feature[i]) = match nearest
        {
            None => (nan, T::NAN, -1, T::NAN, T::NAN, -1),
            Some(n) if n.face < 0 => (nan, T::INFINITY, -1, T::zero(), T::zero(), -1),
            Some(n) => (n.point(), n.distance(), n.face, n.u, n.v, n.feature),
        };
    }
}

impl<T: Send> Pieces for Found<'_, T> {
    fn items(&self) -> usize {
        self.distance.len()
    }
    fn cut(self, at: usize) -> (Self, Self) {
        let ((point, p2), (distance, d2)) = (self.point.split_at_mut(at), self.distance.split_at_mut(at));
        let ((face, f2), (feature, e2)) = (self.face.split_at_mut(at), self.feature.split_at_mut(at));
        let ((u, u2), (v, v2)) = (self.u.split_at_mut(at), self.v.split_at_mut(at));
        let rest = Found { point: p2, distance: d2, face: f2, u: u2, v: v2, feature: e2 };
        (Found { point, distance, face, u, v, feature }, rest)
    }
}

/// The nearest points of arrays of points; one limit for all, or each its own. With `ALL`, by every triangle.
pub fn closest_points<const ALL: bool, T: Real>(
    watch: &mut dyn Watch,
    tree: &Bvh<T>,
    points: &[[T; 3]],
    max_distance: &[T],
    found: Found<T>,
) -> Result<(), Interrupted> {
    let piece = if ALL { (PIECE << 12) / tree.faces().max(1 << 10) } else { PIECE };
    parallel::for_each(watch, found, piece, |first, mut found| {
        dispatch!(s => for i in 0..found.distance.len() {
            let p = points[first + i];
            let limit = if max_distance.len() == 1 { max_distance[0] } else { max_distance[first + i] };
            let proper = Bvh::is_point(p) && limit.equal(limit);
            let nearest = match (proper, ALL) {
                (false, _) => None,
                (_, true) => Some(tree.closest_point_of_all(s, p, limit)),
                (_, false) => Some(tree.closest_point(s, p, limit)),
            };
            found.put(i, nearest);
        })
    })
}
