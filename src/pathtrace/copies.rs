//! Meshes that stand in a scene many times: traced by two levels, and read in their own space at a hit.
//!
//! A copy costs its matrices and a box of the upper tree. What moves, what emits and what stands there once is in the
//! arrays of the world as ever, and comes first: rays are traced against it in packets, and then, as far as that hit,
//! against the copies.

use super::Surfaces;
use crate::accel::bvh::instances::{Affine, Instances};
use crate::accel::{Hit, Ray};
use crate::real::Real;
use crate::simd::Simd;
use crate::vec::Vec3;

/// What a copy is of.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Where the faces of its mesh begin among all.
    pub first_face: i32,
    /// Where its materials begin in [`Copies::slots`].
    pub first_slot: i32,
    /// A mirror image, whose faces are turned round.
    pub mirrored: bool,
}

/// Placed copies of meshes.
pub struct Copies<'a, T> {
    pub tree: &'a Instances<T>,
    /// One for each instance of the tree.
    pub placements: &'a [Placement],
    /// Rows of materials, that faces of copies number for themselves.
    pub slots: &'a [i32],
}

/// Whether an affine matrix turns right into left.
#[cfg_attr(not(feature = "python"), allow(dead_code))] // asked for by Python alone
pub fn mirrors(m: &Affine) -> bool {
    let [x, y, z] = [m[0], m[1], m[2]].map(|r| Vec3::new(r[0], r[1], r[2]));
    x.cross(y).dot(z) < 0.0
}

impl<T: Real> Copies<'_, T> {
    /// The nearest of hits with the rest of the world and with copies; the numbers of these, -1 for the rest.
    #[inline(always)]
    pub fn closest_hits<S: Simd>(&self, s: S, rays: &[Ray<T>], hits: &mut [Hit<T>], copies: &mut [i32]) {
        for i in 0..rays.len() {
            copies[i] = -1;
            let mut ray = rays[i];
            if hits[i].t.is_nan() {
                continue;
            }
            ray.t_max = if hits[i].t < ray.t_max { hits[i].t } else { ray.t_max };
            let (mut hit, copy) = self.tree.closest_hit(s, &ray);
            if copy < 0 || !(hit.t < hits[i].t) {
                continue;
            }
            let placement = self.placements[copy as usize];
            hit.face += placement.first_face;
            if placement.mirrored {
                hit.v = T::one() - hit.u - hit.v;
            }
            (hits[i], copies[i]) = (hit, copy);
        }
    }

    /// Asks for those that nothing else blocks.
    #[inline(always)]
    pub fn any_hits<S: Simd>(&self, s: S, rays: &[Ray<T>], blocked: &mut [bool]) {
        for i in 0..rays.len() {
            blocked[i] = blocked[i] || self.tree.any_hit(s, &rays[i]);
        }
    }

    /// What stands at the corners of a face, in their order in the world.
    #[inline(always)]
    pub fn turned<X: Copy>(&self, copy: i32, [a, b, c]: [X; 3]) -> [X; 3] {
        if self.placements[copy as usize].mirrored { [c, b, a] } else { [a, b, c] }
    }

    /// Corners in the world.
    #[inline(always)]
    pub fn placed(&self, copy: i32, corners: [[T; 3]; 3]) -> [[T; 3]; 3] {
        let m = &self.tree.get(copy as usize).to_world;
        let mut out = [[T::zero(); 3]; 3];
        for (k, p) in corners.iter().enumerate() {
            for (row, m) in m.iter().enumerate() {
                let x = m[0] * p[0].to_f64() + m[1] * p[1].to_f64() + m[2] * p[2].to_f64() + m[3];
                out[k][row] = T::of(x);
            }
        }
        self.turned(copy, out)
    }

    /// Unit normals in the world; zero stays zero.
    #[inline(always)]
    pub fn carried(&self, copy: i32, normals: [[T; 3]; 3]) -> [[T; 3]; 3] {
        let m = &self.tree.get(copy as usize).to_object;
        let mut out = normals;
        for (k, n) in normals.iter().enumerate() {
            let n = Vec3::new(n[0].to_f64(), n[1].to_f64(), n[2].to_f64());
            let column = |c: usize| Vec3::new(m[0][c], m[1][c], m[2][c]).dot(n);
            let carried = Vec3::new(column(0), column(1), column(2));
            let length = carried.dot(carried).sqrt();
            if length > 0.0 {
                let unit = carried * (1.0 / length);
                out[k] = [T::of(unit.x), T::of(unit.y), T::of(unit.z)];
            }
        }
        self.turned(copy, out)
    }
}

impl<T: Real> Surfaces<'_, T> {
    /// What stands at the corners of a face.
    #[inline(always)]
    fn three(&self, face: usize, of: &[[T; 3]]) -> [[T; 3]; 3] {
        let [i, j, k] = self.faces[face];
        [of[i as usize], of[j as usize], of[k as usize]]
    }

    /// The corners of a face of a copy (-1: of the rest), in the world.
    #[inline(always)]
    pub fn corners_of(&self, face: usize, copy: i32) -> [[T; 3]; 3] {
        let corners = self.three(face, self.positions);
        match self.copies {
            Some(copies) if copy >= 0 => copies.placed(copy, corners),
            _ => corners,
        }
    }

    /// Shading normals at the corners of a face of a copy, in the world.
    #[inline(always)]
    pub fn normals_of(&self, face: usize, copy: i32, normals: &[[T; 3]]) -> [[T; 3]; 3] {
        let normals = self.three(face, normals);
        match self.copies {
            Some(copies) if copy >= 0 => copies.carried(copy, normals),
            _ => normals,
        }
    }

    /// Colours at the corners of a face of a copy.
    #[inline(always)]
    pub fn colors_of(&self, face: usize, copy: i32, colors: &[[T; 3]]) -> [[T; 3]; 3] {
        let colors = self.three(face, colors);
        match self.copies {
            Some(copies) if copy >= 0 => copies.turned(copy, colors),
            _ => colors,
        }
    }

    /// The row of the material of a face of a copy.
    #[inline(always)]
    pub fn row_of(&self, face: usize, copy: i32) -> usize {
        let own = self.material_ids[face];
        match self.copies {
            Some(copies) if copy >= 0 => {
                copies.slots[(copies.placements[copy as usize].first_slot + own) as usize] as usize
            }
            _ => own as usize,
        }
    }
}
