//! Unit normals of faces, and of vertices as weighted means of the faces around them.
//!
//! Weights: the angle of the corner at the vertex (does not depend on how a flat region is cut into triangles), the
//! area of the face, or none. Degenerate faces have no normal (NaN) and take no part in those of vertices; a vertex
//! without a face has none either.
//!
//! G. Thürmer, C. Wüthrich, *Computing vertex normals from polygonal facets*, 1998 (angle weights).

use crate::dispatch;
use crate::math::atan2;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    Angle,
    Area,
    Uniform,
}

/// Faces a piece, and faces between two looks at the watch where vertices are gathered.
const PIECE: usize = 1 << 14;

#[inline(always)]
fn corners<T: Real>(positions: &[[T; 3]], face: [i32; 3]) -> [Vec3<T>; 3] {
    face.map(|i| positions[i as usize].into())
}

/// The edges over their largest component, so that products neither overflow nor vanish, and that component.
#[inline(always)]
fn edges<T: Real>([a, b, c]: [Vec3<T>; 3]) -> ([Vec3<T>; 3], T) {
    let e = [b - a, c - b, a - c];
    let largest = e.iter().flat_map(|e| e.to_array()).fold(T::zero(), |m, x| x.abs().max(m));
    (e.map(|e| e.map(|x| x / largest)), largest)
}

/// The cross product of scaled edges, taken at the corner between the two shortest edges, where it loses the least.
#[inline(always)]
fn cross<T: Real>([ab, bc, ca]: [Vec3<T>; 3]) -> Vec3<T> {
    let [l, m, n] = [ab, bc, ca].map(Vec3::length_squared);
    if l >= m && l >= n {
        bc.cross(ca)
    } else if m >= n {
        ca.cross(ab)
    } else {
        ab.cross(bc)
    }
}

/// The unit normal of each face.
pub fn face_normals<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (faces, out),
        PIECE,
        |_, (faces, out): (&[[i32; 3]], &mut [[T; 3]])| dispatch!(_s => faces_body(positions, faces, out)),
    )
}

#[inline(always)]
fn faces_body<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]], out: &mut [[T; 3]]) {
    for (out, &face) in out.iter_mut().zip(faces) {
        *out = cross(edges(corners(positions, face)).0).normalize().to_array();
    }
}

/// The unit normal of each vertex. `scale` is of the order of the largest edge, so that areas stay in range.
pub fn vertex_normals<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    weights: Weights,
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    // What each face gives to its corners, in parallel; areas are relative to the largest edge of all.
    let scale = longest(positions, faces);
    let mut shares = vec![[[T::zero(); 3]; 3]; faces.len()];
    parallel::for_each(
        watch,
        (faces, &mut shares[..]),
        PIECE,
        |_, (faces, shares): (&[[i32; 3]], &mut [[[T; 3]; 3]])| dispatch!(_s => shares_body(positions, faces, weights, scale, shares)),
    )?;
    // Gathered in the order of faces, in double: sums do not depend on threads, and valence costs no digits.
    let mut sums = vec![[0.0f64; 3]; positions.len()];
    for (piece, (faces, shares)) in faces.chunks(64 * PIECE).zip(shares.chunks(64 * PIECE)).enumerate() {
        for (face, shares) in faces.iter().zip(shares) {
            for (&vertex, share) in face.iter().zip(shares) {
                let sum = &mut sums[vertex as usize];
                *sum = std::array::from_fn(|k| sum[k] + share[k].to_f64());
            }
        }
        if watch.tick(piece * 64 * PIECE, faces.len()).is_break() {
            return Err(Interrupted);
        }
    }
    parallel::for_each(watch, (&sums[..], out), PIECE, |_, (sums, out): (&[[f64; 3]], &mut [[T; 3]])| {
        for (out, &sum) in out.iter_mut().zip(sums) {
            *out = Vec3::from(sum).normalize().map(T::of).to_array();
        }
    })
}

/// The largest component of any edge.
fn longest<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]]) -> T {
    faces.iter().fold(T::MIN_POSITIVE, |m, &face| edges(corners(positions, face)).1.max(m))
}

#[inline(always)]
fn shares_body<T: Real>(
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    weights: Weights,
    scale: T,
    shares: &mut [[[T; 3]; 3]],
) {
    for (shares, &face) in shares.iter_mut().zip(faces) {
        let (e, largest) = edges(corners(positions, face));
        let n = cross(e);
        let double_area = n.length();
        // False for NaN as well.
        let solid = double_area > T::zero();
        let unit = if solid { n.normalize() } else { Vec3::splat(T::zero()) };
        let weight = match weights {
            Weights::Uniform => [T::one(); 3],
            // Both factors at most one.
            Weights::Area => [double_area * (largest / scale) * (largest / scale); 3],
            // Corner k lies between edges k - 1 and k.
            Weights::Angle => [0, 1, 2].map(|k| atan2(double_area, -e[(k + 2) % 3].dot(e[k]))),
        };
        *shares = weight.map(|w| (unit * if solid { w } else { T::zero() }).to_array());
    }
}
