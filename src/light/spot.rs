//! A point that sends light into a cone, full within the inner angle, none beyond the outer one, and smooth between: a
//! cubic in the cosine whose slope vanishes at both.

use crate::real::Real;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Spot<T> {
    pub position: Vec3<T>,
    /// Unit, from the light along its axis.
    pub direction: Vec3<T>,
    /// On the axis, W/sr.
    pub intensity: Vec3<T>,
    /// 1 − cos of the half angles: exact for narrow cones, where cosines are all alike.
    pub inner: T,
    pub outer: T,
}

impl<T: Real> Spot<T> {
    /// The share of the intensity that goes along the unit vector `w`.
    #[inline(always)]
    pub fn falloff(&self, w: Vec3<T>) -> T {
        let off = (w - self.direction).length_squared() * T::of(0.5);
        let t = (self.outer - off) / (self.outer - self.inner);
        // In this order a cone without a border, whose quotient is not finite, is right as well.
        if off <= self.inner {
            T::one()
        } else if off >= self.outer {
            T::zero()
        } else {
            t * t * (T::of(3.0) - T::of(2.0) * t)
        }
    }
}
