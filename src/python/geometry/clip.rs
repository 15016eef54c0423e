//! Bindings of clipping: clip_segment, clip_polygon, clip_homogeneous.

use super::frustum::depth_named;
use crate::elementwise;
use crate::geometry::clip_homogeneous::{borders, clip_homogeneous as clip_to_borders, region, settle};
use crate::geometry::clip_polygon::{Polygon, clip_to_planes, clip_to_window, turning};
use crate::geometry::clip_segment::{self as segments, Method};
use crate::parallel::{self, Rows};
use crate::python::array::{Arrays, In, Out, first, run};
use crate::real::Real;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

fn method_named(name: &str) -> PyResult<Method> {
    match name {
        "cohen_sutherland" => Ok(Method::CohenSutherland),
        "liang_barsky" => Ok(Method::LiangBarsky),
        _ => Err(PyValueError::new_err(format!("method: unknown, got {name:?}"))),
    }
}

#[pyfunction]
pub fn clip_segment_2(py: Python<'_>, method: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let method = method_named(method)?;
    elementwise!(py, given, out, |p: [T; 2], q: [T; 2], low: [T; 2], high: [T; 2]|
        -> (hit: [bool; 1], start: [T; 2], end: [T; 2], t: [T; 2], codes: [u8; 2]) {
        let c = segments::clip_segment(method, p, q, [low, high]);
        ([c.hit], c.ends[0], c.ends[1], c.t, c.codes)
    })
}

#[pyfunction]
pub fn clip_segment_3(py: Python<'_>, method: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let method = method_named(method)?;
    elementwise!(py, given, out, |p: [T; 3], q: [T; 3], low: [T; 3], high: [T; 3]|
        -> (hit: [bool; 1], start: [T; 3], end: [T; 3], t: [T; 2], codes: [u8; 2]) {
        let c = segments::clip_segment(method, p, q, [low, high]);
        ([c.hit], c.ends[0], c.ends[1], c.t, c.codes)
    })
}

/// Writes a clipped polygon into its slots as far as they go, the rest NaN; gives its number of corners.
fn write<T: Real>(polygon: &Polygon, out: &mut [T]) -> i32 {
    let kept = polygon.rows.len().min(out.len());
    for (out, &x) in out.iter_mut().zip(&polygon.rows) {
        *out = T::of(x);
    }
    out[kept..].fill(T::NAN);
    polygon.corners() as i32
}

/// `sizes`: dimension, corners, borders, slots. `given`: polygons of `corners` points, and windows of `borders` points or planes. `out`: corners in `slots`, NaN behind
/// them, and their counts, which may exceed the slots; -1 where the window is none, or a number is NaN.
#[pyfunction]
pub fn clip_polygon(
    py: Python<'_>,
    sizes: [usize; 4],
    given: Arrays<'_>,
    out: Bound<'_, PyAny>,
    count: Bound<'_, PyAny>,
) -> PyResult<()> {
    let [dimension, corners, borders, slots] = sizes;
    let [_, window] = &given[..] else { return Err(PyValueError::new_err("expected two arrays")) };
    crate::real!(first(&given)?, T => {
        let (polygons, windows) = (In::<T>::of("polygon", &given[0])?, In::<T>::of("window", window)?);
        let (mut out, mut count) = (Out::<T>::of("out", &out)?, Out::<i32>::of("count", &count)?);
        let (polygons, windows, count) = (polygons.slice()?, windows.slice()?, count.slice()?);
        let out = Rows { data: out.slice()?, width: slots * dimension };
        let per_window = borders * if dimension == 2 { 2 } else { 4 };
        let per_polygon = corners * dimension;
        if polygons.len() != per_polygon * count.len() || windows.len() != per_window * count.len() {
            return Err(PyValueError::new_err("expected arrays of one length"));
        }
        run(py, None, |watch| parallel::for_each(watch, (out, count), 256, |start, (out, count)| {
            let mut polygon = Polygon::default();
            for (k, count) in count.iter_mut().enumerate() {
                let i = start + k;
                let rows = &polygons[i * per_polygon..(i + 1) * per_polygon];
                let window: Vec<f64> =
                    windows[i * per_window..(i + 1) * per_window].iter().map(|x| x.to_f64()).collect();
                let mut proper = polygon.load(dimension, rows.iter().map(|x| x.to_f64()));
                proper &= window.iter().all(|x| x.is_finite());
                if proper && dimension == 2 {
                    let (window, _) = window.as_chunks::<2>();
                    match turning(window) {
                        Some(sense) => clip_to_window(&mut polygon, window, sense),
                        None => proper = false,
                    }
                } else if proper {
                    clip_to_planes(&mut polygon, window.as_chunks::<4>().0);
                }
                if !proper {
                    polygon.load(dimension, [].into_iter());
                }
                let n = write(&polygon, &mut out.data[k * out.width..(k + 1) * out.width]);
                *count = if proper { n } else { -1 };
            }
        }))
    })
}

/// `sizes`: width, corners, slots. `polygons`: rows of four coordinates and attributes, `width` in all; `wanted`: bits of the borders. `out` and `count` as
/// of [`clip_polygon`]; `codes`: the regions of the corners given.
#[pyfunction]
pub fn clip_homogeneous(
    py: Python<'_>,
    depth: &str,
    wanted: u8,
    sizes: [usize; 3],
    polygons: Bound<'_, PyAny>,
    out: Bound<'_, PyAny>,
    count: Bound<'_, PyAny>,
    codes: Bound<'_, PyAny>,
) -> PyResult<()> {
    let [width, corners, slots] = sizes;
    let borders = borders(depth_named(depth)?);
    crate::real!(&polygons, T => {
        let polygons = In::<T>::of("polygon", &polygons)?;
        let (mut out, mut count, mut codes) =
            (Out::<T>::of("out", &out)?, Out::<i32>::of("count", &count)?, Out::<u8>::of("codes", &codes)?);
        let (polygons, count) = (polygons.slice()?, count.slice()?);
        let out = Rows { data: out.slice()?, width: slots * width };
        let codes = Rows { data: codes.slice()?, width: corners };
        let per_polygon = corners * width;
        if polygons.len() != per_polygon * count.len() || width < 4 {
            return Err(PyValueError::new_err("expected arrays of one length"));
        }
        run(py, None, |watch| parallel::for_each(watch, (out, count, codes), 256, |start, (out, count, codes)| {
            let mut polygon = Polygon::default();
            for (k, count) in count.iter_mut().enumerate() {
                let i = start + k;
                let rows = &polygons[i * per_polygon..(i + 1) * per_polygon];
                let proper = polygon.load(width, rows.iter().map(|x| x.to_f64()));
                let codes = &mut codes.data[k * corners..(k + 1) * corners];
                for (code, p) in codes.iter_mut().zip(polygon.rows.chunks_exact(width)) {
                    *code = region(&borders, p);
                }
                if proper {
                    clip_to_borders(&mut polygon, &borders, wanted);
                    for p in polygon.rows.chunks_exact_mut(width) {
                        for x in &mut *p {
                            *x = T::of(*x).to_f64();
                        }
                        settle(&borders, wanted, p);
                    }
                } else {
                    polygon.load(width, [].into_iter());
                }
                let n = write(&polygon, &mut out.data[k * out.width..(k + 1) * out.width]);
                *count = if proper { n } else { -1 };
            }
        }))
    })
}
