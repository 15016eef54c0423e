//! What is known of lights without looking in any direction: where they are, where they turn, how much they send.

use crate::color::luminance::luminance;
use crate::light::Light;
use crate::light::textured::Textured;
use crate::math;
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// What is known of a light, or of several together, without looking at any direction.
#[derive(Clone, Copy, Debug)]
pub struct Source<T> {
    /// Infinite for lights without a place.
    pub low: Vec3<T>,
    pub high: Vec3<T>,
    /// Unit: the middle of the normals.
    pub axis: Vec3<T>,
    /// How far normals turn from the axis, and how far from its normal a light shines.
    pub cos_spread: T,
    pub cos_reach: T,
    pub power: T,
}

/// What the direction of lights that shine past a right angle counts at least.
const WIDE: f64 = 0.05;

impl<T: Real> Source<T> {
    /// From corners that span a flat piece with a unit normal.
    pub fn of_flat(corners: &[Vec3<T>], normal: Vec3<T>, two_sided: bool, power: T) -> Self {
        let (low, high) =
            corners.iter().fold(nothing(), |(low, high), &c| (low.zip(c, least), high.zip(c, most)));
        let cos_spread = if two_sided { -T::one() } else { T::one() };
        Source { low, high, axis: normal, cos_spread, cos_reach: T::zero(), power }
    }

    fn of_point(at: Vec3<T>, power: T) -> Self {
        let z = Vec3::new(T::zero(), T::zero(), T::one());
        Source { low: at, high: at, axis: z, cos_spread: -T::one(), cos_reach: T::zero(), power }
    }

    /// Of a light in a scene of that radius, which lights without a place shine on.
    pub fn of(light: &Light<T>, scene_radius: T) -> Self {
        let (pi, two, four) = (T::PI, T::of(2.0), T::of(4.0));
        let scene = pi * scene_radius * scene_radius;
        let sides = |two_sided: bool| if two_sided { two } else { T::one() };
        let all = Vec3::splat(T::INFINITY);
        let anywhere = |power: T| Source { low: -all, high: all, ..Self::of_point(all, power) };
        match light {
            Light::Point { position, intensity } => {
                Self::of_point(*position, four * pi * luminance(*intensity))
            }
            Light::Spot(l) => Source {
                axis: l.direction,
                cos_spread: T::one() - l.inner,
                // Beyond the inner cone by what the outer has more.
                cos_reach: cos_of_difference(T::one() - l.outer, T::one() - l.inner),
                ..Self::of_point(l.position, luminance(l.intensity) * pi * (l.inner + l.outer))
            },
            Light::Directional { irradiance, .. } => anywhere(scene * luminance(*irradiance)),
            Light::Ambient { radiance } => anywhere(scene * four * pi * luminance(*radiance)),
            Light::Rect(l) | Light::Textured(Textured { rect: l, .. }) => {
                let power = pi * l.area * sides(l.two_sided) * luminance(l.radiance);
                Self::of_flat(&l.corners(), l.normal, l.two_sided, power)
            }
            Light::Polygon(l) => {
                let corners: Vec<_> = l.corners.iter().map(|c| c.map(T::of)).collect();
                let power = pi * l.plane.area * sides(l.plane.two_sided) * luminance(l.radiance);
                Self::of_flat(&corners, l.plane.normal, l.plane.two_sided, power)
            }
            Light::Disk(l) => {
                let n = l.frame.z;
                let half = n.map(|c| l.radius * Lanes::max(T::one() - c * c, T::zero()).sqrt());
                let power = pi * l.area() * sides(l.two_sided) * luminance(l.radiance);
                Self::of_flat(&[l.center - half, l.center + half], n, l.two_sided, power)
            }
            Light::Sphere(l) => {
                let r = Vec3::splat(l.radius);
                let power = four * pi * pi * l.radius * l.radius * luminance(l.radiance);
                Source { low: l.center - r, high: l.center + r, ..Self::of_point(l.center, power) }
            }
        }
    }

    pub(super) fn is_placed(&self) -> bool {
        self.low.x.is_finite()
    }

    pub(super) fn middle(&self) -> Vec3<T> {
        let half = T::of(0.5);
        self.low * half + self.high * half
    }

    pub(super) fn with(&self, other: &Self) -> Self {
        if self.power == T::zero() {
            return *other;
        }
        if other.power == T::zero() {
            return *self;
        }
        let (axis, cos_spread) = around(self, other);
        Source {
            low: self.low.zip(other.low, least),
            high: self.high.zip(other.high, most),
            axis,
            cos_spread,
            cos_reach: least(self.cos_reach, other.cos_reach),
            power: self.power + other.power,
        }
    }

