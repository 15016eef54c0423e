//! Bindings of Morton order: morton_encode, morton_decode, radix_tree.

use crate::accel::morton::{self, RadixNode};
use crate::dispatch;
use crate::parallel;
use crate::python::array::{In, Out, run};
use crate::real;
use crate::real::Real;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `cells` (n, 3), `codes` (n,), both uint64.
#[pyfunction]
pub fn morton_encode(py: Python<'_>, cells: &Bound<'_, PyAny>, codes: &Bound<'_, PyAny>) -> PyResult<()> {
    let (cells, mut codes) = (In::<u64>::of("cells", cells)?, Out::<u64>::of("codes", codes)?);
    let (cells, codes) = (cells.items::<3>()?, codes.slice()?);
    run(py, None, |watch| {
        parallel::for_each(watch, (cells, codes), 1 << 14, |_, (cells, codes): (&[[u64; 3]], &mut [u64])| {
            dispatch!(_s => for (code, &cell) in codes.iter_mut().zip(cells) {
                *code = morton::encode(cell);
            })
        })
    })
}

/// `points` (n, 3) in the box `lower` to `upper` of `side` cells an axis; gives the first point that is not in it.
#[pyfunction]
pub fn morton_encode_points(
    py: Python<'_>,
    points: &Bound<'_, PyAny>,
    lower: [f64; 3],
    upper: [f64; 3],
    side: u64,
    codes: &Bound<'_, PyAny>,
) -> PyResult<Option<usize>> {
    // Halves, so that no extent overflows.
    let half = [0, 1, 2].map(|k| upper[k] * 0.5 - lower[k] * 0.5);
    let outside = AtomicUsize::new(usize::MAX);
    real!(points, T => {
        let (points, mut codes) = (In::<T>::of("points", points)?, Out::<u64>::of("codes", codes)?);
        let (points, codes) = (points.items::<3>()?, codes.slice()?);
        run(py, None, |watch| {
            parallel::for_each(watch, (points, codes), 1 << 14, |start, (points, codes): (&[[T; 3]], &mut [u64])| {
                let inside = dispatch!(_s => {
                    let mut inside = true;
                    for (code, p) in codes.iter_mut().zip(points) {
                        let p = [p[0].to_f64(), p[1].to_f64(), p[2].to_f64()];
                        inside &= morton::within(p, lower, upper);
                        *code = morton::encode(morton::cell(p, lower, half, side));
                    }
                    inside
                });
                if !inside {
                    let p = |p: &[T; 3]| [p[0].to_f64(), p[1].to_f64(), p[2].to_f64()];
                    let at = points.iter().position(|q| !morton::within(p(q), lower, upper)).unwrap_or(0);
                    outside.fetch_min(start + at, Ordering::Relaxed);
                }
            })
        })
    })?;
    let at = outside.into_inner();
    Ok((at != usize::MAX).then_some(at))
}

#[pyfunction]
pub fn morton_decode(py: Python<'_>, codes: &Bound<'_, PyAny>, cells: &Bound<'_, PyAny>) -> PyResult<()> {
    let (codes, mut cells) = (In::<u64>::of("codes", codes)?, Out::<u64>::of("cells", cells)?);
    let (codes, cells) = (codes.slice()?, cells.items::<3>()?);
    run(py, None, |watch| {
        parallel::for_each(watch, (codes, cells), 1 << 14, |_, (codes, cells): (&[u64], &mut [[u64; 3]])| {
            dispatch!(_s => for (cell, &code) in cells.iter_mut().zip(codes) {
                *cell = morton::decode(code);
            })
        })
    })
}

/// `out`: (n - 1, 4) first, last, left, right.
#[pyfunction]
pub fn radix_tree(py: Python<'_>, codes: &Bound<'_, PyAny>, out: &Bound<'_, PyAny>) -> PyResult<()> {
    let (codes, mut out) = (In::<u64>::of("codes", codes)?, Out::<i32>::of("out", out)?);
    let (codes, out) = (codes.slice()?, out.items::<4>()?);
    run(py, None, |watch| {
        parallel::for_each(watch, out, 1 << 12, |start, out: &mut [[i32; 4]]| {
            for (i, out) in out.iter_mut().enumerate() {
                let RadixNode { first, last, left, right } = morton::radix_node(codes, start + i);
                *out = [first as i32, last as i32, left as i32, right as i32];
            }
        })
    })
}
