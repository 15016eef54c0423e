//! Rough glass with the light that its facets send on to each other.
//!
//! Of light on side s at a cosine one bounce, off the interface or through it, gives back L_s; E_s = 1 − L_s is missing,
//! and Ē_s of light from everywhere. It comes back as a lobe on either side, of the shape that Kulla and Conty give it:
//! f(wi on s, wo on t) = r_st E_s(wi) E_t(wo) / (π Ē_t), whose integral over wo with the cosine is r_st E_s(wi). Nothing
//! is lost if r_ss + r_st = 1. The symmetry of the single bounce for radiance, f(wi, wo) η_s² = f(wo, wi) η_t² with the
//! index on each direction's side, asks for r_st η_s² Ē_s = r_ts η_t² Ē_t. One number stays free. Of diffuse light the
//! smooth interface passes P_s = 1 − F̄_s, with η_s² P_s = η_t² P_t: hence r_st = P_s min(1, Ē_t / Ē_s), which keeps the
//! symmetry, is never above one, and passes all where nothing reflects. (With Ē_t / (Ē_s + Ē_t) in its place, symmetric as
//! well, half would be reflected between equal indices.) `Scaled` is no lobe but the single bounce over L(wo).
//!
//! L is tabulated over cosine, √alpha and the root of |η − 1| / (η + 1) on either side of η = 1, from equal indices to
//! perfect mirrors, by quadrature over drawn normals; a slab of one index when it is first asked for. η = 1 itself passes
//! light straight and misses none.
//!
//! C. Kulla, A. Conty, *Revisiting physically based shading at Imageworks*, 2017; E. Turquin, *Practical multiple
//! scattering compensation for microfacet models*, 2019 (the scaled form).

use super::fresnel::fresnel_dielectric;
use super::kulla_conty::{Albedo, Form, KINDS, SIZE, Slice, kind, made, normal, of_kind, place};
use super::microfacets::{Masking, Microfacets, Shape};
use super::model::{Draw, Drawn, Model, Row, weighed};
use super::rough_dielectric::RoughDielectric;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::sampling::cosine_hemisphere::square_to_cosine_hemisphere;
use crate::sampling::disk::Method;
use crate::vec::Vec3;
use std::sync::OnceLock;

/// Slabs on either side of η = 1.
const SLABS: usize = 64;
/// Cells of the quadrature by azimuth and by height of the drawn normals.
const TURNS: usize = 32;
const CELLS: usize = 64;
/// Less light than this is none.
const NOTHING: f64 = 1e-9;

/// What one bounce returns of light at a cosine, for an index `n` across over that on its side.
fn returned(facets: &Microfacets<f64>, n: f64, cos: f64) -> f64 {
    let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for i in 0..TURNS * CELLS {
        // Half of the azimuths, by symmetry; points gather where directions graze, at the end of the other number.
        let rest = 1.0 - ((i % CELLS) as f64 + 0.5) / CELLS as f64;
        let u = [((i / CELLS) as f64 + 0.5) * 0.5 / TURNS as f64, 1.0 - rest * rest];
        let (normal, share) = normal(facets, wo, u);
        let co = wo.dot(normal);
        if !(co > 0.0) {
            continue;
        }
        let fresnel = fresnel_dielectric(co.min(1.0), n);
        let f = fresnel.average();
        let weight = 2.0 * rest * share;
        let off = normal * (2.0 * co) - wo;
        if off.z > 0.0 {
            sum += weight * f * facets.visibility(off, wo, normal) * off.z * 4.0;
        }
        let across = normal * (co / n - fresnel.cos_t) - wo * (1.0 / n);
        if across.z < 0.0 && f < 1.0 {
            sum +=
                weight * (1.0 - f) * facets.masking_at(across, normal) * facets.masking_at(wo, normal) / wo.z;
        }
    }
    // What the quadrature is off by is no light that facets invent.
    (sum / (TURNS * CELLS) as f64).min(1.0)
}

/// Of one index: those below one follow those above.
fn slab(kind: usize, number: usize) -> &'static Albedo {
    static TABLES: [[OnceLock<Box<Albedo>>; 2 * SLABS]; KINDS] =
        [const { [const { OnceLock::new() }; 2 * SLABS] }; KINDS];
    made(&TABLES[kind][number], || {
        let root = (number % SLABS) as f64 / (SLABS - 1) as f64;
        // Neither equal indices nor infinite ones.
        let x = (root * root).clamp(1e-9, 1.0 - 1e-9);
        let n = (1.0 + x) / (1.0 - x);
        let n = if number < SLABS { n } else { 1.0 / n };
        let (shape, masking) = of_kind(kind);
        Albedo::build(shape, masking, |facets, cos| returned(facets, n, cos))
    })
}

