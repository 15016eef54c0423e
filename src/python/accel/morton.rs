//! Bindings of Morton order: morton_encode, morton_decode, radix_tree.

use crate::accel::morton::{self, RadixNode};
use crate::parallel;
use crate::python::array::{In, Out, run};
use pyo3::prelude::*;

/// `cells` (n, 3), `codes` (n,), both uint64.
#[pyfunction]
pub fn morton_encode(py: Python<'_>, cells: &Bound<'_, PyAny>, codes: &Bound<'_, PyAny>) -> PyResult<()> {
    let (cells, mut codes) = (In::<u64>::of("cells", cells)?, Out::<u64>::of("codes", codes)?);
    let (cells, codes) = (cells.items::<3>()?, codes.slice()?);
    run(py, None, |watch| {
        parallel::for_each(watch, (cells, codes), 1 << 14, |_, (cells, codes): (&[[u64; 3]], &mut [u64])| {
            for (code, &cell) in codes.iter_mut().zip(cells) {
                *code = morton::encode(cell);
            }
        })
    })
}

#[pyfunction]
pub fn morton_decode(py: Python<'_>, codes: &Bound<'_, PyAny>, cells: &Bound<'_, PyAny>) -> PyResult<()> {
    let (codes, mut cells) = (In::<u64>::of("codes", codes)?, Out::<u64>::of("cells", cells)?);
    let (codes, cells) = (codes.slice()?, cells.items::<3>()?);
    run(py, None, |watch| {
        parallel::for_each(watch, (codes, cells), 1 << 14, |_, (codes, cells): (&[u64], &mut [[u64; 3]])| {
            for (cell, &code) in cells.iter_mut().zip(codes) {
                *cell = morton::decode(code);
            }
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
