//! The light that microscopic mirrors throw at each other, given back.
//!
//! One bounce of a perfect rough mirror returns E(cos θ, alpha) of the light; the table of E is made here, once a
//! program, by quadrature over the drawn normals, and interpolated in the cosine and the roughness √alpha. What is
//! missing is added as a lobe of the shape (1 − E(θi)) (1 − E(θo)) / (π (1 − E_avg)), coloured by the bounces:
//!
//! - `Bounces`: F² E / (1 − F (1 − E)), of averages: light that has met at least two mirrors;
//! - `AsPublished`: F E / (1 − F (1 − E)), as the slides first had it: it counts a bounce of colour too few, so metals
//!   come out paler, and is the same at F = 1;
//! - `Scaled`: no lobe; the single bounce times 1 + F0 (1/E(θo) − 1). Cheaper, not reciprocal, of the mirrors' own shape.
//!
//! C. Kulla, A. Conty, *Revisiting physically based shading at Imageworks*, 2017; S. Hill, *A multi-faceted
//! exploration*, 2018 (the colour); E. Turquin, *Practical multiple scattering compensation for microfacet models*, 2019.

use super::microfacets::{Masking, Microfacets, Shape};
use super::model::{Draw, Drawn, Model, Row, triple};
use super::rough_conductor::RoughConductor;
use crate::real::Real;
use crate::sampling::cosine_hemisphere::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};
use crate::sampling::disk::Method;
use crate::vec::Vec3;
use std::sync::OnceLock;

/// Points of the table along either axis.
pub const SIZE: usize = 32;
/// Cells of the quadrature by azimuth and by height of the drawn normals.
const TURNS: usize = 32;
const CELLS: usize = 96;
/// The cosine that stands for zero.
pub const GRAZING: f64 = 1e-6;
/// √(3/5): the outer points of Gauss and Legendre's three.
const OUTER: f64 = 0.774_596_669_241_483_4;

/// What one bounce returns: rows of a roughness, by cosines; and the average of each row.
pub struct Albedo {
    pub by_cosine: [[f64; SIZE]; SIZE],
    pub average: [f64; SIZE],
}

/// The roughness of a row and the cosine of a column: both closer where E bends.
#[inline(always)]
pub fn knot(i: usize) -> f64 {
    let x = i as f64 / (SIZE - 1) as f64;
    x * x
}

/// Kinds of facets.
pub const KINDS: usize = 8;

#[inline(always)]
pub fn kind(shape: Shape, masking: Masking) -> usize {
    masking as usize + 4 * (shape == Shape::Beckmann) as usize
}

pub fn of_kind(kind: usize) -> (Shape, Masking) {
    use Masking::{HeightCorrelated, Schlick, Separable, VCavity};
    let masking = [HeightCorrelated, Separable, Schlick, VCavity][kind % 4];
    (if kind < 4 { Shape::Ggx } else { Shape::Beckmann }, masking)
}

/// A table, made if it is not there. Not under the cell's lock: a process forked meanwhile would wait for it for ever.
/// Threads that come at the same time make it each, and keep one.
pub fn made(cell: &'static OnceLock<Box<Albedo>>, make: impl Fn() -> Albedo) -> &'static Albedo {
    if let Some(table) = cell.get() {
        return table;
    }
    let table = Box::new(make());
    cell.get_or_init(|| table)
}

/// A normal for the quadrature, and D over its density by the cosine at `wo`. Of Beckmann by D cos, though half of these
/// turn away: whether light is reflected in whole depends on the slope, which then follows one of the numbers alone.
pub fn normal(facets: &Microfacets<f64>, wo: Vec3<f64>, u: [f64; 2]) -> (Vec3<f64>, f64) {
    if facets.shape == Shape::Beckmann || facets.masking == Masking::VCavity {
        let normal = facets.normal(u);
        return (normal, wo.dot(normal) / normal.z);
    }
    let normal = facets.sample(wo, u);
    (normal, facets.distribution(normal) / facets.density_over_cosine(wo, normal))
}

fn returned(facets: &Microfacets<f64>, cos: f64) -> f64 {
    let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for i in 0..TURNS * CELLS {
        // Half of the azimuths, by symmetry; points gather where directions graze, at the end of the other number.
        let rest = 1.0 - ((i % CELLS) as f64 + 0.5) / CELLS as f64;
        let u = [((i / CELLS) as f64 + 0.5) * 0.5 / TURNS as f64, 1.0 - rest * rest];
        let (normal, share) = normal(facets, wo, u);
        let wi = normal * (2.0 * wo.dot(normal)) - wo;
        if wi.z > 0.0 && wo.dot(normal) > 0.0 {
            sum += 8.0 * rest * share * facets.visibility(wi, wo, normal) * wi.z;
        }
    }
    // What the quadrature is off by is no light that facets invent.
    (sum / (TURNS * CELLS) as f64).min(1.0)
}

impl std::fmt::Debug for Albedo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Albedo({:?})", self.average)
    }
}

