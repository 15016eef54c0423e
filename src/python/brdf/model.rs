//! Bindings of all models by kind and rows of parameters.

use crate::brdf::{self, Draws, Row, Rows, TermColumns, WIDTH};
use crate::python::array::{In, Out, run};
use crate::real;
use crate::real::Real;
use numpy::Element;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Rows held for a kernel: the kind, a table (n, WIDTH), and the number of each element's row.
pub struct Table<'py, T: Element> {
    kind: i32,
    rows: In<'py, T>,
    ids: Option<In<'py, i32>>,
}

/// What Python hands over for it.
type TableTuple<'py> = (i32, Bound<'py, PyAny>, Option<Bound<'py, PyAny>>);

impl<'py, T: Real + Element> Table<'py, T> {
    fn of((kind, rows, ids): &TableTuple<'py>) -> PyResult<Self> {
        let ids = ids.as_ref().map(|ids| In::of("ids", ids)).transpose()?;
        Ok(Table { kind: *kind, rows: In::of("rows", rows)?, ids })
    }
    /// Checked against `n` elements.
    fn get(&self, n: usize) -> PyResult<Rows<'_, T>> {
        let rows: &[Row<T>] = self.rows.items()?;
        let ids = self.ids.as_ref().map(|ids| ids.slice()).transpose()?;
        let fits = match ids {
            Some(ids) => {
                ids.len() == n && ids.iter().all(|&i| (0..rows.len() as i64).contains(&i64::from(i)))
            }
            None => rows.len() == 1 || rows.len() == n,
        };
        if fits {
            Ok(Rows { kind: self.kind, rows, ids })
        } else {
            Err(PyValueError::new_err("rows: expected one, or one for each element"))
        }
    }
}

/// The numbers of a row.
#[pyfunction]
pub fn row_width() -> usize {
    WIDTH
}

#[pyfunction]
pub fn model_eval(
    py: Python<'_>,
    table: TableTuple<'_>,
    wi: &Bound<'_, PyAny>,
    wo: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let (table, wi, wo) = (Table::<T>::of(&table)?, In::<T>::of("wi", wi)?, In::<T>::of("wo", wo)?);
        let mut out = Out::<T>::of("out", out)?;
        let (wi, wo, out) = (wi.items()?, wo.items()?, out.items()?);
        let rows = table.get(out.len())?;
        run(py, None, |watch| brdf::eval_many(watch, rows, wi, wo, out))
    })
}

#[pyfunction]
pub fn model_pdf(
    py: Python<'_>,
    table: TableTuple<'_>,
    wi: &Bound<'_, PyAny>,
    wo: &Bound<'_, PyAny>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(out, T => {
        let (table, wi, wo) = (Table::<T>::of(&table)?, In::<T>::of("wi", wi)?, In::<T>::of("wo", wo)?);
        let mut out = Out::<T>::of("out", out)?;
        let (wi, wo, out) = (wi.items()?, wo.items()?, out.items()?);
        let rows = table.get(out.len())?;
        run(py, None, |watch| brdf::pdf_many(watch, rows, wi, wo, out))
    })
}

/// `out`: direction, weight, density, whether specular, index ratio.
#[pyfunction]
pub fn model_sample(
    py: Python<'_>,
    table: TableTuple<'_>,
    wo: &Bound<'_, PyAny>,
    u: &Bound<'_, PyAny>,
    out: [Bound<'_, PyAny>; 5],
) -> PyResult<()> {
    let [wi, weight, pdf, specular, eta] = &out;
    real!(wi, T => {
        let (table, wo, u) = (Table::<T>::of(&table)?, In::<T>::of("wo", wo)?, In::<T>::of("u", u)?);
        let (mut wi, mut weight) = (Out::<T>::of("wi", wi)?, Out::<T>::of("weight", weight)?);
        let (mut pdf, mut eta) = (Out::<T>::of("pdf", pdf)?, Out::<T>::of("eta", eta)?);
        let mut specular = Out::<bool>::of("specular", specular)?;
        let (wo, u, wi) = (wo.items()?, u.items()?, wi.items()?);
        let rows = table.get(wi.len())?;
        let (weight, pdf) = (weight.items()?, pdf.slice()?);
        let out = Draws { wi, weight, pdf, specular: specular.slice()?, eta: eta.slice()? };
        run(py, None, |watch| brdf::sample_many(watch, rows, wo, u, out))
    })
}

/// `out`: half vector, D, F, G.
#[pyfunction]
pub fn model_terms(
    py: Python<'_>,
    table: TableTuple<'_>,
    wi: &Bound<'_, PyAny>,
    wo: &Bound<'_, PyAny>,
    out: [Bound<'_, PyAny>; 4],
) -> PyResult<()> {
    let [half, distribution, fresnel, masking] = &out;
    real!(half, T => {
        let (table, wi, wo) = (Table::<T>::of(&table)?, In::<T>::of("wi", wi)?, In::<T>::of("wo", wo)?);
        let (mut half, mut fresnel) = (Out::<T>::of("half", half)?, Out::<T>::of("fresnel", fresnel)?);
        let mut distribution = Out::<T>::of("distribution", distribution)?;
        let mut masking = Out::<T>::of("masking", masking)?;
        let (wi, wo, half) = (wi.items()?, wo.items()?, half.items()?);
        let rows = table.get(half.len())?;
        let (fresnel, distribution) = (fresnel.items()?, distribution.slice()?);
        let out = TermColumns { half, distribution, fresnel, masking: masking.slice()? };
        run(py, None, |watch| brdf::terms_many(watch, rows, wi, wo, out))
    })
}
