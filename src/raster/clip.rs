//! Triangles in homogeneous clip space against the near and far planes and a guard band about the picture.
//!
//! The band reaches so far outside that only triangles which cross the eye's plane, or are wider than thousands of
//! pixels, are cut at all. Cuts are computed in double from the inner to the outer vertex, so that two triangles
//! that share an edge cut it at the same point to the bit.
//!
//! I. E. Sutherland, G. W. Hodgman, *Reentrant Polygon Clipping*, 1974.
//! J. F. Blinn, M. E. Newell, *Clipping Using Homogeneous Coordinates*, 1978.

use super::setup::Screen;

/// Three vertices and one more for each of six planes.
pub const MAX_VERTICES: usize = 9;

/// 2^-600.
const TINY: f64 = f64::from_bits((1023 - 600) << 52);

/// A convex polygon in clip space.
pub struct Polygon {
    pub vertices: [[f64; 4]; MAX_VERTICES],
    pub len: usize,
}

/// The part of a triangle between near, far and guard planes; empty if there is none or a vertex is not finite.
pub fn clip(triangle: [[f64; 4]; 3], screen: &Screen) -> Polygon {
    let mut polygon = Polygon { vertices: [[0.0; 4]; MAX_VERTICES], len: 0 };
    if triangle.iter().flatten().any(|c| !c.is_finite()) {
        return polygon;
    }
    // A common power of two changes no point and no bit; it keeps the largest numbers of double from overflowing.
    let largest = triangle.iter().flatten().fold(0.0f64, |m, c| m.max(c.abs()));
    let factor = if largest > 1e100 { TINY } else { 1.0 };
    for (v, t) in polygon.vertices.iter_mut().zip(triangle) {
        *v = t.map(|c| c * factor);
    }
    polygon.len = 3;
    // Nothing of a triangle beyond one side of the picture itself is seen, however near the guard plane is.
    let outside = |plane: [f64; 4]| polygon.vertices[..3].iter().all(|v| distance(plane, v) < 0.0);
    let sides = [[1.0, 0.0, 0.0, 1.0], [-1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, -1.0, 0.0, 1.0]];
    if sides.into_iter().any(outside) {
        polygon.len = 0;
        return polygon;
    }
    for plane in planes(screen) {
        polygon = cut(&polygon, plane);
        if polygon.len < 3 {
            polygon.len = 0;
            return polygon;
        }
    }
    // The planes leave w >= 0; the eye itself projects nowhere.
    if polygon.vertices[..polygon.len].iter().any(|v| v[3] <= 0.0) {
        polygon.len = 0;
    }
    polygon
}

/// Planes whose inner side is `p · v >= 0`: depth first, which leaves no vertex behind the eye.
fn planes(screen: &Screen) -> [[f64; 4]; 6] {
    let [gx, gy] = screen.guard;
    [
        [0.0, 0.0, 1.0, -screen.depth_low],
        [0.0, 0.0, -1.0, 1.0],
        [1.0, 0.0, 0.0, gx],
        [-1.0, 0.0, 0.0, gx],
        [0.0, 1.0, 0.0, gy],
        [0.0, -1.0, 0.0, gy],
    ]
}

fn distance(plane: [f64; 4], v: &[f64; 4]) -> f64 {
    plane[0] * v[0] + plane[1] * v[1] + plane[2] * v[2] + plane[3] * v[3]
}

fn cut(polygon: &Polygon, plane: [f64; 4]) -> Polygon {
    let mut out = Polygon { vertices: [[0.0; 4]; MAX_VERTICES], len: 0 };
    let mut push = |v| {
        // A polygon that rounding made concave could ask for more; what it would add lies within rounding.
        if out.len < MAX_VERTICES {
            out.vertices[out.len] = v;
            out.len += 1;
        }
    };
    for i in 0..polygon.len {
        let (a, b) = (polygon.vertices[i], polygon.vertices[(i + 1) % polygon.len]);
        let (da, db) = (distance(plane, &a), distance(plane, &b));
        if da >= 0.0 {
            push(a);
            if db < 0.0 {
                push(crossing(a, b, da, db));
            }
        } else if db >= 0.0 {
            push(crossing(b, a, db, da));
        }
    }
    out
}

/// The point of the edge on the plane, always from the inner end.
fn crossing(inner: [f64; 4], outer: [f64; 4], d_inner: f64, d_outer: f64) -> [f64; 4] {
    let t = d_inner / (d_inner - d_outer);
    std::array::from_fn(|i| inner[i] + t * (outer[i] - inner[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Depth;

    fn screen() -> Screen {
        Screen::new(640, 480, Depth::Standard)
    }

    #[test]
    fn a_triangle_inside_is_left_alone() {
        let t = [[0.0, 0.0, 0.0, 1.0], [0.5, 0.0, 0.0, 1.0], [0.0, 0.5, 0.0, 1.0]];
        let p = clip(t, &screen());
        assert_eq!(p.vertices[..p.len], t);
    }

    #[test]
    fn what_is_behind_the_eye_or_not_finite_is_gone() {
        let behind = [[0.0, 0.0, 0.0, -1.0], [0.5, 0.0, 0.0, -1.0], [0.0, 0.5, 0.0, -1.0]];
        assert_eq!(clip(behind, &screen()).len, 0);
        for bad in [f64::NAN, f64::INFINITY] {
            let mut t = [[0.0, 0.0, 0.0, 1.0], [0.5, 0.0, 0.0, 1.0], [0.0, 0.5, 0.0, 1.0]];
            t[1][2] = bad;
            assert_eq!(clip(t, &screen()).len, 0);
        }
    }

    #[test]
    fn a_crossing_does_not_depend_on_the_edge_s_direction() {
        let (a, b, c) = ([0.3, 0.1, 0.7, 1.0], [-0.9, 0.2, -3.1, 0.4], [0.2, -0.8, 0.5, 1.1]);
        let new = |p: Polygon| {
            p.vertices[..p.len].iter().filter(|v| ![a, b, c].contains(v)).copied().collect::<Vec<_>>()
        };
        let (p, q) = (new(clip([a, b, c], &screen())), new(clip([b, a, c], &screen())));
        assert!(!p.is_empty() && p.iter().all(|v| q.contains(v)));
    }
}
