//! What a ray meets: the mesh with its materials, read at a hit.

use super::Emitters;
use crate::accel::{Bvh, Hit};
use crate::brdf::metallic_roughness::{Lobes, Materials};
use crate::light::Light;
use crate::real::Real;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// A scene in world space. Indices are in range, and every face has a material.
pub struct Surfaces<'a, T> {
    pub bvh: &'a Bvh<T>,
    pub positions: &'a [[T; 3]],
    pub faces: &'a [[i32; 3]],
    /// Shading normals of vertices.
    pub normals: Option<&'a [[T; 3]]>,
    /// Colours of vertices, by which base colours are multiplied.
    pub colors: Option<&'a [[T; 3]]>,
    pub material_ids: &'a [i32],
    pub materials: Materials<'a, T>,
    /// Radiance that each material emits, from both sides.
    pub emission: &'a [[T; 3]],
    pub emitters: &'a Emitters,
    pub lights: &'a [Light<T>],
    pub background: Vec3<T>,
    /// How far above a surface rays start.
    pub offset: T,
}

/// A point of a surface, as seen from a direction.
#[derive(Clone, Copy)]
pub struct Spot<T> {
    pub point: Vec3<T>,
    /// Unit, of the face, on the side that is seen.
    pub normal: Vec3<T>,
    /// About the shading normal.
    pub frame: Frame<T>,
    /// Towards where it is seen from, in the frame.
    pub wo: Vec3<T>,
    pub lobes: Lobes<T>,
    pub emission: [T; 3],
}

impl<T: Real> Surfaces<'_, T> {
    #[inline(always)]
    pub fn corners(&self, face: usize) -> [Vec3<T>; 3] {
        self.faces[face].map(|v| self.positions[v as usize].into())
    }

    /// The attribute at a hit, from those of the face's vertices.
    #[inline(always)]
    fn interpolate(&self, of_vertices: &[[T; 3]], hit: &Hit<T>) -> Vec3<T> {
        let [a, b, c] = self.faces[hit.face as usize].map(|v| Vec3::from(of_vertices[v as usize]));
        a * (T::one() - hit.u - hit.v) + b * hit.u + c * hit.v
    }

    /// The surface at a hit, met along the unit `direction`; None on a face without area.
    #[inline(always)]
    pub fn at(&self, hit: &Hit<T>, direction: Vec3<T>) -> Option<Spot<T>> {
        let face = hit.face as usize;
        let [a, b, c] = self.corners(face);
        let mut normal = (b - a).cross(c - a).normalize();
        if normal.x.is_nan() {
            return None;
        }
        if normal.dot(direction) > T::zero() {
            normal = -normal;
        }
        let mut shading = normal;
        if let Some(normals) = self.normals {
            let n = self.interpolate(normals, hit).normalize();
            let n = if n.dot(normal) < T::zero() { -n } else { n };
            // Where interpolation turns the normal away from the eye (silhouettes), or gives none, the face's serves.
            if n.dot(direction) < T::zero() {
                shading = n;
            }
        }
        let row = self.material_ids[face] as usize;
        let mut material = self.materials.at(row);
        if let Some(colors) = self.colors {
            material.base_color = material.base_color.times(self.interpolate(colors, hit));
        }
        let frame = Frame::about(shading);
        Some(Spot {
            point: self.interpolate(self.positions, hit),
            normal,
            frame,
            wo: frame.local(-direction),
            lobes: material.lobes(),
            emission: self.emission[row],
        })
    }
}
