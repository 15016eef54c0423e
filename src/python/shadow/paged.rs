//! Bindings of `shadow`: the pages of virtual maps.

use super::by_projection;
use super::chart::Chart;
use super::maps::{Seen, view};
use crate::python::array::{In, Out, run};
use crate::raster::MAX_SIZE;
use crate::real;
use crate::real::Real;
use crate::shadow::shadow_map::shadow_pages as paged;
use crate::shadow::virtual_map::{self, Pixels};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicU8, Ordering};

#[pyfunction]
pub fn shadow_pages(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    seen: Seen,
    size: [usize; 2],
    table: &Bound<'_, PyAny>,
    bits: u32,
    progress: Option<Py<PyAny>>,
    pages: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let view = view(seen);
    let (faces, table) = (In::<i32>::of("faces", faces)?, In::<i32>::of("table", table)?);
    real!(pages, T => {
        let positions = In::<T>::of("positions", positions)?;
        let mut pages = Out::<T>::of("pages", pages)?;
        let (p, f, table, pages) = (positions.items()?, faces.items()?, table.slice()?, pages.slice()?);
        let side = 1usize << bits.min(20);
        let fits = (6..=14).contains(&bits)
            && size.iter().all(|&n| n <= MAX_SIZE && n > 0 && n % side == 0)
            && table.len() == (size[0] >> bits) * (size[1] >> bits)
            && table.iter().all(|&slot| slot < 0 || (slot as usize) < pages.len() >> (2 * bits))
            && f.iter().flatten().all(|&k| k >= 0 && (k as usize) < p.len());
        let mut taken = vec![false; pages.len() >> (2 * bits.min(14))];
        // No two pages of the map may lie in one place.
        let apart = fits && table.iter().all(|&s| s < 0 || !std::mem::replace(&mut taken[s as usize], true));
        if !apart {
            return Err(PyValueError::new_err("table, faces or pages: out of range"));
        }
        run(py, progress, |watch| paged(watch, p, f, &view, size, (table, bits), pages))
    })
}

/// The level that each receiver asks for: of a map, the view's eye and its pixel at unit distance.
#[pyfunction]
pub fn page_levels(
    py: Python<'_>,
    chart: Chart<'_>,
    receivers: &Bound<'_, PyAny>,
    pixels: ([f64; 3], f64),
    count: usize,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    use virtual_map::levels as kernel;
    let (eye, size) = pixels;
    let (pixels, mut out) = (Pixels { eye, size }, Out::<u8>::of("out", out)?);
    real!(receivers, T => {
        let (held, points) = (chart.held::<T>()?, In::<T>::of("receivers", receivers)?);
        let (map, p, out) = (held.map()?, points.items()?, out.slice()?);
        run(py, None, |watch| by_projection!(chart.2, T, kernel, (watch, &map, p, &pixels, count, out)))
    })
}

/// The pages of a level that its receivers read, as bytes that are 1.
#[pyfunction]
pub fn page_marks(
    py: Python<'_>,
    chart: Chart<'_>,
    receivers: &Bound<'_, PyAny>,
    border: f64,
    bits: u32,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    use virtual_map::mark as kernel;
    let mut out = Out::<u8>::of("out", out)?;
    let out = out.slice()?;
    let marks: Vec<AtomicU8> = out.iter().map(|&m| AtomicU8::new(m)).collect();
    real!(receivers, T => {
        let (held, points) = (chart.held::<T>()?, In::<T>::of("receivers", receivers)?);
        let (map, p) = (held.map()?, points.items()?);
        let [width, height] = map.size();
        if bits > 14 || marks.len() != width.div_ceil(1 << bits) * height.div_ceil(1 << bits) {
            return Err(PyValueError::new_err("out: does not fit the map"));
        }
        let border = T::of(border);
        run(py, None, |watch| by_projection!(chart.2, T, kernel, (watch, &map, p, border, bits, &marks)))?;
    });
    for (to, mark) in out.iter_mut().zip(&marks) {
        *to = mark.load(Ordering::Relaxed);
    }
    Ok(())
}

/// Sends receivers of a level whose page is not there on to the next.
#[pyfunction]
pub fn page_settle(
    py: Python<'_>,
    chart: Chart<'_>,
    receivers: &Bound<'_, PyAny>,
    next: u8,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    use virtual_map::settle as kernel;
    let mut out = Out::<u8>::of("out", out)?;
    real!(receivers, T => {
        let (held, points) = (chart.held::<T>()?, In::<T>::of("receivers", receivers)?);
        let (map, p, out) = (held.map()?, points.items()?, out.slice()?);
        run(py, None, |watch| by_projection!(chart.2, T, kernel, (watch, &map, p, next, out)))
    })
}
