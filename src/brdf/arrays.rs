//! Any model over arrays of directions: values, densities, draws. One row of parameters serves all elements, or each
//! has its own, or finds it by number.

use super::bsdf::{Bsdf, Terms};
use super::compensated_glass::Wanted;
use super::lambert::Diffuse;
use super::metallic_roughness::Lobes;
use super::model::{Draw, Model, Row, WIDTH};
use super::one_metal::OneMetal;
use super::principled::Principled;
use super::rough_conductor::RoughConductor;
use super::rough_dielectric::RoughDielectric;
use super::specular_glossiness::SpecularGlossiness;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use crate::simd::columns::{Sink, Source};
use crate::vec::Vec3;
use crate::{dispatch, in_lanes};

/// Rows of one kind, and which of them serves an element.
#[derive(Clone, Copy)]
pub struct Rows<'a, T> {
    pub kind: i32,
    pub rows: &'a [Row<T>],
    /// None: one row for all, or one each.
    pub ids: Option<&'a [i32]>,
}

impl<T: Real> Rows<'_, T> {
    /// The model of an element; None where a parameter is NaN.
    #[inline(always)]
    fn at(&self, i: usize) -> Option<Bsdf<T>> {
        let row = match self.ids {
            Some(ids) => ids[i] as usize,
            None => i.min(self.rows.len() - 1),
        };
        let row = &self.rows[row];
        if row.iter().any(
            #[inline(always)]
            |x| x.is_nan(),
        ) {
            None
        } else {
            Bsdf::of(self.kind, row)
        }
    }
    /// The model of an element: the only one, or its own, held in `own`.
    #[inline(always)]
    fn serving<'a>(
        &self,
        i: usize,
        only: &'a Option<Bsdf<T>>,
        own: &'a mut Option<Bsdf<T>>,
    ) -> Option<&'a Bsdf<T>> {
        if only.is_some() {
            return only.as_ref();
        }
        *own = self.at(i);
        own.as_ref()
    }
    /// The model of all elements, if there is but one.
    #[inline(always)]
    fn only(&self) -> Option<Bsdf<T>> {
        if self.rows.len() == 1 { self.at(0) } else { None }
    }
}

/// Makes the tables that compensated glass asks for, where a watch can stop it.
fn tables<T: Real>(watch: &mut dyn Watch, rows: &Rows<'_, T>) -> Result<(), Interrupted> {
    let mut wanted = Wanted::none();
    for row in rows.rows {
        match rows.kind {
            13 => {
                let glass = RoughDielectric::of(row);
                wanted.add(&glass.facets, glass.eta);
            }
            14 => {
                let glass = Principled::of(row).glass;
                wanted.add(&glass.facets, glass.eta);
            }
            _ => return Ok(()),
        }
    }
    wanted.make(watch)
}

const PIECE: usize = 1 << 12;
/// Of values, which are cheap: long runs of memory.
const RUN: usize = 1 << 14;

/// NaN where a parameter is.
pub fn eval_many<T: Real>(
    watch: &mut dyn Watch,
    rows: Rows<'_, T>,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    let metal = match rows.only() {
        Some(Bsdf::RoughConductor(metal)) => OneMetal::of(&metal),
        _ => None,
    };
    tables(watch, &rows)?;
    parallel::for_each(watch, (wi, wo, out), RUN, |first, (wi, wo, out)| {
        dispatch!(s => {
            if let Some(metal) = metal {
                metal.eval(s, wi, wo, out);
                return;
            }
            if rows.ids.is_none() && lanes::<T, _, Value, 3>(s, &rows, first, (wi, wo), out) {
                return;
            }
            let (only, mut own) = (rows.only(), None);
            for i in 0..out.len() {
                out[i] = match rows.serving(first + i, &only, &mut own) {
                    Some(bsdf) => bsdf.eval(wi[i].into(), wo[i].into()).to_array(),
                    None => [T::NAN; 3],
                };
            }
        })
    })
}

/// What a model gives of eight pairs of directions.
trait Job<V: Lanes, const N: usize> {
    fn of<M: Model<V>>(model: &M, wi: Vec3<V>, wo: Vec3<V>) -> [V; N];
}

struct Value;
struct Density;

impl<V: Lanes> Job<V, 3> for Value {
    #[inline(always)]
    fn of<M: Model<V>>(model: &M, wi: Vec3<V>, wo: Vec3<V>) -> [V; 3] {
        model.eval(wi, wo).to_array()
    }
}

impl<V: Lanes> Job<V, 1> for Density {
    #[inline(always)]
    fn of<M: Model<V>>(model: &M, wi: Vec3<V>, wo: Vec3<V>) -> [V; 1] {
        [model.pdf(wi, wo)]
    }
}

/// A job eight elements at a time, by models that are written in lanes; whether there was one.
#[inline(always)]
fn lanes<T: Real, S: Simd, J: Job<T::V8<S>, N>, const N: usize>(
    s: S,
    rows: &Rows<'_, T>,
    first: usize,
    (wi, wo): (&[[T; 3]], &[[T; 3]]),
    out: &mut [[T; N]],
) -> bool {
    match rows.kind {
        0 => by_model::<T, S, Lobes<T::V8<S>>, J, N>(s, rows, first, (wi, wo), out),
        1 => by_model::<T, S, Diffuse<T::V8<S>>, J, N>(s, rows, first, (wi, wo), out),
        4 => by_model::<T, S, RoughConductor<T::V8<S>>, J, N>(s, rows, first, (wi, wo), out),
        9 => by_model::<T, S, SpecularGlossiness<T::V8<S>>, J, N>(s, rows, first, (wi, wo), out),
        _ => return false,
    }
    true
}