    /// The orientation measure times power and area: what splits keep small.
    pub(super) fn cost(&self) -> f64 {
        let d = (self.high - self.low).map(T::to_f64);
        let area = 2.0 * (d.x * d.y + d.y * d.z + d.z * d.x);
        let (spread, reach) = (math::acos(self.cos_spread.to_f64()), math::acos(self.cos_reach.to_f64()));
        let wide = f64::min(spread + reach, std::f64::consts::PI);
        let (sin, cos) = math::sin_cos(spread);
        let border = 2.0 * wide * sin - math::cos(spread - 2.0 * wide) - 2.0 * spread * sin + cos;
        let solid = std::f64::consts::PI * (2.0 * (1.0 - cos) + 0.5 * border);
        self.power.to_f64() * solid * area
    }

    /// What it may bring to a point; with a normal, to the upper side of a surface there.
    #[inline(always)]
    pub(super) fn importance(&self, point: Vec3<T>, normal: Option<Vec3<T>>) -> T {
        let (zero, one) = (T::zero(), T::one());
        let to = self.middle() - point;
        let radius_squared = (self.high - self.low).length_squared() * T::of(0.25);
        let squared = to.length_squared();
        // Within the bounding sphere the distance says nothing, nor does any angle.
        let near = squared <= radius_squared;
        let d2 = most(squared, radius_squared);
        if !(d2 > zero) {
            return self.power;
        }
        let wi = to * (one / squared.sqrt());
        // The cone in which the bounds are seen.
        let sin2_seen = if near { one } else { radius_squared / squared };
        let (sin_seen, cos_seen) = (sin2_seen.sqrt(), if near { -one } else { (one - sin2_seen).sqrt() });
        let mut result = self.power / d2;
        let cos_off = -wi.dot(self.axis);
        // The least angle at the lights: off the axis by less than the normals spread and the bounds are wide.
        let (cos, sin) = less(cos_off, self.cos_spread);
        let at_light = if near { one } else { less_by(cos, sin, cos_seen, sin_seen) };
        if at_light <= self.cos_reach {
            return zero;
        }
        // A spot that shines past a right angle has no cosine, but a falloff of its own.
        result *= if self.cos_reach < zero { most(at_light, T::of(WIDE)) } else { at_light };
        if let Some(n) = normal
            && !near
        {
            let cos = wi.dot(n);
            let sin = most(one - cos * cos, zero).sqrt();
            result *= most(less_by(cos, sin, cos_seen, sin_seen), zero);
        }
        result
    }
}

#[inline(always)]
pub(super) fn least<T: Real>(a: T, b: T) -> T {
    Lanes::min(a, b)
}

#[inline(always)]
pub(super) fn most<T: Real>(a: T, b: T) -> T {
    Lanes::max(a, b)
}

pub(super) fn nothing<T: Real>() -> (Vec3<T>, Vec3<T>) {
    (Vec3::splat(T::INFINITY), Vec3::splat(-T::INFINITY))
}

/// cos max(0, a − b) of angles in [0, π], from their cosines.
#[inline(always)]
fn cos_of_difference<T: Real>(cos_a: T, cos_b: T) -> T {
    less(cos_a, cos_b).0
}

/// Cosine and sine of max(0, a − b).
#[inline(always)]
fn less<T: Real>(cos_a: T, cos_b: T) -> (T, T) {
    let (zero, one) = (T::zero(), T::one());
    let sine = |c: T| most(one - c * c, zero).sqrt();
    if cos_a >= cos_b {
        return (one, zero);
    }
    let (sin_a, sin_b) = (sine(cos_a), sine(cos_b));
    (cos_a * cos_b + sin_a * sin_b, most(sin_a * cos_b - cos_a * sin_b, zero))
}

/// cos max(0, a − b).
#[inline(always)]
fn less_by<T: Real>(cos_a: T, sin_a: T, cos_b: T, sin_b: T) -> T {
    if cos_a >= cos_b { T::one() } else { cos_a * cos_b + sin_a * sin_b }
}

/// The smallest cone about two cones of normals: axis and cosine of the half angle.
fn around<T: Real>(a: &Source<T>, b: &Source<T>) -> (Vec3<T>, T) {
    let double = |v: Vec3<T>| v.map(T::to_f64);
    let (wide, narrow) = if a.cos_spread <= b.cos_spread { (a, b) } else { (b, a) };
    let (u, v) = (double(wide.axis), double(narrow.axis));
    let [ta, tb] = [wide, narrow].map(|s| math::acos(s.cos_spread.to_f64()));
    let between = math::atan2(u.cross(v).length(), u.dot(v));
    if between + tb <= ta {
        return (wide.axis, wide.cos_spread);
    }
    let half = 0.5 * (ta + between + tb);
    if half >= std::f64::consts::PI {
        return (wide.axis, -T::one());
    }
    // Turned from the wider axis towards the other; opposite axes leave no plane to turn in.
    let across = v - u * u.dot(v);
    let length = across.length();
    if length < 1e-12 {
        return (wide.axis, -T::one());
    }
    let (sin, cos) = math::sin_cos(half - ta);
    let axis = (u * cos + across * (sin / length)).normalize();
    // A little wider, so that rounding shuts nothing out.
    (axis.map(T::of), T::of(f64::max(math::cos(half) - 1e-6, -1.0)))
}