impl Albedo {
    /// From what one bounce off facets returns at a cosine.
    pub fn build(shape: Shape, masking: Masking, returned: impl Fn(&Microfacets<f64>, f64) -> f64) -> Self {
        let mut table = Albedo { by_cosine: [[0.0; SIZE]; SIZE], average: [0.0; SIZE] };
        for (j, row) in table.by_cosine.iter_mut().enumerate() {
            if j == 0 {
                // A smooth mirror loses nothing.
                *row = [1.0; SIZE];
                continue;
            }
            let alpha = knot(j);
            let facets = Microfacets { alpha_x: alpha, alpha_y: alpha, ratio: [1.0, 1.0], shape, masking };
            *row = std::array::from_fn(
                #[inline(always)]
                |i| returned(&facets, knot(i).max(GRAZING)),
            );
        }
        for j in 0..SIZE {
            let row = table.row(j as f64);
            // The integral of what is interpolated, not of what is known: in t with cosine t² it is a polynomial of the
            // fifth degree between knots, which three points of Gauss and Legendre have exactly.
            let step = 1.0 / (SIZE - 1) as f64;
            let mut sum = 0.0;
            for i in 0..SIZE - 1 {
                for (x, weight) in [(-OUTER, 5.0 / 18.0), (0.0, 4.0 / 9.0), (OUTER, 5.0 / 18.0)] {
                    let t = (i as f64 + 0.5 + 0.5 * x) * step;
                    sum += weight * step * 4.0 * t * t * t * row.at(t * t);
                }
            }
            table.average[j] = sum;
        }
        table
    }

    /// The table of a kind of facets.
    pub fn of(shape: Shape, masking: Masking) -> &'static Self {
        static TABLES: [OnceLock<Box<Albedo>>; KINDS] = [const { OnceLock::new() }; KINDS];
        made(&TABLES[kind(shape, masking)], || Albedo::build(shape, masking, returned))
    }

    #[inline(always)]
    pub fn row(&self, at: f64) -> Slice<'_> {
        let below = (at as usize).min(SIZE - 2);
        Slice { table: self, below, share: at - below as f64 }
    }

    /// Of one width: the row between the table's own.
    #[inline(always)]
    pub fn width<T: Real>(&self, alpha: T) -> Slice<'_> {
        self.row(place(alpha.to_f64()))
    }
}

/// The place of a width or a cosine among the knots.
#[inline(always)]
pub fn place(x: f64) -> f64 {
    let at = x.max(0.0).sqrt() * (SIZE - 1) as f64;
    // Below the second knot straight in x.
    if at < 1.0 { at * at } else { at.min((SIZE - 1) as f64) }
}

/// E of one width, by the cosine.
#[derive(Clone, Copy, Debug)]
pub struct Slice<'a> {
    table: &'a Albedo,
    below: usize,
    share: f64,
}

