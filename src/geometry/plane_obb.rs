//! On which side of a plane does an oriented box lie? The height of its centre against the reach of its half edges
//! along the normal, decided exactly for the box as given: the points `c + Σ xᵢ aᵢ` with `|xᵢ| ≤ hᵢ`, be the axes
//! orthonormal or not. 1 in front, -1 behind, 0 where the plane meets it, as [`super::plane_aabb`].

use super::predicate::{self, Number, Point};
use crate::real::Real;
use std::cmp::Ordering;

/// An oriented box: centre, axes, half extents along them.
#[derive(Clone, Copy, Debug)]
pub struct Obb {
    pub center: Point,
    pub axes: [Point; 3],
    pub half: Point,
}

impl Obb {
    /// Axes come as the rows of a matrix.
    #[inline(always)]
    pub fn new<T: Real>(center: [T; 3], axes: [T; 9], half: [T; 3]) -> Self {
        let row = |i: usize| predicate::point([axes[3 * i], axes[3 * i + 1], axes[3 * i + 2]]);
        let axes = [row(0), row(1), row(2)];
        Self { center: predicate::point(center), axes, half: predicate::point(half) }
    }
    /// All finite, no half extent negative.
    #[inline(always)]
    pub fn exists(&self) -> bool {
        predicate::finite(self.center)
            && self.axes.iter().all(|&a| predicate::finite(a))
            && predicate::finite(self.half)
            && self.half.iter().all(|&h| h >= 0.0)
    }
    /// How far the box reaches from its centre along `n`, in units of its length.
    #[inline(always)]
    pub fn reach<N: Number>(&self, n: &[N; 3]) -> N {
        let part =
            |i: usize| N::of(self.half[i]).times(&predicate::dot(n, &predicate::vector(self.axes[i])).abs());
        part(0).plus(&part(1)).plus(&part(2))
    }
}

#[inline(always)]
fn above<N: Number>(n: Point, d: f64, b: &Obb) -> N {
    super::plane_aabb::height::<N>(n, d, b.center).minus(&b.reach(&predicate::vector(n)))
}

#[inline(always)]
fn below<N: Number>(n: Point, d: f64, b: &Obb) -> N {
    super::plane_aabb::height::<N>(n, d, b.center).plus(&b.reach(&predicate::vector(n)))
}

#[inline(never)]
pub fn plane_obb<T: Real>(plane: [T; 4], center: [T; 3], axes: [T; 9], half: [T; 3]) -> i8 {
    let [x, y, z, d] = predicate::four(plane);
    let (n, b) = ([x, y, z], Obb::new(center, axes, half));
    if !(predicate::finite([x, y, z, d]) && b.exists()) {
        return 0;
    }
    if predicate::sign(above(n, d, &b), || above(n, d, &b)) == Ordering::Greater {
        return 1;
    }
    -((predicate::sign(below(n, d, &b), || below(n, d, &b)) == Ordering::Less) as i8)
}

/// The signed distance of the box's centre from the plane, and half the extent of the box along the normal; NaN if there
/// is no box.
#[inline(never)]
pub fn interval<T: Real>(plane: [T; 4], center: [T; 3], axes: [T; 9], half: [T; 3]) -> [T; 2] {
    let [x, y, z, d] = predicate::four(plane);
    let (n, b) = ([x, y, z], Obb::new(center, axes, half));
    if !b.exists() {
        return [T::NAN; 2];
    }
    let length = (x * x + y * y + z * z).sqrt();
    let centre = super::plane_aabb::height::<predicate::Bounded>(n, d, b.center).value;
    let radius = b.reach::<predicate::Bounded>(&predicate::vector(n)).value;
    [T::of(centre / length), T::of(radius / length)]
}
