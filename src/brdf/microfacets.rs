//! Surfaces of microscopic mirrors: how their normals are distributed, and how they hide each other.
//!
//! The distribution D is per solid angle of the normal, ∫ D cos = 1; the visibility V is G / (4 cos θi cos θo). Half
//! vectors are taken unnormalised, differences of nearly equal numbers are written as sums. Widths may differ along x
//! and y. Generic over lanes: the shape and the masking are those of all lanes.
//!
//! B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007
//! (GGX; the rational form of Beckmann's masking, within 0.35 %); E. Heitz, *Understanding the masking-shadowing function
//! in microfacet-based BRDFs*, 2014; J. Dupuy, A. Benyoub, *Sampling visible GGX normals with spherical caps*, 2023;
//! C. Schlick, *An inexpensive BRDF model for physically-based rendering*, 1994; R. L. Cook, K. E. Torrance, *A
//! reflectance model for computer graphics*, 1982 (V-cavities).

use super::beckmann::{self, visible_slopes};
use crate::math;
use crate::real::{Lanes, Real};
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Ggx,
    Beckmann,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    HeightCorrelated,
    Separable,
    /// Schlick's rational form of the separable GGX, k = alpha / 2.
    Schlick,
    VCavity,
}

impl Shape {
    #[inline(always)]
    pub fn of<T: Real>(number: T) -> Self {
        if number > T::of(0.5) { Shape::Beckmann } else { Shape::Ggx }
    }
}

