//! Any model over arrays of directions: values, densities, draws. One row of parameters serves all elements, or each
//! has its own, or finds it by number.

use super::bsdf::{Bsdf, Terms};
use super::model::{Draw, Row};
use super::rough_conductor::RoughConductor;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::simd::{Simd, SimdBase};
use crate::vec::Vec3;

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

const PIECE: usize = 1 << 12;

/// NaN where a parameter is.
pub fn eval_many<T: Real>(
    watch: &mut dyn Watch,
    rows: Rows<'_, T>,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (wi, wo, out), PIECE, |first, (wi, wo, out)| {
        dispatch!(s => {
            let (only, mut own) = (rows.only(), None);
            if let Some(Bsdf::RoughConductor(m)) = only {
                return rough_conductor(s, &m, wi, wo, out);
            }
            for i in 0..out.len() {
                out[i] = match rows.serving(first + i, &only, &mut own) {
                    Some(bsdf) => bsdf.eval(wi[i].into(), wo[i].into()).to_array(),
                    None => [T::NAN; 3],
                };
            }
        })
    })
}

/// Directions of eight elements, in lanes.
#[inline(always)]
fn gather<T: Real, S: Simd>(s: S, w: &[[T; 3]; LANES]) -> Vec3<T::V8<S>> {
    let mut columns = [[T::zero(); LANES]; 3];
    for k in 0..LANES {
        for c in 0..3 {
            columns[c][k] = w[k][c];
        }
    }
    Vec3::from(columns).map(
        #[inline(always)]
        |c| <T::V8<S> as SimdBase<S>>::load_array_ref(s, &c),
    )
}

const LANES: usize = 8;

/// One metal for all directions: eight at a time.
#[inline(always)]
fn rough_conductor<T: Real, S: Simd>(
    s: S,
    metal: &RoughConductor<T>,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    out: &mut [[T; 3]],
) {
    let lanes = metal.lanes(s);
    let (wi, wi_rest) = wi.as_chunks::<LANES>();
    let (wo, wo_rest) = wo.as_chunks::<LANES>();
    let (out, out_rest) = out.as_chunks_mut::<LANES>();
    for (wi, (wo, out)) in wi.iter().zip(wo.iter().zip(out)) {
        let f = lanes.value(gather(s, wi), gather(s, wo));
        let (x, y, z) = (f.x.as_slice(), f.y.as_slice(), f.z.as_slice());
        for k in 0..LANES {
            out[k] = [x[k], y[k], z[k]];
        }
    }
    for (wi, (wo, out)) in wi_rest.iter().zip(wo_rest.iter().zip(out_rest)) {
        *out = metal.value((*wi).into(), (*wo).into()).to_array();
    }
}

/// NaN where a parameter is.
pub fn pdf_many<T: Real>(
    watch: &mut dyn Watch,
    rows: Rows<'_, T>,
    wi: &[[T; 3]],
    wo: &[[T; 3]],
    out: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(watch, (wi, wo, out), PIECE, |first, (wi, wo, out)| {
        dispatch!(_s => {
            let (only, mut own) = (rows.only(), None);
            for i in 0..out.len() {
                out[i] = match rows.serving(first + i, &only, &mut own) {
                    Some(bsdf) => bsdf.pdf(wi[i].into(), wo[i].into()),
                    None => T::NAN,
                };
            }
        })
    })
}

/// Draws as columns: direction, weight, density, whether specular, index ratio. NaN where a parameter is, or where
/// nothing can come back along `wo`.
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
    let columns = (wo, u, out.wi, out.weight, out.pdf, out.specular, out.eta);
    parallel::for_each(watch, columns, PIECE, |first, (wo, u, wi, weight, pdf, specular, eta)| {
        dispatch!(_s => {
            let (only, mut own) = (rows.only(), None);
            for i in 0..wo.len() {
                let nan = Vec3::splat(T::NAN);
                let draw = match rows.serving(first + i, &only, &mut own) {
                    Some(bsdf) => bsdf.sample(wo[i].into(), u[i]),
                    None => None,
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
