//! Unit vectors in two numbers: the octahedron |x| + |y| + |z| = 1 around the sphere, its lower half folded out, fills the
//! square [-1, 1]²; quantised to signed normalised integers as G-buffers store it.
//!
//! Q. Meyer, J. Süßmuth, G. Sußner, M. Stamminger, G. Greiner, *On Floating-Point Normal Vectors*, EGSR 2010;
//! Z. Cigolle, S. Donow, D. Evangelakos, M. Mara, M. McGuire, Q. Meyer, *A Survey of Efficient Representations for
//! Independent Unit Vectors*, JCGT 3(2), 2014 (which also rounds to the best of the four cells around).

use crate::math::exact::{all_finite, largest};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// Turns the corners of the square over its edges |x| + |y| = 1, which its lower half lies beyond.
#[inline(always)]
fn fold<T: Real>([x, y]: [T; 2]) -> [T; 2] {
    [(T::one() - y.abs()).copysign(x), (T::one() - x.abs()).copysign(y)]
}

/// A direction of any length as a point of the square. No length, NaN and infinity give NaN.
#[inline(always)]
pub fn encode<T: Real>(v: Vec3<T>) -> [T; 2] {
    let size = largest(v);
    if !all_finite(v) || size == T::zero() {
        return [T::NAN; 2];
    }
    let v = v.map(|x| x / size);
    let sum = v.x.abs() + v.y.abs() + v.z.abs();
    let p = [v.x / sum, v.y / sum];
    if v.z < T::zero() { fold(p) } else { p }
}

/// The unit vector of a point of the square; NaN outside.
#[inline(always)]
pub fn decode<T: Real>([x, y]: [T; 2]) -> Vec3<T> {
    if !(x.abs() <= T::one() && y.abs() <= T::one()) {
        return Vec3::new(T::NAN, T::NAN, T::NAN);
    }
    let z = T::one() - x.abs() - y.abs();
    let [x, y] = if z < T::zero() { fold([x, y]) } else { [x, y] };
    Vec3::new(x, y, z).normalize()
}

/// The point as integers in [-scale, scale]: the nearest, or of the four around it the one whose direction is nearest.
/// NaN has the code that is left, `-scale - 1`.
#[inline(always)]
pub fn quantize<T: Real>(precise: bool, scale: T, v: Vec3<T>) -> [i32; 2] {
    let [x, y] = encode(v);
    if x.is_nan() {
        return [-(scale.to_f64() as i32) - 1; 2];
    }
    let code = |x: T| x.to_f64() as i32;
    let nearest = |x: T| (x.abs() * scale + T::of(0.5)).floor().copysign(x);
    if !precise {
        return [code(nearest(x)), code(nearest(y))];
    }
    let v = v.normalize();
    let (low, mut best, mut found) =
        ([(x * scale).floor(), (y * scale).floor()], T::INFINITY, [T::zero(); 2]);
    for (i, j) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let near = [Lanes::min(low[0] + T::of(i), scale), Lanes::min(low[1] + T::of(j), scale)];
        // The chord tells small angles apart, which the cosine does not.
        let chord = (decode(near.map(|c| c / scale)) - v).length_squared();
        if chord < best {
            (best, found) = (chord, near);
        }
    }
    found.map(code)
}
