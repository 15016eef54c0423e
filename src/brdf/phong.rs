//! Highlights by a power of a cosine: Phong's, of the mirror direction and the eye; Blinn's, of the normal and the half
//! vector; over a diffuser.
//!
//! The classic forms are of shading: the highlight is `specular` times the power, whatever the cosine of the light. As
//! BRDFs they are divided by that cosine, so they are not reciprocal and give back more than came at grazing. The
//! normalised forms are BRDFs whose mirrors give back `specular` of light along the normal, and no more of any other.
//!
//! B. T. Phong, *Illumination for computer generated pictures*, 1975; J. F. Blinn, *Models of light reflection for computer
//! synthesized pictures*, 1977; E. P. Lafortune, Y. D. Willems, *Using the modified Phong reflectance model for
//! physically based rendering*, 1994; F. Giesen, *Phong and Blinn-Phong normalization factors*, 2009.

use super::model::{Draw, Drawn, Model, Row, triple, weighed};
use crate::math;
use crate::math::exact::largest;
use crate::real::{Lanes, Real};
use crate::sampling::cosine_hemisphere::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};
use crate::sampling::disk::Method;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Phong<T> {
    pub diffuse: Vec3<T>,
    pub specular: Vec3<T>,
    pub exponent: T,
    pub blinn: bool,
    pub normalized: bool,
}

/// cⁿ for c in [0, 1]; zero below.
#[inline(always)]
fn power<T: Real>(c: T, n: T) -> T {
    if c > T::zero() {
        if n == T::zero() { T::one() } else { math::pow(Lanes::min(c, T::one()), n) }
    } else {
        c * T::zero()
    }
}

impl<T: Real> Phong<T> {
    /// The cosine whose power is taken.
    #[inline(always)]
    fn cosine(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        if self.blinn {
            let half = wi + wo;
            half.z / half.length()
        } else {
            wi.z * wo.z - wi.x * wo.x - wi.y * wo.y
        }
    }
    #[inline(always)]
    fn scale(&self, wi: Vec3<T>) -> T {
        let (n, two) = (self.exponent, T::of(2.0));
        if !self.normalized {
            T::one() / wi.z
        } else if self.blinn {
            let four = T::of(4.0);
            let low = math::exp(-n * T::of(0.5 * std::f64::consts::LN_2));
            (n + two) * (n + four) / (T::of(8.0) * T::PI * (low + n))
        } else {
            (n + two) / (two * T::PI)
        }
    }
    /// The chance of drawing from the highlight.
    #[inline(always)]
    fn chance(&self) -> T {
        let (s, d) = (largest(self.specular), largest(self.diffuse));
        if s > T::zero() { s / (s + d) } else { T::zero() }
    }
}

impl<T: Real> Model<T> for Phong<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        let half = T::of(0.5);
        let (diffuse, specular) = (triple(row, 0), triple(row, 3));
        Phong { diffuse, specular, exponent: row[6], normalized: row[7] > half, blinn: row[8] > half }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        if super::apart(wi, wo) {
            return Vec3::splat(T::zero());
        }
        let highlight = self.scale(wi) * power(self.cosine(wi, wo), self.exponent);
        self.diffuse * (T::one() / T::PI) + self.specular * highlight
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        if wo.z <= T::zero() {
            return T::zero();
        }
        let (chance, one) = (self.chance(), T::one());
        let lobe = (self.exponent + one) / (T::of(2.0) * T::PI) * power(self.cosine(wi, wo), self.exponent);
        // Half vectors are drawn by their cosine; one that looks away from the eye mirrors below.
        let lobe = if self.blinn {
            let half = wi + wo;
            if half.z > T::zero() { lobe / (T::of(2.0) * half.length()) } else { T::zero() }
        } else {
            lobe
        };
        chance * lobe + (one - chance) * square_to_cosine_hemisphere_pdf(wi)
    }
}

impl<T: Real> Drawn<T> for Phong<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        let (one, two) = (T::one(), T::of(2.0));
        if !(wo.z > T::zero()) {
            return None;
        }
        if !(u[2] < self.chance()) {
            let wi = square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric);
            return Some(weighed(self, wi, wo, one));
        }
        let c = power(one - u[1], one / (self.exponent + one));
        let s = ((one - c) * (one + c)).sqrt();
        let (sin, cos) = math::sin_cos(two * T::PI * u[0]);
        let lobe = Vec3::new(s * cos, s * sin, c);
        let wi = if self.blinn {
            lobe * (two * wo.dot(lobe)) - wo
        } else {
            Frame::about(Vec3::new(-wo.x, -wo.y, wo.z)).world(lobe)
        };
        Some(weighed(self, wi, wo, one))
    }
}
