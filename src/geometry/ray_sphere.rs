//! A ray against a sphere: both roots, by three methods.
//!
//! - [`Method::Robust`]: the discriminant is taken from the vector that leads from the centre square to the line, so
//!   nothing as large as the squared distance cancels in it, and the smaller root from the product of the roots.
//!   E. Haines, J. Günther, T. Akenine-Möller, *Precision Improvements for Ray/Sphere Intersection*, Ray Tracing Gems,
//!   2019. Beyond the paper, the difference `origin - center`, the perpendicular vector and the power of the origin
//!   keep the errors of their rounding.
//! - [`Method::Quadratic`]: the equation's textbook solution, which loses the sphere at a distance of thousands of radii.
//! - [`Method::Geometric`]: the squared distance of the centre from the line by Pythagoras, which loses it likewise.
//!   T. Akenine-Möller, E. Haines, *Real-Time Rendering*, section "Ray/Sphere Intersection".
//!
//! All work at the size of one: the direction, and the offset with the radius, are scaled by powers of two.

use crate::math::exact::{all_finite, exponent, largest, scaled, two_difference, two_product, two_sum};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Robust,
    Quadratic,
    Geometric,
}

/// Where a line enters and leaves a sphere, and how near it comes to the centre.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<T> {
    /// The first crossing within the ray's interval; infinite if there is none.
    pub t: T,
    /// The crossings of the whole line: `(inf, -inf)` if it misses.
    pub near: T,
    pub far: T,
    /// The line's point nearest to the centre, its distance from there, and the square of half the chord.
    pub closest: T,
    pub distance: T,
    pub discriminant: T,
}

/// The line's nearest point, its distance from the centre, the discriminant, and the roots (meaningless if that is
/// negative).
type Roots<T> = (T, T, T, [T; 2]);

/// One ray against one sphere; a crossing counts in the open interval `(t_min, t_max)`. NaN or infinity, a negative
/// radius or a direction of no length give NaN.
#[inline(always)]
pub fn ray_sphere<T: Real>(
    method: Method,
    origin: Vec3<T>,
    direction: Vec3<T>,
    center: Vec3<T>,
    radius: T,
    t_min: T,
    t_max: T,
) -> Crossing<T> {
    let longest = largest(direction);
    let proper = all_finite(origin) & all_finite(direction) & all_finite(center) & radius.is_finite();
    if !proper || !(radius >= T::zero()) || longest < T::MIN_POSITIVE || t_min.is_nan() || t_max.is_nan() {
        let nan = T::NAN;
        return Crossing { t: nan, near: nan, far: nan, closest: nan, distance: nan, discriminant: nan };
    }
    // Powers of two, so that no digit is lost.
    let (ed, ef) = (exponent(longest), exponent(Lanes::max(largest(origin - center), radius)));
    let d = direction * T::exp2i(-ed);
    let offset = origin.zip(center, |o, c| two_difference(o, c));
    let (f, f_low) = (offset.map(|x| x.0 * T::exp2i(-ef)), offset.map(|x| x.1 * T::exp2i(-ef)));
    let r = radius * T::exp2i(-ef);
    let (closest, distance, discriminant, [near, far]) = match method {
        Method::Robust => robust(f, f_low, d, r),
        Method::Quadratic => quadratic(f, d, r),
        Method::Geometric => geometric(f, d, r),
    };

    let along = ef - ed;
    let (near, far) = match discriminant >= T::zero() {
        true => (scaled(near, along), scaled(far, along)),
        false => (T::INFINITY, -T::INFINITY),
    };
    let within = |t: T| t > t_min && t < t_max;
    let t = if within(near) {
        near
    } else if within(far) {
        far
    } else {
        T::INFINITY
    };
    Crossing {
        t,
        near,
        far,
        closest: scaled(closest, along),
        distance: scaled(distance, ef),
        discriminant: scaled(discriminant, ef + ef),
    }
}

#[inline(always)]
fn robust<T: Real>(f: Vec3<T>, f_low: Vec3<T>, d: Vec3<T>, r: T) -> Roots<T> {
    let (a, b) = (d.dot(d), -f.dot(d));
    let s = b / a;

    // From the centre to the line. An error of `s` moves the foot along the line, which a second projection takes back.
    let low = f_low.zip(d, |low, d| (low, two_product(s, d)));
    let foot = f.zip(low, |f, (low, (p, p_low))| {
        let (sum, lost) = two_sum(f, p);
        sum + (lost + (p_low + low))
    });
    let rest = foot.dot(d) / a;
    let foot = foot - d * rest;
    let distance_squared = foot.dot(foot);
    let discriminant = r * r - distance_squared;

    // The power of the origin, |f|² - r², which is small where rays leave the surface.
    let [x, y, z] = f.map(|x| two_product(x, x)).to_array();
    let (rr, rr_low) = two_product(r, r);
    let (sum, lost_a) = two_difference(x.0, rr);
    let (sum, lost_b) = two_sum(sum, y.0);
    let (sum, lost_c) = two_sum(sum, z.0);
    let crossed = f.dot(f_low);
    let power = sum + ((lost_a + lost_b + lost_c) + ((x.1 + y.1) + (z.1 - rr_low)) + (crossed + crossed));

    // The root of larger magnitude adds two numbers of one sign; the other follows from their product.
    let root = Lanes::max(a * discriminant, T::zero()).sqrt();
    let b = b - rest * a;
    let roots = if b >= T::zero() {
        let q = b + root;
        [if q == T::zero() { T::zero() } else { power / q }, q / a]
    } else {
        let q = b - root;
        [q / a, power / q]
    };
    (s - rest, distance_squared.sqrt(), discriminant, roots)
}

#[inline(always)]
fn quadratic<T: Real>(f: Vec3<T>, d: Vec3<T>, r: T) -> Roots<T> {
    let two = T::of(2.0);
    let (a, b, c) = (d.dot(d), two * f.dot(d), f.dot(f) - r * r);
    let discriminant = b * b - T::of(4.0) * a * c;
    let root = discriminant.sqrt();
    // In the units of the others: a quarter of the squared chord.
    let chord = discriminant / (T::of(4.0) * a);
    let distance = Lanes::max(r * r - chord, T::zero()).sqrt();
    (-b / (two * a), distance, chord, [(-b - root) / (two * a), (-b + root) / (two * a)])
}

#[inline(always)]
fn geometric<T: Real>(f: Vec3<T>, d: Vec3<T>, r: T) -> Roots<T> {
    let length = d.length();
    let s = -f.dot(d.map(|x| x / length));
    let m2 = f.dot(f) - s * s;
    let discriminant = r * r - m2;
    let q = discriminant.sqrt();
    (s / length, Lanes::max(m2, T::zero()).sqrt(), discriminant, [(s - q) / length, (s + q) / length])
}