impl Slice<'_> {
    #[inline(always)]
    pub fn at(&self, cos: f64) -> f64 {
        let place = place(cos);
        let i = (place as usize).min(SIZE - 2);
        let t = place - i as f64;
        let (low, high) = (&self.table.by_cosine[self.below], &self.table.by_cosine[self.below + 1]);
        let (a, b) = (low[i] + (low[i + 1] - low[i]) * t, high[i] + (high[i + 1] - high[i]) * t);
        a + (b - a) * self.share
    }
    #[inline(always)]
    pub fn average(&self) -> f64 {
        let (a, b) = (self.table.average[self.below], self.table.average[self.below + 1]);
        a + (b - a) * self.share
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Bounces,
    AsPublished,
    Scaled,
}

impl Form {
    #[inline(always)]
    pub fn of<T: Real>(number: T) -> Self {
        match number.to_f64() as i32 {
            2 => Form::AsPublished,
            3 => Form::Scaled,
            _ => Form::Bounces,
        }
    }
    /// The colour of the added lobe, of the average reflectance and the average E.
    #[inline(always)]
    pub fn color<T: Real>(self, fresnel: T, average: T) -> T {
        let one = T::one();
        let bounced = fresnel * average / (one - fresnel * (one - average));
        if self == Form::Bounces { fresnel * bounced } else { bounced }
    }
}

/// The added lobe of a reflectance of one: (1 − E(θi)) (1 − E(θo)) / (π (1 − E_avg)).
#[inline(always)]
pub fn missing<T: Real>(slice: &Slice<'_>, wi: Vec3<T>, wo: Vec3<T>) -> T {
    let lost = 1.0 - slice.average();
    let both = (1.0 - slice.at(wi.z.to_f64())).max(0.0) * (1.0 - slice.at(wo.z.to_f64())).max(0.0);
    T::of(if lost > 1e-9 { both / (std::f64::consts::PI * lost) } else { 0.0 })
}

/// Rough metal that gives back the light of further bounces.
#[derive(Clone, Copy, Debug)]
pub struct Compensated<T> {
    pub once: RoughConductor<T>,
    pub form: Form,
    pub slice: Slice<'static>,
    /// Fresnel's average per channel, tint included; the reflectance along the normal for [`Form::Scaled`].
    pub fresnel: Vec3<T>,
}

impl<T: Real> Compensated<T> {
    /// The chance of drawing from the added lobe.
    #[inline(always)]
    fn chance(&self, wo: Vec3<T>) -> T {
        if self.form == Form::Scaled {
            T::zero()
        } else {
            T::of((1.0 - self.slice.at(wo.z.to_f64())).max(0.0))
        }
    }
}

impl<T: Real> Model<T> for Compensated<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        let once = RoughConductor::of(row);
        let slice = Albedo::of(once.facets.shape, once.facets.masking).width(once.facets.mean_width());
        let fresnel = triple(row, 14).times(once.tint);
        Compensated { once, form: Form::of(row[13]), slice, fresnel }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        if super::apart(wi, wo) {
            return Vec3::splat(T::zero());
        }
        let once = self.once.value(wi, wo);
        if self.form == Form::Scaled {
            let more = T::of(1.0 / self.slice.at(wo.z.to_f64()) - 1.0);
            return once.zip(
                self.fresnel,
                #[inline(always)]
                |f, f0| f * (T::one() + f0 * more),
            );
        }
        let average = T::of(self.slice.average());
        let lobe = missing(&self.slice, wi, wo);
        once + self.fresnel.map(
            #[inline(always)]
            |f| lobe * self.form.color(f, average),
        )
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        if wo.z <= T::zero() {
            return T::zero();
        }
        let chance = self.chance(wo);
        let one = T::one();
        (one - chance) * self.once.pdf(wi, wo) + chance * square_to_cosine_hemisphere_pdf(wi)
    }
}

impl<T: Real> Drawn<T> for Compensated<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        if !(wo.z > T::zero()) {
            return None;
        }
        let wi = if u[2] < self.chance(wo) {
            square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric)
        } else {
            let half = self.once.facets.sample(wo, [u[0], u[1]]);
            half * (T::of(2.0) * wo.dot(half)) - wo
        };
        Some(super::model::weighed(self, wi, wo, T::one()))
    }
}
