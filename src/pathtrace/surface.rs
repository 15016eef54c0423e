//! What a ray meets: the mesh with its materials, read at a hit.

use super::Emitters;
use super::copies::Copies;
use crate::accel::{Bvh, Hit, Ray};
use crate::brdf::Bsdf;
use crate::brdf::Row;
use crate::environment::panorama::Panorama;
use crate::light::Light;
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// A scene in world space, but for copies of meshes. Indices are in range, and every face has a material.
pub struct Surfaces<'a, T> {
    /// Of all but the copies.
    pub bvh: &'a Bvh<T>,
    /// Meshes whose faces follow those of the world, in their own space.
    pub copies: Option<&'a Copies<'a, T>>,
    pub positions: &'a [[T; 3]],
    pub faces: &'a [[i32; 3]],
    /// Shading normals of vertices.
    pub normals: Option<&'a [[T; 3]]>,
    /// Colours of vertices, by which base colours are multiplied.
    pub colors: Option<&'a [[T; 3]]>,
    pub material_ids: &'a [i32],
    /// Of each material: its kind of reflection model, and the model's parameters.
    pub kinds: &'a [i32],
    pub rows: &'a [Row<T>],
    /// Radiance that each material emits, from both sides.
    pub emission: &'a [[T; 3]],
    pub emitters: &'a Emitters,
    pub lights: &'a [Light<T>],
    /// Radiance from where nothing is.
    pub background: Vec3<T>,
    pub environment: Option<&'a Panorama<T>>,
    /// How far above a surface rays start.
    pub offset: T,
}

/// A point of a surface, as seen from a direction.
#[derive(Clone, Copy)]
pub struct Spot<T> {
    pub point: Vec3<T>,
    /// Unit, of the face, on the side that is seen.
    pub normal: Vec3<T>,
    /// About the shading normal: on the side that is seen, or out of a body that light passes.
    pub frame: Frame<T>,
    /// Towards where it is seen from, in the frame.
    pub wo: Vec3<T>,
    pub bsdf: Bsdf<T>,
}

impl<T: Real> Spot<T> {
    /// The shading normal, if light counts from its side alone; else zero.
    #[inline(always)]
    pub fn side(&self) -> Vec3<T> {
        if self.bsdf.transmits() { Vec3::splat(T::zero()) } else { self.frame.z }
    }
    /// Whether a direction, in the frame and in the world, lies on one side by both normals.
    #[inline(always)]
    pub fn agrees(&self, local: Vec3<T>, world: Vec3<T>) -> bool {
        let (zero, same) = (T::zero(), local.z * self.wo.z);
        let seen = world.dot(self.normal);
        (same > zero && seen > zero) || (same < zero && seen < zero)
    }
}

/// A point of a face and its normals, one or lanes of them.
#[derive(Clone, Copy)]
pub struct Facing<V: Lanes> {
    pub point: Vec3<V>,
    /// Unit, of the face, on the side that is seen; NaN on a face without area.
    pub normal: Vec3<V>,
    /// Unit, interpolated, on the same side.
    pub shading: Vec3<V>,
    /// Where the face is seen from behind.
    pub back: V::Mask,
}

/// `a` where the mask holds, `b` elsewhere.
#[inline(always)]
pub fn choose<V: Lanes>(mask: V::Mask, a: Vec3<V>, b: Vec3<V>) -> Vec3<V> {
    a.zip(
        b,
        #[inline(always)]
        |a, b| V::select(mask, a, b),
    )
}

/// The value at barycentric coordinates, from those at the corners.
#[inline(always)]
pub fn between<V: Lanes>([a, b, c]: [Vec3<V>; 3], u: V, v: V) -> Vec3<V> {
    a * (u.num(1.0) - u - v) + b * u + c * v
}

impl<V: Lanes> Facing<V> {
    /// From the corners and their shading normals, met along a unit direction.
    #[inline(always)]
    pub fn of(corners: [Vec3<V>; 3], normals: Option<[Vec3<V>; 3]>, u: V, v: V, direction: Vec3<V>) -> Self {
        let zero = u.num(0.0);
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        let back = zero.less(normal.dot(direction));
        let normal = choose(back, -normal, normal);
        let mut shading = normal;
        if let Some(normals) = normals {
            let n = between(normals, u, v).normalize();
            let n = choose(n.dot(normal).less(zero), -n, n);
            // Where interpolation turns the normal away from the eye (silhouettes), or gives none, the face's serves.
            shading = choose(n.dot(direction).less(zero), n, normal);
        }
        Facing { point: between(corners, u, v), normal, shading, back }
    }
}

impl<T: Real> Surfaces<'_, T> {
    /// The nearest hits, and the copies of meshes that they are of, -1 for none; without copies those stay as they are.
    #[inline(always)]
    pub fn closest_hits<S: Simd>(&self, s: S, rays: &[Ray<T>], hits: &mut [Hit<T>], copies: &mut [i32]) {
        self.bvh.closest_hits(s, rays, hits);
        if let Some(placed) = self.copies {
            placed.closest_hits(s, rays, hits, copies);
        }
    }

    #[inline(always)]
    pub fn corners(&self, face: usize) -> [Vec3<T>; 3] {
        self.faces[face].map(|v| self.positions[v as usize].into())
    }

    /// The unit normal of a face; NaN without area.
    #[inline(always)]
    pub fn face_normal(&self, face: usize) -> Vec3<T> {
        let [a, b, c] = self.corners(face);
        (b - a).cross(c - a).normalize()
    }

    /// The surface at a hit with a copy of a mesh (-1: with the rest), met along the unit `direction`; None on a face
    /// without area.
    #[inline(always)]
    pub fn at(&self, hit: &Hit<T>, copy: i32, direction: Vec3<T>) -> Option<Spot<T>> {
        let face = hit.face as usize;
        let normals = match self.normals {
            Some(normals) => Some(vectors(self.normals_of(face, copy, normals))),
            None => None,
        };
        let Facing { point, normal, shading, back } =
            Facing::of(vectors(self.corners_of(face, copy)), normals, hit.u, hit.v, direction);
        if normal.x.is_nan() {
            return None;
        }
        let row = self.row_of(face, copy);
        let color = match self.colors {
            Some(colors) => between(vectors(self.colors_of(face, copy, colors)), hit.u, hit.v),
            None => Vec3::splat(T::one()),
        };
        let bsdf = Bsdf::tinted(self.kinds[row], &self.rows[row], color)?;
        let frame = Frame::about(if bsdf.transmits() && back { -shading } else { shading });
        Some(Spot { point, normal, frame, wo: frame.local(-direction), bsdf })
    }
}

#[inline(always)]
fn vectors<T: Real>([a, b, c]: [[T; 3]; 3]) -> [Vec3<T>; 3] {
    [a.into(), b.into(), c.into()]
}
