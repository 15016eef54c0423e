//! A ray against a plane `n · x + d = 0`: the height of the origin over the speed towards the plane. Both sums are right
//! to two units of the last place, whatever cancels in them, and so is `t`, but for a few more; rays are parallel only
//! if they are.

use crate::math::exact::{all_finite, dot, exponent, largest, scaled, total, two_product};
use crate::real::Real;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Crossing<T> {
    /// Where the ray meets the plane within its interval; infinite if it does not.
    pub t: T,
    /// Where its line does; infinite if it is parallel.
    pub line: T,
    /// The origin's distance from the plane, positive in front of it.
    pub distance: T,
    /// The cosine between the ray and the normal.
    pub cosine: T,
}

/// `(x, y, z, d)` is the plane; hits lie in the open interval `(t_min, t_max)`.
#[inline(always)]
pub fn ray_plane<T: Real>(
    origin: Vec3<T>,
    direction: Vec3<T>,
    [x, y, z, d]: [T; 4],
    t_min: T,
    t_max: T,
) -> Crossing<T> {
    let n = Vec3::new(x, y, z);
    let proper = all_finite(origin) & all_finite(direction) & all_finite(n) & d.is_finite();
    let (ln, ld) = (largest(n), largest(direction));
    if !proper || ln < T::MIN_POSITIVE || ld < T::MIN_POSITIVE || t_min.is_nan() || t_max.is_nan() {
        return Crossing { t: T::NAN, line: T::NAN, distance: T::NAN, cosine: T::NAN };
    }
    // Powers of two, so that no digit is lost.
    let (en, ed) = (exponent(ln), exponent(ld));
    let (n, v) = (n * T::exp2i(-en), direction * T::exp2i(-ed));
    let [x, y, z] = n.zip(origin, |p, q| two_product(p, q)).to_array();
    let height = total([x.0, y.0, z.0, scaled(d, -en), x.1, y.1, z.1]);
    let speed = dot(n, v);
    let line = if speed == T::zero() { T::INFINITY } else { scaled(-height / speed, -ed) };
    let t = if line > t_min && line < t_max { line } else { T::INFINITY };
    Crossing { t, line, distance: height / n.length(), cosine: speed / (n.length() * v.length()) }
}
