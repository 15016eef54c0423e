//! A ray against a flat polygon with any number of vertices, convex or not, from either side.
//!
//! The vertices are sheared into the ray's frame, as for triangles, and the polygon winds around the ray or not: the
//! sign of every edge function is exact for vertices that are rounded alike in all polygons that share them. So no ray
//! passes between polygons that share edges. The distance is that of the plane with Newell's normal through the mean of
//! the vertices.
//!
//! S. Woop, C. Benthin, I. Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013; I. Sutherland, R. Sproull,
//! R. Schumacker, *A Characterization of Ten Hidden-Surface Algorithms*, 1974 (Newell's normal).

use super::point_in_polygon::{Place, Rule, count};
use super::ray_triangle::{dominant_axis, permutation};
use crate::math::exact::{all_finite, difference_of_products, exponent, largest, scaled};
use crate::real::Real;
use crate::vec::Vec3;

/// Where a ray meets the plane of its polygon, and how the polygon lies around it.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<T> {
    /// Infinite if the ray misses.
    pub t: T,
    /// The unit normal about which the vertices run counter-clockwise.
    pub normal: Vec3<T>,
    pub place: Place,
}

/// Hits lie in the open interval `(t_min, t_max)`; the border belongs to the polygon. NaN, infinity or a direction of no
/// length give NaN.
pub fn ray_polygon<T: Real>(
    origin: Vec3<T>,
    direction: Vec3<T>,
    polygon: &[[T; 3]],
    rule: Rule,
    t_min: T,
    t_max: T,
) -> Crossing<T> {
    let longest = largest(direction);
    let none = Vec3::new(T::NAN, T::NAN, T::NAN);
    let mut proper = all_finite(origin) && all_finite(direction) && longest >= T::MIN_POSITIVE;
    proper &= polygon.iter().all(|&p| all_finite(p.into())) && !t_min.is_nan() && !t_max.is_nan();
    let (Some(&first), Some(&last), true) = (polygon.first(), polygon.last(), proper) else {
        return Crossing { t: T::NAN, normal: none, place: Place::default() };
    };
    // A power of two, so that no digit is lost.
    let e = exponent(longest);
    let d = direction * T::exp2i(-e);
    let [i, j, k] = permutation(dominant_axis(d.to_array()));
    let [dx, dy, dz] = [i, j, k].map(|a| d.to_array()[a]);
    // As the triangle's test has it, so that the two fit together at an edge.
    let inverse = T::one() / dz;
    let (sx, sy) = (dx * inverse, dy * inverse);
    let sheared = |p: [T; 3]| {
        let p = (Vec3::from(p) - origin).to_array();
        [p[i] - sx * p[k], p[j] - sy * p[k]]
    };
    let zero = T::zero();
    let mut place = count(
        polygon.iter().map(|&p| sheared(p)),
        sheared(last),
        |p| p[1] > zero,
        |a, b| {
            let apart = |a: T, b: T| (a < zero && b < zero) || (a > zero && b > zero);
            apart(a[0], b[0]) || apart(a[1], b[1])
        },
        |a, b| {
            let turn = difference_of_products(a[0], b[1], a[1], b[0]);
            i32::from(turn > zero) - i32::from(turn < zero)
        },
    );

    // As seen from the origin of the ray.
    if dz > zero {
        place.winding = -place.winding;
    }

    // Newell's normal and the mean, both from the first vertex, which may be far away.
    let (mut normal, mut mean) = (Vec3::splat(zero), Vec3::splat(zero));
    let first = Vec3::from(first);
    let mut a = Vec3::from(last) - first;
    for &p in polygon {
        let b = Vec3::from(p) - first;
        (normal, mean) = (normal + a.cross(b), mean + b);
        a = b;
    }
    let mean = mean * (T::one() / T::of(polygon.len() as f64));
    let normal = normal * T::exp2i(-exponent(largest(normal)));
    let t = scaled(normal.dot((first - origin) + mean) / normal.dot(d), -e);
    let hit = (place.on_border || place.inside(rule)) && t.is_finite() && t > t_min && t < t_max;
    let normal = if largest(normal) > zero { normal.normalize() } else { none };
    Crossing { t: if hit { t } else { T::INFINITY }, normal, place }
}
