//! Angle-weighted normals of a mesh's vertices and edges, which tell inside from outside wherever the nearest point lies.
//!
//! A vertex's is the sum of its faces' unit normals, each weighted by the face's angle there; an edge's that of the faces that
//! share it. Vertices at one position count as one. Double precision in both.
//!
//! J. A. Bærentzen, H. Aanæs, *Signed Distance Computation Using the Angle Weighted Pseudonormal*, 2005.

use crate::math::atan2;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::vec::Vec3;
use rayon::prelude::*;

type V = Vec3<f64>;

/// Normals of faces, of their edges ab, bc, ca, and of vertices.
pub struct Pseudonormals {
    faces: Vec<[i32; 3]>,
    of_faces: Vec<V>,
    of_edges: Vec<[V; 3]>,
    of_vertices: Vec<V>,
}

impl Pseudonormals {
    pub fn new<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]]) -> Self {
        let faces = weld(positions, faces);
        let at = |i: i32| Vec3::from(positions[i as usize].map(|x| x.to_f64()));
        let normal = |&[a, b, c]: &[i32; 3]| {
            let (a, b, c) = (at(a), at(b), at(c));
            let n = (b - a).normalize().cross((c - a).normalize()).normalize();
            // Faces without area point nowhere.
            if n.x.is_nan() { Vec3::splat(0.0) } else { n }
        };
        let of_faces: Vec<V> = faces.par_iter().map(normal).collect();

        let mut of_vertices = vec![Vec3::splat(0.0); positions.len()];
        for (face, &n) in faces.iter().zip(&of_faces) {
            for k in 0..3 {
                let (p, q, r) = (at(face[k]), at(face[(k + 1) % 3]), at(face[(k + 2) % 3]));
                let (e, f) = ((q - p).normalize(), (r - p).normalize());
                let angle = atan2(e.cross(f).length(), e.dot(f));
                if angle > 0.0 {
                    of_vertices[face[k] as usize] = of_vertices[face[k] as usize] + n * angle;
                }
            }
        }

        // Edges by their ends, then all faces at each.
        let ends = |i: usize| {
            let (p, q) = (faces[i / 3][i % 3], faces[i / 3][(i % 3 + 1) % 3]);
            (p.min(q), p.max(q))
        };
        let mut edges: Vec<usize> = (0..3 * faces.len()).collect();
        edges.par_sort_unstable_by_key(|&i| (ends(i), i));
        let mut of_edges = vec![[Vec3::splat(0.0); 3]; faces.len()];
        for shared in edges.chunk_by(|&i, &j| ends(i) == ends(j)) {
            let sum = shared.iter().fold(Vec3::splat(0.0), |s, &i| s + of_faces[i / 3]);
            shared.iter().for_each(|&i| of_edges[i / 3][i % 3] = sum);
        }
        Pseudonormals { faces, of_faces, of_edges, of_vertices }
    }

    /// The normal where a nearest point lies: on a face, its edge 1 to 3, or its vertex 4 to 6.
    #[inline(always)]
    fn at(&self, face: usize, feature: i32) -> V {
        match feature {
            0 => self.of_faces[face],
            1..=3 => self.of_edges[face][feature as usize - 1],
            _ => self.of_vertices[self.faces[face][feature as usize - 4] as usize],
        }
    }
}

/// Faces over vertices of which no two are at one position.
fn weld<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]]) -> Vec<[i32; 3]> {
    // Zero has two signs.
    let place = |i: &i32| positions[*i as usize].map(|x| x + T::zero());
    let order = |i: &i32, j: &i32| place(i).partial_cmp(&place(j)).expect("positions are finite");
    let mut sorted: Vec<i32> = (0..positions.len() as i32).collect();
    sorted.par_sort_unstable_by(|i, j| order(i, j).then(i.cmp(j)));
    let mut first = vec![0; positions.len()];
    for same in sorted.chunk_by(|i, j| place(i) == place(j)) {
        same.iter().for_each(|&i| first[i as usize] = same[0]);
    }
    faces.iter().map(|f| f.map(|i| first[i as usize])).collect()
}

/// Nearest points of a mesh, as [`super::bvh::closest`] finds them.
pub struct NearestPoints<'a, T> {
    pub point: &'a [[T; 3]],
    pub face: &'a [i32],
    pub feature: &'a [i32],
}

/// Turns the distances of points inside negative.
pub fn sign<T: Real>(
    watch: &mut dyn Watch,
    normals: &Pseudonormals,
    points: &[[T; 3]],
    nearest: &NearestPoints<T>,
    distance: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (points, distance),
        1 << 14,
        |first, (points, distance): (&[[T; 3]], &mut [T])| {
            for (i, (p, distance)) in points.iter().zip(distance).enumerate() {
                let face = nearest.face[first + i];
                if face < 0 {
                    continue;
                }
                let away = std::array::from_fn(|k| p[k].to_f64() - nearest.point[first + i][k].to_f64());
                let normal = normals.at(face as usize, nearest.feature[first + i]);
                if Vec3::from(away).dot(normal) < 0.0 {
                    *distance = -*distance;
                }
            }
        },
    )
}
