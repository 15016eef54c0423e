//! How much of each lobe of a pair a polygon fills: Lambert's formula over the polygon straightened, eight edges at once.
//!
//! An edge from a to b contributes its normal times its angle, that of |a × b| and a · b, whatever the lengths of a and b, so
//! that nothing is normalised. A quadrilateral above both horizons, by far the most frequent, is four edges under
//! two lobes: one pass of eight lanes. What crosses a horizon is clipped there, exactly, and goes lobe by lobe.

use super::table::Lobe;
use crate::math;
use crate::real::Lanes;
use crate::simd::{Simd, SimdBase, f64x8};
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// Edges of one pass.
const WIDE: usize = 8;

/// Corners by their components.
struct Columns([[f64; WIDE]; 3]);

impl Columns {
    #[inline(always)]
    fn lanes<S: Simd>(&self, s: S) -> Vec3<f64x8<S>> {
        let [x, y, z] = &self.0;
        Vec3::new(f64x8::load_array_ref(s, x), f64x8::load_array_ref(s, y), f64x8::load_array_ref(s, z))
    }
    #[inline(always)]
    fn set(&mut self, lane: usize, v: Vec3<f64>) {
        self.0[0][lane] = v.x;
        self.0[1][lane] = v.y;
        self.0[2][lane] = v.z;
    }
}

/// Normals times angles of the edges from `a` to `b`; zero where both are one direction.
#[inline(always)]
fn turns<S: Simd>(s: S, a: Vec3<f64x8<S>>, b: Vec3<f64x8<S>>) -> [[f64; WIDE]; 3] {
    let zero = f64x8::splat(s, 0.0);
    let normal = a.cross(b);
    let sine = normal.dot(normal).sqrt();
    // The reciprocal does not wait for the angle.
    let (angle, per) = (math::angle(sine, a.dot(b)), f64x8::splat(s, 1.0) / sine);
    let v = normal * <f64x8<S> as Lanes>::select(zero.less(sine), angle * per, zero);
    [v.x.to_array(), v.y.to_array(), v.z.to_array()]
}

/// ∫ ω dω over a polygon all of which is above the horizon, over π: its z is the share of a cosine lobe that it fills.
/// Positive where its front is seen.
#[inline(always)]
fn whole<S: Simd>(s: S, corners: &[Vec3<f64>]) -> Vec3<f64> {
    let mut sum = Vec3::splat(0.0);
    let count = corners.len();
    let mut start = 0;
    while start < count {
        let (mut a, mut b) = (Columns([[1.0; WIDE]; 3]), Columns([[1.0; WIDE]; 3]));
        let most = WIDE.min(count - start);
        for k in 0..most {
            let next = if start + k + 1 == count { 0 } else { start + k + 1 };
            a.set(k, corners[start + k]);
            b.set(k, corners[next]);
        }
        let v = turns(s, a.lanes(s), b.lanes(s));
        for k in 0..most {
            sum = sum + Vec3::new(v[0][k], v[1][k], v[2][k]);
        }
        start += WIDE;
    }
    sum * (-0.5 / std::f64::consts::PI)
}

/// Of `corners` the part with z > 0.
#[inline(always)]
fn clip(corners: &[Vec3<f64>], out: &mut Vec<Vec3<f64>>) {
    out.clear();
    let Some(&last) = corners.last() else { return };
    let mut before = last;
    for &corner in corners {
        if (before.z > 0.0) != (corner.z > 0.0) {
            let mut crossing = before + (corner - before) * (before.z / (before.z - corner.z));
            crossing.z = 0.0;
            out.push(crossing);
        }
        if corner.z > 0.0 {
            out.push(corner);
        }
        before = corner;
    }
}