#[inline(always)]
fn by_model<T: Real, S: Simd, M: Model<T::V8<S>>, J: Job<T::V8<S>, N>, const N: usize>(
    s: S,
    rows: &Rows<'_, T>,
    first: usize,
    (wi, wo): (&[[T; 3]], &[[T; 3]]),
    out: &mut [[T; N]],
) {
    let n = out.len();
    let (mut wi, mut wo, mut out) = (Source::over(wi, 0), Source::over(wo, 0), Sink::over(s, out));
    let mut row = Source::over(rows.rows, first);
    if rows.rows.len() == 1 {
        let row = row.lanes(s, 0);
        let (model, spoilt) = (M::of(&row), spoilt(&row));
        in_lanes!(s, n, |wi, wo| -> (out) { marked(J::of(&model, wi.into(), wo.into()), spoilt) });
    } else {
        in_lanes!(s, n, |wi, wo, row| -> (out) {
            marked(J::of(&M::of(&row), wi.into(), wo.into()), spoilt(&row))
        });
    }
}

/// Zero; NaN where a parameter is.
#[inline(always)]
fn spoilt<V: Lanes>(row: &Row<V>) -> V {
    let mut sum = row[0].num(0.0);
    for k in 0..WIDTH {
        sum = sum + row[k] * row[k].num(0.0);
    }
    sum
}

#[inline(always)]
fn marked<V: Lanes, const N: usize>(mut x: [V; N], spoilt: V) -> [V; N] {
    for c in 0..N {
        x[c] = x[c] + spoilt;
    }
    x
}

/// NaN where a parameter is.
pub fn pdf_many<T: Real>(
    watch: &mut dyn Watch,
    rows: Rows<'_, T>,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    out: &mut [[T; 1]],
) -> Result<(), Interrupted> {
    tables(watch, &rows)?;
    parallel::for_each(watch, (wi, wo, out), RUN, |first, (wi, wo, out)| {
        dispatch!(s => {
            if rows.ids.is_none() && lanes::<T, _, Density, 1>(s, &rows, first, (wi, wo), out) {
                return;
            }
            let (only, mut own) = (rows.only(), None);
            for i in 0..out.len() {
                out[i] = match rows.serving(first + i, &only, &mut own) {
                    Some(bsdf) => [bsdf.pdf(wi[i].into(), wo[i].into())],
                    None => [T::NAN],
                };
            }
        })
    })
}

/// Draws as columns: direction, weight, density, whether specular, index ratio. NaN where a parameter or a number is, or
/// where nothing can come back along `wo`.
pub struct Draws<'a, T> {
    pub wi: &'a mut [[T; 3]],
    pub weight: &'a mut [[T; 3]],
    pub pdf: &'a mut [T],
    pub specular: &'a mut [bool],
    pub eta: &'a mut [T],
}

pub fn sample_many<T: Real>(
    watch: &mut dyn Watch,
    rows: Rows<'_, T>,
    wo: &[[T; 3]],
    u: &[[T; 3]],
    out: Draws<'_, T>,
) -> Result<(), Interrupted> {
    tables(watch, &rows)?;
    let columns = (wo, u, out.wi, out.weight, out.pdf, out.specular, out.eta);
    parallel::for_each(watch, columns, PIECE, |first, (wo, u, wi, weight, pdf, specular, eta)| {
        dispatch!(_s => {
            let (only, mut own) = (rows.only(), None);
            for i in 0..wo.len() {
                let nan = Vec3::splat(T::NAN);
                let draw = match rows.serving(first + i, &only, &mut own) {
                    // A number that is none would choose all the same.
                    Some(bsdf) if !(u[i][0] + u[i][1] + u[i][2]).is_nan() => bsdf.sample(wo[i].into(), u[i]),
                    _ => None,
                };
                let draw = draw.unwrap_or(Draw { wi: nan, weight: nan, pdf: T::NAN, specular: false, eta: T::NAN });
                (wi[i], weight[i]) = (draw.wi.to_array(), draw.weight.to_array());
                (pdf[i], specular[i], eta[i]) = (draw.pdf, draw.specular, draw.eta);
            }
        })
    })
}

/// Factors as columns: half vector, D, F, G; NaN of models that have none.
pub struct TermColumns<'a, T> {
    pub half: &'a mut [[T; 3]],
    pub distribution: &'a mut [T],
    pub fresnel: &'a mut [[T; 3]],
    pub masking: &'a mut [T],
}

pub fn terms_many<T: Real>(
    watch: &mut dyn Watch,
    rows: Rows<'_, T>,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    out: TermColumns<'_, T>,
) -> Result<(), Interrupted> {
    let columns = (wi, wo, out.half, out.distribution, out.fresnel, out.masking);
    parallel::for_each(watch, columns, PIECE, |first, (wi, wo, half, distribution, fresnel, masking)| {
        dispatch!(_s => {
            for i in 0..wi.len() {
                let terms = match rows.at(first + i) {
                    Some(bsdf) => bsdf.terms(wi[i].into(), wo[i].into()),
                    None => None,
                };
                let nan = Vec3::splat(T::NAN);
                let none = Terms { half: nan, distribution: T::NAN, fresnel: nan, masking: T::NAN };
                let t = terms.unwrap_or(none);
                (half[i], distribution[i]) = (t.half.to_array(), t.distribution);
                (fresnel[i], masking[i]) = (t.fresnel.to_array(), t.masking);
            }
        })
    })
}
