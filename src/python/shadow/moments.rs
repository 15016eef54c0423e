//! Bindings of `shadow`: maps of moments, the bounds, and lookups by them.

use super::Chart;
use crate::elementwise;
use crate::python::array::{Arrays, In, Out, run, unknown};
use crate::real;
use crate::real::Real;
use crate::shadow::exponential_variance::exponential_bound;
use crate::shadow::filtered::{Filtered, Level};
use crate::shadow::moment::{self, Support};
use crate::shadow::moment_map::{Basis, Stored, Warp, moment_map as build, quantize};
use crate::shadow::tested::{Granted, Test, lookup};
use crate::shadow::variance;
use crate::shadow::variance_soft::variance_soft as soft;
use numpy::Element;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

fn support(name: &str) -> PyResult<Support> {
    match name {
        "hamburger" => Ok(Support::Hamburger),
        "hausdorff" => Ok(Support::Hausdorff),
        other => Err(unknown("support", other)),
    }
}

/// Kind, exponents (the second 0 for none).
type Kind<'a> = (&'a str, [f64; 2]);

fn basis<T: Real>((kind, [a, b]): Kind<'_>) -> PyResult<Basis<T>> {
    Ok(match kind {
        "variance" => Basis::Powers2,
        "moment" => Basis::Powers4,
        "exponential_variance" if b > 0.0 => Basis::Exponentials(T::of(a), T::of(b)),
        "exponential_variance" => Basis::Exponential(T::of(a)),
        other => return Err(unknown("kind", other)),
    })
}

/// Middle and scale of depth.
type Range = [f64; 2];

fn warp<T: Real>([middle, per]: Range) -> Warp<T> {
    Warp { middle: T::of(middle), per: T::of(per) }
}

#[pyfunction]
pub fn moment_map(
    py: Python<'_>,
    depth: &Bound<'_, PyAny>,
    kind: Kind<'_>,
    range: Range,
    reduce: usize,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(depth, T => {
        let (depth, mut out) = (In::<T>::of("depth", depth)?, Out::<T>::of("out", out)?);
        let basis = basis::<T>(kind)?;
        let &[height, width] = depth.shape() else {
            return Err(PyValueError::new_err("depth: expected shape (H, W)"));
        };
        let sides = [height, width].map(|n| n.div_ceil(reduce.max(1)));
        if reduce == 0 || out.shape() != [sides[0], sides[1], basis.channels()] {
            return Err(PyValueError::new_err("out: unexpected shape"));
        }
        let (d, out) = (depth.slice()?, out.slice()?);
        run(py, None, |watch| build(watch, d, [width, height], reduce, warp(range), basis, out))
    })
}

#[pyfunction]
pub fn moment_quantize(py: Python<'_>, moments: &Bound<'_, PyAny>, out: &Bound<'_, PyAny>) -> PyResult<()> {
    real!(moments, T => {
        let (moments, mut out) = (In::<T>::of("moments", moments)?, Out::<u16>::of("out", out)?);
        let (m, out) = (moments.slice()?, out.slice()?);
        crate::python::array::same_length(&[m.len(), out.len()])?;
        run(py, None, |watch| quantize(watch, m, out))
    })
}

#[pyfunction]
pub fn chebyshev_bound(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |mean: [T; 1], square: [T; 1], t: [T; 1], least: [T; 1]| -> (lit: [T; 1]) {
        [variance::chebyshev_bound(mean[0], square[0], t[0], least[0])]
    })
}

#[pyfunction]
pub fn exponential_variance(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out,
    |m: [T; 4], t: [T; 1], a: [T; 1], b: [T; 1], least: [T; 1]| -> (lit: [T; 1]) {
        let b = if b[0] > T::of(0.0) { Some(b[0]) } else { None };
        [exponential_bound(m, t[0], a[0], b, least[0])]
    })
}

#[pyfunction]
pub fn moment_bound(
    py: Python<'_>,
    method: &str,
    bias: [f64; 2],
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let support = support(method)?;
    elementwise!(py, given, out, |m: [T; 4], t: [T; 1]| -> (share: [T; 1]) {
        [moment::moment_bound(m, t[0], support, bias[0], bias[1])]
    })
}

/// Values, levels as (first, width, height), whether a table, texels of the depth map to a side of one, range of depth.
type Store<'py> = (Bound<'py, PyAny>, Vec<(usize, usize, usize)>, bool, usize, Range);
/// Kind; least variance, or alpha and its target; method.
type Asked<'a> = (Kind<'a>, [f64; 2], &'a str);
/// Constant, slope, normal offset, light bleeding.
type Bias = [f64; 4];