/// What each of two lobes sees of a polygon, given from the point and seen in a frame of normal and eye: the vectors of
/// [`whole`], straightened. `scratch` holds corners on the way. Enters the level anew,
/// so that it is compiled once a level.
#[inline(never)]
pub fn seen<S: Simd>(
    s: S,
    lobes: &[Lobe; 2],
    corners: &[Vec3<f64>],
    frame: &Frame<f64>,
    scratch: &mut [Vec<Vec3<f64>>; 3],
) -> [Vec3<f64>; 2] {
    s.vectorize(
        #[inline(always)]
        || seen_here(s, lobes, corners, frame, scratch),
    )
}

#[inline(always)]
fn seen_here<S: Simd>(
    s: S,
    lobes: &[Lobe; 2],
    corners: &[Vec3<f64>],
    frame: &Frame<f64>,
    scratch: &mut [Vec<Vec3<f64>>; 3],
) -> [Vec3<f64>; 2] {
    if let [a, b, c, d] = *corners
        && let Some(seen) = above(s, lobes, [a, b, c, d], frame)
    {
        return seen;
    }
    let [local, upper, straight] = scratch;
    local.clear();
    for &corner in corners {
        local.push(frame.local(corner));
    }
    clip(local, upper);
    let mut result = [Vec3::splat(0.0); 2];
    if upper.len() < 3 {
        return result;
    }
    for k in 0..2 {
        local.clear();
        for &corner in upper.iter() {
            local.push(lobes[k].straighten(corner));
        }
        clip(local, straight);
        result[k] = whole(s, straight);
    }
    result
}

/// [`seen`] for a quadrilateral that is above the surface's horizon and those of both lobes; None if it is not.
#[inline(always)]
fn above<S: Simd>(
    s: S,
    lobes: &[Lobe; 2],
    corners: [Vec3<f64>; 4],
    frame: &Frame<f64>,
) -> Option<[Vec3<f64>; 2]> {
    let (mut a, mut b) = (Columns([[0.0; WIDE]; 3]), Columns([[0.0; WIDE]; 3]));
    let mut entries = [[0.0; WIDE]; 4];
    for k in 0..4 {
        let (corner, next) = (corners[k], corners[(k + 1) % 4]);
        a.set(k, corner);
        a.set(k + 4, corner);
        b.set(k, next);
        b.set(k + 4, next);
        for entry in 0..4 {
            entries[entry][k] = lobes[0].inverse[entry];
            entries[entry][k + 4] = lobes[1].inverse[entry];
        }
    }
    let zero = f64x8::splat(s, 0.0);
    let splat = |v: Vec3<f64>| Vec3::new(f64x8::splat(s, v.x), f64x8::splat(s, v.y), f64x8::splat(s, v.z));
    let frame = Frame { x: splat(frame.x), y: splat(frame.y), z: splat(frame.z) };
    let [xx, xz, zx, zz] = [
        f64x8::load_array_ref(s, &entries[0]),
        f64x8::load_array_ref(s, &entries[1]),
        f64x8::load_array_ref(s, &entries[2]),
        f64x8::load_array_ref(s, &entries[3]),
    ];
    let (a, b) = (frame.local(a.lanes(s)), frame.local(b.lanes(s)));
    let low = xx * a.x + xz * a.z;
    let high = zx * a.x + zz * a.z;
    if <f64x8<S> as Lanes>::bits(zero.less(a.z) & zero.less(high)) != 0xff {
        return None;
    }
    let to = Vec3::new(xx * b.x + xz * b.z, b.y, zx * b.x + zz * b.z);
    let v = turns(s, Vec3::new(low, a.y, high), to);
    let mut result = [Vec3::splat(0.0); 2];
    for k in 0..4 {
        result[0] = result[0] + Vec3::new(v[0][k], v[1][k], v[2][k]);
        result[1] = result[1] + Vec3::new(v[0][k + 4], v[1][k + 4], v[2][k + 4]);
    }
    let scale = -0.5 / std::f64::consts::PI;
    Some([result[0] * scale, result[1] * scale])
}