/// The first of the two slabs about an index other than one, and the share of the second.
#[inline(always)]
fn place_of(n: f64) -> (usize, f64) {
    let at = ((n - 1.0).abs() / (n + 1.0)).sqrt() * (SLABS - 1) as f64;
    let below = (at as usize).min(SLABS - 2);
    (below + if n < 1.0 { SLABS } else { 0 }, at - below as f64)
}

#[inline(always)]
fn between(shape: Shape, masking: Masking, n: f64) -> ([&'static Albedo; 2], f64) {
    let (first, share) = place_of(n);
    let kind = kind(shape, masking);
    ([slab(kind, first), slab(kind, first + 1)], share)
}

/// Which slabs interfaces ask for.
pub struct Wanted([[bool; 2 * SLABS]; KINDS]);

impl Wanted {
    pub fn none() -> Self {
        Wanted([[false; 2 * SLABS]; KINDS])
    }
    pub fn add<T: Real>(&mut self, facets: &Microfacets<T>, eta: T) {
        let n = eta.to_f64();
        if n == 1.0 || n.is_nan() {
            return;
        }
        for n in [n, 1.0 / n] {
            let (first, _) = place_of(n);
            self.0[kind(facets.shape, facets.masking)][first..first + 2].fill(true);
        }
    }
    /// Makes them, on all threads; each takes some tenth of a second.
    pub fn make(&self, watch: &mut dyn Watch) -> Result<(), Interrupted> {
        let all = (0..KINDS).flat_map(|kind| (0..2 * SLABS).map(move |number| (kind, number)));
        let wanted: Vec<_> = all.filter(|&(kind, number)| self.0[kind][number]).collect();
        parallel::run(watch, wanted.len(), |i| {
            slab(wanted[i].0, wanted[i].1);
        })
    }
}

/// The table of an index, between its slabs: rows of a roughness, by cosines; and the average of each row.
pub fn table(shape: Shape, masking: Masking, n: f64) -> Albedo {
    let mut found = Albedo { by_cosine: [[1.0; SIZE]; SIZE], average: [1.0; SIZE] };
    if n != 1.0 {
        let ([low, high], share) = between(shape, masking, n);
        for j in 0..SIZE {
            found.average[j] = low.average[j] + (high.average[j] - low.average[j]) * share;
            for i in 0..SIZE {
                let (a, b) = (low.by_cosine[j][i], high.by_cosine[j][i]);
                found.by_cosine[j][i] = a + (b - a) * share;
            }
        }
    }
    found
}

/// What one bounce of an interface misses, and where it goes. Sides: 0 is outside, 1 within the body.
#[derive(Clone, Copy, Debug)]
pub struct Missing<T> {
    slabs: [[&'static Albedo; 2]; 2],
    shares: [T; 2],
    /// The place of the width among the rows.
    row: T,
    average: [T; 2],
    /// What passes a smooth interface of diffuse light from either side.
    passes: [T; 2],
}

#[inline(always)]
fn side<T: Real>(cos: T) -> usize {
    if cos < T::zero() { 1 } else { 0 }
}

impl<T: Real> Missing<T> {
    /// `eta` is the index inside over outside; `passes` is of diffuse light that meets the larger index. None if nothing
    /// is missing.
    #[inline(always)]
    pub fn of(facets: &Microfacets<T>, eta: T, passes: T) -> Option<Self> {
        let n = eta.to_f64();
        if n == 1.0 {
            return None;
        }
        let row = place(facets.mean_width().to_f64());
        let (outside, a) = between(facets.shape, facets.masking, n);
        let (inside, b) = between(facets.shape, facets.masking, 1.0 / n);
        let average = |slabs: [&'static Albedo; 2], share: f64| {
            let (low, high) = (slabs[0].row(row).average(), slabs[1].row(row).average());
            T::of((1.0 - (low + (high - low) * share)).max(0.0))
        };
        // What comes out of a body is what goes in, by the square of the index.
        let (larger, one) = (Lanes::max(eta, T::one() / eta), T::one());
        let back = Lanes::min(passes / (larger * larger), one);
        Some(Missing {
            slabs: [outside, inside],
            shares: [T::of(a), T::of(b)],
            row: T::of(row),
            average: [average(outside, a), average(inside, b)],
            passes: if eta < one { [back, passes] } else { [passes, back] },
        })
    }
    /// E of a direction, by its cosine: below zero within.
    #[inline(always)]
    pub fn at(&self, cos: T) -> T {
        let s = side(cos);
        if !(self.average[s] > T::of(NOTHING)) {
            return T::zero();
        }
        let (row, cos) = (self.row.to_f64(), cos.to_f64().abs());
        let [low, high] = self.slabs[s];
        let (low, high): (Slice<'_>, Slice<'_>) = (low.row(row), high.row(row));
        let (low, high) = (low.at(cos), high.at(cos));
        T::of((1.0 - (low + (high - low) * self.shares[s].to_f64())).max(0.0))
    }
    /// The share of what is missing on the side of a cosine that leaves on the other.
    #[inline(always)]
    pub fn crossing(&self, cos: T) -> T {
        let (s, one) = (side(cos), T::one());
        let own = self.average[s];
        if own > T::zero() { self.passes[s] * Lanes::min(self.average[1 - s] / own, one) } else { T::zero() }
    }
    /// The added lobes in sr⁻¹, of no tint.
    #[inline(always)]
    pub fn lobe(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        let both = self.at(wi.z) * self.at(wo.z);
        if !(both > T::zero()) {
            return T::zero();
        }
        let (s, t) = (side(wi.z), side(wo.z));
        if s == t {
            return (T::one() - self.crossing(wi.z)) * both / (T::PI * self.average[s]);
        }
        self.passes[s] * both / (T::PI * Lanes::max(self.average[s], self.average[t]))
    }
    /// The density of directions of [`Missing::directed`].
    #[inline(always)]
    pub fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        let cross = self.crossing(wo.z);
        let share = if side(wi.z) == side(wo.z) { T::one() - cross } else { cross };
        share * wi.z.abs() / T::PI
    }
    /// A direction by the cosine on either side, and whether it crosses.
    #[inline(always)]
    pub fn directed(&self, wo: Vec3<T>, u: [T; 3]) -> (Vec3<T>, bool) {
        let wi = square_to_cosine_hemisphere([u[0], u[1]], Method::Concentric);
        let crosses = u[2] < self.crossing(wo.z);
        (if crosses == (wo.z > T::zero()) { -wi } else { wi }, crosses)
    }
}

/// Rough glass that gives back the light of further bounces.
#[derive(Clone, Copy, Debug)]
pub struct CompensatedGlass<T> {
    pub once: RoughDielectric<T>,
    scaled: bool,
    missing: Option<Missing<T>>,
}

impl<T: Real> CompensatedGlass<T> {
    /// The added lobes, and the chance of drawing from them.
    #[inline(always)]
    fn added(&self, wo: Vec3<T>) -> Option<(&Missing<T>, T)> {
        match &self.missing {
            Some(missing) if !self.scaled => Some((missing, missing.at(wo.z))),
            _ => None,
        }
    }
}

impl<T: Real> Model<T> for CompensatedGlass<T> {
    #[inline(always)]
    fn of(row: &Row<T>) -> Self {
        let once = RoughDielectric::of(row);
        let missing = Missing::of(&once.facets, once.eta, row[9]);
        CompensatedGlass { once, scaled: Form::of(row[8]) == Form::Scaled, missing }
    }
    #[inline(always)]
    fn eval(&self, wi: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let (zero, once) = (T::zero(), self.once.eval(wi, wo));
        let Some(missing) = &self.missing else { return once };
        if self.scaled {
            return once * (T::one() / (T::one() - missing.at(wo.z)));
        }
        let lobe = missing.lobe(wi, wo);
        let cross = wi.z * wo.z;
        if cross < zero {
            once + self.once.tint * lobe
        } else if cross > zero {
            once + Vec3::splat(lobe)
        } else {
            once
        }
    }
    #[inline(always)]
    fn pdf(&self, wi: Vec3<T>, wo: Vec3<T>) -> T {
        let once = self.once.pdf(wi, wo);
        let Some((missing, chance)) = self.added(wo) else { return once };
        if wi.z * wo.z == T::zero() {
            return once;
        }
        (T::one() - chance) * once + chance * missing.pdf(wi, wo)
    }
}

impl<T: Real> Drawn<T> for CompensatedGlass<T> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<T>, u: [T; 3]) -> Option<Draw<T>> {
        let one = T::one();
        if !(wo.z.abs() > T::zero()) {
            return None;
        }
        // Weighed in one place, whatever it is drawn from: evaluation is the most of the code.
        let added = self.added(wo);
        let chance = match added {
            Some((_, chance)) => chance,
            None => T::zero(),
        };
        let found = match added {
            Some((missing, _)) if u[2] < chance => {
                let (wi, crosses) = missing.directed(wo, [u[0], u[1], u[2] / chance]);
                Ok((wi, if crosses { self.once.across(wo) } else { one }))
            }
            _ => {
                let rest = Lanes::min((u[2] - chance) / (one - chance), one - T::EPSILON);
                self.once.directed(wo, [u[0], u[1], rest])
            }
        };
        match found {
            Ok((wi, eta)) => Some(weighed(self, wi, wo, eta)),
            Err(draw) => draw,
        }
    }
}