fn test<T: Real>(((kind, [a, b]), [x, y], method): Asked<'_>) -> PyResult<Test<T>> {
    Ok(match kind {
        "variance" => Test::Variance { least: T::of(x) },
        "moment" => Test::Moment { support: support(method)?, alpha: x, target: y },
        _ => {
            Test::Exponential { a: T::of(a), b: if b > 0.0 { Some(T::of(b)) } else { None }, least: T::of(x) }
        }
    })
}

fn granted<T: Real>([constant, slope, normal_offset, bleeding]: Bias) -> Granted<T> {
    Granted {
        constant: T::of(constant),
        slope: T::of(slope),
        normal_offset: T::of(normal_offset),
        bleeding: T::of(bleeding),
    }
}

/// A fixed half side in texels, or the sides of a light and the search's bias by slope.
#[derive(FromPyObject)]
pub enum Width {
    Half(f64),
    Light([f64; 3]),
}

/// Optional arrays: moments and depths, or blocker depth, penumbra and search.
type More<'py> = Option<Vec<Bound<'py, PyAny>>>;

#[pyfunction]
pub fn filtered<'py>(
    py: Python<'py>,
    chart: Chart<'py>,
    store: Store<'py>,
    receivers: &Bound<'py, PyAny>,
    normals: Option<&Bound<'py, PyAny>>,
    asked: Asked<'_>,
    bias: Bias,
    width: Width,
    out: &Bound<'py, PyAny>,
    more: More<'py>,
) -> PyResult<()> {
    let four = matches!(asked.0, ("moment", _)) || asked.0.1[1] > 0.0;
    let stored = store.0.getattr("dtype")?.getattr("name")?.extract::<String>()?;
    real!(receivers, T => {
        let call = Call { chart, receivers, normals, asked, bias, width, out, more };
        match (stored.as_str(), four) {
            ("float32", false) => call.run::<T, f32, 2>(py, store),
            ("float32", true) => call.run::<T, f32, 4>(py, store),
            ("float64", false) => call.run::<T, f64, 2>(py, store),
            ("float64", true) => call.run::<T, f64, 4>(py, store),
            ("uint16", true) => call.run::<T, u16, 4>(py, store),
            (other, _) => Err(unknown("moments", other)),
        }
    })
}

struct Call<'a, 'py> {
    chart: Chart<'py>,
    receivers: &'a Bound<'py, PyAny>,
    normals: Option<&'a Bound<'py, PyAny>>,
    asked: Asked<'a>,
    bias: Bias,
    width: Width,
    out: &'a Bound<'py, PyAny>,
    more: More<'py>,
}

impl<'py> Call<'_, 'py> {
    fn run<T: Real + Element, E: Stored + Element, const C: usize>(
        &self,
        py: Python<'py>,
        (values, levels, table, reduce, range): Store<'py>,
    ) -> PyResult<()> {
        let (held, points) = (self.chart.held::<T>()?, In::<T>::of("receivers", self.receivers)?);
        let normals = self.normals.map(|n| In::<T>::of("normals", n)).transpose()?;
        let values = In::<E>::of("moments", &values)?;
        let levels =
            levels.into_iter().map(|(first, width, height)| Level { first, width, height }).collect();
        let filtered = Filtered::<T, E, C>::new(values.items()?, levels, table, reduce, warp(range))
            .ok_or_else(|| PyValueError::new_err("moments: sizes do not fit"))?;
        let (map, test, granted) = (held.map()?, test::<T>(self.asked)?, granted(self.bias));
        let mut out = Out::<T>::of("out", self.out)?;
        let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
        let out = out.slice()?;
        let mut more = Vec::new();
        for array in self.more.iter().flatten() {
            more.push(Out::<T>::of("more", array)?);
        }
        let perspective = self.chart.2;
        match self.width {
            Width::Half(half) => {
                let more = match &mut more[..] {
                    [moments, t] => Some((moments.items()?, t.slice()?)),
                    _ => None,
                };
                run(py, None, |watch| {
                    let half = T::of(half);
                    lookup(watch, &map, perspective, &filtered, p, n, &test, &granted, half, out, more)
                })
            }
            Width::Light([u, v, slope]) => {
                let more = match &mut more[..] {
                    [a, b, c] => Some((a.slice()?, b.slice()?, c.slice()?)),
                    _ => None,
                };
                let (light, slope) = ([u, v].map(T::of), T::of(slope));
                run(py, None, |watch| {
                    soft(watch, &map, perspective, &filtered, p, n, &test, &granted, light, slope, out, more)
                })
            }
        }
    }
}
