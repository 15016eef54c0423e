//! Any model over arrays of directions: values, densities, draws. One row of parameters serves all elements, or each
//! has its own, or finds it by number.

use super::bsdf::Bsdf;
use super::model::{Draw, Row};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;

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
        if row.iter().any(|x| x.is_nan()) { None } else { Bsdf::of(self.kind, row) }
    }
    /// The model of all elements, if there is but one.
    #[inline(always)]
    fn only(&self) -> Option<Bsdf<T>> {
        (self.rows.len() == 1).then(|| self.at(0)).flatten()
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
        dispatch!(_s => {
            let only = rows.only();
            for i in 0..out.len() {
                let bsdf = if only.is_some() { only } else { rows.at(first + i) };
                out[i] = bsdf.map_or([T::NAN; 3], |b| b.eval(wi[i].into(), wo[i].into()).to_array());
            }
        })
    })
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
            let only = rows.only();
            for i in 0..out.len() {
                let bsdf = if only.is_some() { only } else { rows.at(first + i) };
                out[i] = bsdf.map_or(T::NAN, |b| b.pdf(wi[i].into(), wo[i].into()));
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
            let only = rows.only();
            for i in 0..wo.len() {
                let bsdf = if only.is_some() { only } else { rows.at(first + i) };
                let nan = crate::vec::Vec3::splat(T::NAN);
                let draw = bsdf.and_then(|b| b.sample(wo[i].into(), u[i]));
                let draw = draw.unwrap_or(Draw { wi: nan, weight: nan, pdf: T::NAN, specular: false, eta: T::NAN });
                (wi[i], weight[i]) = (draw.wi.to_array(), draw.weight.to_array());
                (pdf[i], specular[i], eta[i]) = (draw.pdf, draw.specular, draw.eta);
            }
        })
    })
}