impl Masking {
    #[inline(always)]
    pub fn of<T: Real>(number: T) -> Self {
        match number.to_f64() as i32 {
            1 => Masking::Separable,
            2 => Masking::Schlick,
            3 => Masking::VCavity,
            _ => Masking::HeightCorrelated,
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Microfacets<V> {
    pub alpha_x: V,
    pub alpha_y: V,
    /// alpha_y / alpha_x, and its inverse.
    pub ratio: [V; 2],
    pub shape: Shape,
    pub masking: Masking,
}

impl<V: Lanes> Microfacets<V> {
    /// √(cos² + alpha² sin²) of a unit direction: 1 + Smith's Λ of GGX is half of one plus this over the cosine.
    #[inline(always)]
    fn stretched(&self, w: Vec3<V>) -> V {
        let (x, y) = (self.alpha_x * w.x, self.alpha_y * w.y);
        (w.z * w.z + (x * x + y * y)).sqrt()
    }

    /// D at an unnormalised half vector above the horizon.
    #[inline(always)]
    pub fn distribution(&self, half: Vec3<V>) -> V {
        let (ax, ay) = (self.alpha_x, self.alpha_y);
        let one = ax.num(1.0);
        match self.shape {
            Shape::Ggx => {
                let both = ax * ay;
                let across = half.x * half.x * self.ratio[0] + half.y * half.y * self.ratio[1];
                // Narrow lobes' fourth powers would leave the range of numbers.
                let share = both * half.length_squared() / (both * half.z * half.z + across);
                share * share / (ax.num(std::f64::consts::PI) * both)
            }
            Shape::Beckmann => {
                let (x, y) = (half.x / (ax * half.z), half.y / (ay * half.z));
                let cos2 = half.z * half.z / half.length_squared();
                let d = math::exp(-(x * x + y * y)) * (one / (ax.num(std::f64::consts::PI) * ax * ay))
                    / (cos2 * cos2);
                V::select(half.z.less_eq(half.z.num(0.0)), half.z.num(0.0), d)
            }
        }
    }

    /// (1 + Λ) cos of a unit direction, by its |cos|.
    #[inline(always)]
    fn smith(&self, w: Vec3<V>) -> V {
        let c = w.z.abs();
        let (one, half) = (c.num(1.0), c.num(0.5));
        match self.shape {
            Shape::Ggx => half * (c + self.stretched(w)),
            Shape::Beckmann => {
                let (x, y) = (self.alpha_x * w.x, self.alpha_y * w.y);
                let a = c / (x * x + y * y).sqrt();
                // G1 = (3.535 a + 2.181 a²) / (1 + 2.276 a + 2.577 a²), one from a = 1.6 on; c / a is finite at a = 0.
                let over = (one + a * (c.num(2.276) + c.num(2.577) * a)) / (c.num(3.535) + c.num(2.181) * a);
                V::select(a.less(c.num(1.6)), (x * x + y * y).sqrt() * over, c)
            }
        }
    }

    /// 4 |cos θi cos θo| / G of GGX by Smith's height-correlated or, for every other name, separable function.
    #[inline(always)]
    pub fn four_smith(&self, wi: Vec3<V>, wo: Vec3<V>) -> V {
        let (ci, co) = (wi.z.abs(), wo.z.abs());
        let (si, so) = (self.stretched(wi), self.stretched(wo));
        match self.masking {
            Masking::HeightCorrelated => (ci * so + co * si) * ci.num(2.0),
            _ => (ci + si) * (co + so),
        }
    }

    /// Smith's masking of one direction.
    #[inline(always)]
    pub fn masking_of(&self, w: Vec3<V>) -> V {
        w.z.abs() / self.smith(w)
    }

    /// The masking of one direction for facets of a unit normal.
    #[inline(always)]
    pub fn masking_at(&self, w: Vec3<V>, normal: Vec3<V>) -> V {
        match self.masking {
            Masking::VCavity => {
                let one = w.z.num(1.0);
                one.min((normal.z * w.z).abs() * w.z.num(2.0) / w.dot(normal).abs())
            }
            _ => self.masking_of(w),
        }
    }

    /// G / (4 |cos θi cos θo|) of two unit directions on the same side, with their unnormalised half vector.
    #[inline(always)]
    pub fn visibility(&self, wi: Vec3<V>, wo: Vec3<V>, half: Vec3<V>) -> V {
        let (ci, co) = (wi.z.abs(), wo.z.abs());
        let (one, quarter) = (ci.num(1.0), ci.num(0.25));
        match self.masking {
            // 1 / (4 (1 + Λi + Λo) ci co), every term positive.
            Masking::HeightCorrelated if self.shape == Shape::Ggx => {
                ci.num(0.5) / (ci * self.stretched(wo) + co * self.stretched(wi))
            }
            Masking::HeightCorrelated => quarter / (ci * self.smith(wo) + co * self.smith(wi) - ci * co),
            Masking::Separable => quarter / (self.smith(wi) * self.smith(wo)),
            Masking::Schlick => {
                let k = ci.num(0.25) * (self.alpha_x + self.alpha_y);
                quarter / ((ci + k * (one - ci)) * (co + k * (one - co)))
            }
            Masking::VCavity => {
                let reach = half.z.abs().num(2.0) * half.z.abs() / wo.dot(half).abs();
                one.min(reach * ci.min(co)) * quarter / (ci * co)
            }
        }
    }
}

impl<V: Lanes> Microfacets<V> {
    /// From widths along x and y, and the numbers of shape and masking.
    #[inline(always)]
    pub fn of(alpha_x: V, alpha_y: V, shape: V, masking: V) -> Self {
        let ratio = [alpha_y / alpha_x, alpha_x / alpha_y];
        let (shape, masking) = (Shape::of(shape.first()), Masking::of(masking.first()));
        Microfacets { alpha_x, alpha_y, ratio, shape, masking }
    }

    /// GGX of one width in all directions.
    #[inline(always)]
    pub fn ggx(alpha: V, masking: Masking) -> Self {
        let one = alpha.num(1.0);
        Microfacets { alpha_x: alpha, alpha_y: alpha, ratio: [one, one], shape: Shape::Ggx, masking }
    }

    /// The mean over azimuths of the width that a direction sees, √(αx² cos² + αy² sin²): of one width that stands for
    /// two. An ellipse's perimeter over 2π, by Ramanujan's second approximation (within 4e-4).
    #[inline(always)]
    pub fn mean_width(&self) -> V {
        let (sum, difference) = (self.alpha_x + self.alpha_y, self.alpha_x - self.alpha_y);
        let three = sum.num(3.0) * (difference / sum) * (difference / sum);
        sum * sum.num(0.5) * (sum.num(1.0) + three / (sum.num(10.0) + (sum.num(4.0) - three).sqrt()))
    }

    /// A unit normal by D cos, from two numbers of [0, 1).
    #[inline(always)]
    pub fn normal(&self, u: [V; 2]) -> Vec3<V> {
        let one = u[0].num(1.0);
        let turn = V::select(one.num(0.5).less(u[0]), u[0] - one, u[0]);
        let (sin, cos) = math::sin_cos_turns(turn);
        let slope2 = match self.shape {
            Shape::Ggx => u[1] / (one - u[1]),
            Shape::Beckmann => -math::ln(one - u[1]),
        };
        let slope = slope2.sqrt();
        Vec3::new(self.alpha_x * (slope * cos), self.alpha_y * (slope * sin), one).normalize()
    }

    /// A unit normal for `wo` above the horizon, from two numbers of [0, 1): by how much of it `wo` sees behind others by
    /// Smith's masking; of V-cavities by D cos, since they show more of what grazes than Smith's surfaces do.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<V>, u: [V; 2]) -> Vec3<V> {
        if self.masking == Masking::VCavity {
            // Of the two sides of a cavity the other, where one turns away.
            let normal = self.normal(u);
            let side = V::select(wo.dot(normal).less(wo.z.num(0.0)), wo.z.num(-1.0), wo.z.num(1.0));
            return Vec3::new(normal.x * side, normal.y * side, normal.z);
        }
        let (zero, one) = (wo.z.num(0.0), wo.z.num(1.0));
        let (ax, ay) = (self.alpha_x, self.alpha_y);
        if self.shape == Shape::Beckmann {
            let [x, y] = visible_slopes(Vec3::new(ax * wo.x, ay * wo.y, wo.z), u);
            return Vec3::new(-ax * x, -ay * y, one).normalize();
        }
        let turn = V::select(one.num(0.5).less(u[0]), u[0] - one, u[0]);
        let (sin, cos) = math::sin_cos_turns(turn);
        // In the space where the surface is as rough as a hemisphere, visible normals are halfway between `wo` and the
        // points of the cap that it sees: z from 1 down to −cos.
        let stretched = Vec3::new(ax * wo.x, ay * wo.y, wo.z).normalize();
        let above = one + stretched.z;
        let below = (stretched.x * stretched.x + stretched.y * stretched.y) / above;
        let (one_minus_z, one_plus_z) = (u[1] * above, (one - u[1]) * above + below);
        let r = (one_minus_z * one_plus_z).max(zero).sqrt();
        Vec3::new(ax * (r * cos + stretched.x), ay * (r * sin + stretched.y), (one - u[1]) * above)
            .normalize()
    }

    /// The density of [`Microfacets::sample`] per solid angle of the normal, over |wo·h|, for an unnormalised half
    /// vector above the horizon. Of Beckmann by Smith's exact function, so that it is one in all; light is masked by the
    /// rational form.
    #[inline(always)]
    pub fn density_over_cosine(&self, wo: Vec3<V>, half: Vec3<V>) -> V {
        let d = self.distribution(half);
        if self.masking == Masking::VCavity {
            let cos_half = wo.dot(half).abs().max(half.z.like(V::Elem::MIN_POSITIVE));
            let (one, two) = (half.z.num(1.0), half.z.num(2.0));
            let sides = V::select((two * wo.z * half.z).less(cos_half), two, one);
            return sides * d * half.z / cos_half;
        }
        match self.shape {
            Shape::Ggx => d / self.smith(wo),
            Shape::Beckmann => {
                let (x, y) = (self.alpha_x * wo.x, self.alpha_y * wo.y);
                d / beckmann::smith(wo.z, (x * x + y * y).sqrt())
            }
        }
    }
}
