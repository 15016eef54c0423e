//! Bindings of lines: line_line, segment_segment.

use crate::elementwise;
use crate::geometry as kernels;
use crate::python::array::Arrays;
use pyo3::prelude::*;

/// `out`: s, t, distance, both points, whether the lines are parallel.
#[pyfunction]
pub fn line_line(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |o1: [T; 3], d1: [T; 3], o2: [T; 3], d2: [T; 3]|
        -> (s: [T; 1], t: [T; 1], distance: [T; 1], p: [T; 3], q: [T; 3], parallel: [bool; 1]) {
            let x = kernels::line_line::line_line([o1.into(), d1.into()], [o2.into(), d2.into()]);
            let [p, q] = x.points;
            ([x.s], [x.t], [x.distance], p.to_array(), q.to_array(), [x.parallel])
        }
    )
}

/// `out`: s, t, distance, both points, whether the segments are parallel.
#[pyfunction]
pub fn segment_segment(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
        |a: [T; 3], b: [T; 3], c: [T; 3], d: [T; 3]|
        -> (s: [T; 1], t: [T; 1], distance: [T; 1], p: [T; 3], q: [T; 3], parallel: [bool; 1]) {
            let x = kernels::segment_segment::segment_segment([a.into(), b.into()], [c.into(), d.into()]);
            let [p, q] = x.points;
            ([x.s], [x.t], [x.distance], p.to_array(), q.to_array(), [x.parallel])
        }
    )
}
