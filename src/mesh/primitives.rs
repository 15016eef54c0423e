//! Box, plane, icosphere and torus, with exact normals. The caller's arrays have the sizes that the counts give.

use crate::math::sin_cos;
use crate::real::Real;
use crate::vec::Vec3;
use std::collections::HashMap;

/// Four vertices a side, so that each side has its own normal and texture coordinates.
pub const BOX: (usize, usize) = (24, 12);

/// An axis-aligned box about the origin, with normals and texture coordinates (each side the unit square).
pub fn fill_box<T: Real>(
    size: [T; 3],
    positions: &mut [[T; 3]],
    normals: &mut [[T; 3]],
    uvs: &mut [[T; 2]],
    faces: &mut [[i32; 3]],
) {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    for side in 0..6 {
        // The normal's axis k; across it u and v, so that u × v is the normal.
        let k = side % 3;
        let sign = if side < 3 { one } else { -one };
        let (u, v) = ((k + 1) % 3, (k + 2) % 3);
        for corner in 0..4 {
            // Counter-clockwise from the lower left.
            let s = [zero, one, one, zero][corner];
            let t = [zero, zero, one, one][corner];
            let at = side * 4 + corner;
            let mut p = [zero; 3];
            p[k] = sign * half * size[k];
            p[u] = sign * (s - half) * size[u];
            p[v] = (t - half) * size[v];
            positions[at] = p;
            normals[at] = [zero; 3];
            normals[at][k] = sign;
            uvs[at] = [s, t];
        }
        let first = side as i32 * 4;
        faces[side * 2] = [first, first + 1, first + 2];
        faces[side * 2 + 1] = [first, first + 2, first + 3];
    }
}

pub fn plane_counts(segments: usize) -> (usize, usize) {
    ((segments + 1) * (segments + 1), 2 * segments * segments)
}

/// A grid in the plane y = 0 about the origin, facing +y; texture coordinate (0, 0) at (-x, +z).
pub fn fill_plane<T: Real>(
    size: [T; 2],
    segments: usize,
    positions: &mut [[T; 3]],
    normals: &mut [[T; 3]],
    uvs: &mut [[T; 2]],
    faces: &mut [[i32; 3]],
) {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let row = segments + 1;
    let step = T::of(segments as f64);
    for i in 0..row {
        for j in 0..row {
            let (s, t) = (T::of(j as f64) / step, T::of(i as f64) / step);
            positions[i * row + j] = [(s - half) * size[0], zero, (half - t) * size[1]];
            normals[i * row + j] = [zero, one, zero];
            uvs[i * row + j] = [s, t];
        }
    }
    for i in 0..segments {
        for j in 0..segments {
            let [a, b] = [i * row + j, i * row + j + 1].map(|v| v as i32);
            let [c, d] = [(i + 1) * row + j + 1, (i + 1) * row + j].map(|v| v as i32);
            let at = 2 * (i * segments + j);
            faces[at] = [a, b, c];
            faces[at + 1] = [a, c, d];
        }
    }
}

pub fn icosphere_counts(subdivisions: usize) -> (usize, usize) {
    (10 * (1 << (2 * subdivisions)) + 2, 20 << (2 * subdivisions))
}

/// A sphere about the origin: an icosahedron whose faces are cut in four, `subdivisions` times. Normals are unit.
pub fn fill_icosphere<T: Real>(
    subdivisions: usize,
    radius: T,
    positions: &mut [[T; 3]],
    normals: &mut [[T; 3]],
    faces: &mut [[i32; 3]],
) {
    // Vertices in double, since midpoints of midpoints add up their rounding.
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut vertices = Vec::with_capacity(positions.len());
    for k in 0..3 {
        for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let mut v = [0.0; 3];
            (v[(k + 1) % 3], v[(k + 2) % 3]) = (s, t * golden);
            vertices.push(Vec3::from(v).normalize());
        }
    }
    let mut cut = icosahedron(&vertices);
    for _ in 0..subdivisions {
        let mut middles = HashMap::with_capacity(cut.len() * 3 / 2);
        let mut next = Vec::with_capacity(cut.len() * 4);
        for [a, b, c] in cut {
            let mut middle = |i: i32, j: i32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    vertices.push((vertices[i as usize] + vertices[j as usize]).normalize());
                    vertices.len() as i32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        cut = next;
    }
    faces.copy_from_slice(&cut);
    for ((p, n), v) in positions.iter_mut().zip(normals).zip(vertices) {
        *n = v.map(T::of).to_array();
        *p = v.map(|c| T::of(c * radius.to_f64())).to_array();
    }
}

/// The faces of the icosahedron: triples of mutual neighbours, turned outwards.
fn icosahedron(vertices: &[Vec3<f64>]) -> Vec<[i32; 3]> {
    // Neighbours are 63.4° apart, all others at least 116.6°.
    let near = |i: usize, j: usize| vertices[i].dot(vertices[j]) > 0.4;
    let mut faces = Vec::with_capacity(20);
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let outward = vertices[a].dot(vertices[b].cross(vertices[c])) > 0.0;
                    let [a, b, c] = [a, b, c].map(|v| v as i32);
                    faces.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    faces
}

pub fn torus_counts(segments: usize, sides: usize) -> (usize, usize) {
    (segments * sides, 2 * segments * sides)
}

/// A torus about the y axis: `segments` around it, `sides` around the tube.
pub fn fill_torus<T: Real>(
    [radius, tube]: [T; 2],
    [segments, sides]: [usize; 2],
    positions: &mut [[T; 3]],
    normals: &mut [[T; 3]],
    faces: &mut [[i32; 3]],
) {
    let turn = |i: usize, n: usize| sin_cos(std::f64::consts::TAU * i as f64 / n as f64);
    let (radius, tube) = (radius.to_f64(), tube.to_f64());
    for i in 0..segments {
        let (s, c) = turn(i, segments);
        for j in 0..sides {
            let (t, d) = turn(j, sides);
            let n = Vec3::new(c * d, t, s * d);
            let p = Vec3::new(c, 0.0, s) * radius + n * tube;
            positions[i * sides + j] = p.map(T::of).to_array();
            normals[i * sides + j] = n.map(T::of).to_array();
            let (i1, j1) = ((i + 1) % segments, (j + 1) % sides);
            let [a, b] = [i * sides + j, i * sides + j1].map(|v| v as i32);
            let [c, d] = [i1 * sides + j1, i1 * sides + j].map(|v| v as i32);
            let at = 2 * (i * sides + j);
            faces[at] = [a, b, c];
            faces[at + 1] = [a, c, d];
        }
    }
}
