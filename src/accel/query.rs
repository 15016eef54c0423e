//! Arrays of rays in, arrays of hits out: cut into pieces for the threads.

use super::{Bvh, Hit, Ray};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Pieces, Watch};
use crate::real::Real;
use crate::vec::Vec3;

/// Rays a task: enough that the last rays of a task, with ever fewer beside them, do not matter.
const PIECE: usize = 2048;

/// Rays in arrays; intervals and ignored faces are one for all, or one a ray.
#[derive(Clone, Copy)]
pub struct Rays<'a, T> {
    pub origins: &'a [[T; 3]],
    pub directions: &'a [[T; 3]],
    pub t_min: &'a [T],
    pub t_max: &'a [T],
    pub ignore_face: &'a [i32],
}

impl<T: Real> Rays<'_, T> {
    #[inline(always)]
    pub fn get(&self, i: usize) -> Ray<T> {
        Ray {
            origin: self.origins[i],
            direction: self.directions[i],
            t_min: one_or_each(self.t_min, i),
            t_max: one_or_each(self.t_max, i),
            ignore_face: one_or_each(self.ignore_face, i),
        }
    }
}

#[inline(always)]
fn one_or_each<X: Copy>(list: &[X], i: usize) -> X {
    if list.len() == 1 { list[0] } else { list[i] }
}

/// Where hits go.
pub struct Found<'a, T> {
    pub t: &'a mut [T],
    pub face: &'a mut [i32],
    pub u: &'a mut [T],
    pub v: &'a mut [T],
}

impl<T: Real> Found<'_, T> {
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.t.len()
    }
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }
    #[inline(always)]
    pub fn put(&mut self, i: usize, hit: Hit<T>) {
        (self.t[i], self.face[i], self.u[i], self.v[i]) = (hit.t, hit.face, hit.u, hit.v);
    }
}

impl<T: Send> Pieces for Found<'_, T> {
    fn items(&self) -> usize {
        self.t.len()
    }
    fn cut(self, at: usize) -> (Self, Self) {
        let ((t, t2), (face, face2)) = (self.t.split_at_mut(at), self.face.split_at_mut(at));
        let ((u, u2), (v, v2)) = (self.u.split_at_mut(at), self.v.split_at_mut(at));
        (Found { t, face, u, v }, Found { t: t2, face: face2, u: u2, v: v2 })
    }
}

/// The nearest hits of arrays of rays.
pub fn closest_hits<T: Real>(
    watch: &mut dyn Watch,
    tree: &Bvh<T>,
    rays: &Rays<T>,
    found: Found<T>,
) -> Result<(), Interrupted> {
    parallel::for_each(watch, found, PIECE, |first, mut found| {
        let count = found.len();
        dispatch!(s => tree.trace_batch::<false, _>(s, count, |i| rays.get(first + i), |i, hit| found.put(i, hit)))
    })
}

/// Whether each of an array of rays hits anything.
pub fn any_hits<T: Real>(
    watch: &mut dyn Watch,
    tree: &Bvh<T>,
    rays: &Rays<T>,
    out: &mut [bool],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, out, PIECE, |first, out: &mut [bool]| {
        let count = out.len();
        dispatch!(s => tree.trace_batch::<true, _>(s, count, |i| rays.get(first + i), |i, hit| out[i] = hit.is_hit()))
    })
}

/// Unit normals by winding of the faces that were hit; NaN where none was, and on faces without area.
pub fn normals<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    hit: &[i32],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (hit, out), 1 << 14, |_, (hit, out): (&[i32], &mut [[T; 3]])| {
        for (out, &face) in out.iter_mut().zip(hit) {
            *out = if face < 0 {
                [T::NAN; 3]
            } else {
                let [a, b, c] = faces[face as usize].map(|i| Vec3::from(positions[i as usize]));
                (b - a).cross(c - a).normalize().to_array()
            };
        }
    })
}
