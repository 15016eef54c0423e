//! Bindings of polygons: point_in_polygon, ray_polygon, signed_area, sort_by_angle. Polygons of equal size come as one
//! array, a single one for all elements or one for each.

use crate::geometry as kernels;
use crate::geometry::point_in_polygon::Rule;
use crate::parallel::for_each;
use crate::python::array::{Arrays, In, Out, first, next, run, same_length, unknown};
use crate::real;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

struct Polygons<'a, I> {
    vertices: &'a [I],
    corners: usize,
    shared: bool,
}

impl<'a, I> Polygons<'a, I> {
    /// For `n` elements, each of as many corners.
    fn of(vertices: &'a [I], corners: usize, n: usize) -> PyResult<Self> {
        let shared = vertices.len() == corners;
        if corners == 0 || !(shared || vertices.len() == n * corners) {
            return Err(PyValueError::new_err("expected one polygon, or one for each element"));
        }
        Ok(Self { vertices, corners, shared })
    }
    fn get(&self, i: usize) -> &'a [I] {
        let start = if self.shared { 0 } else { i * self.corners };
        &self.vertices[start..start + self.corners]
    }
    /// Elements for a task of some milliseconds.
    fn piece(&self) -> usize {
        (1 << 18) / self.corners
    }
}

fn rule(name: &str) -> PyResult<Rule> {
    match name {
        "even_odd" => Ok(Rule::EvenOdd),
        "winding" => Ok(Rule::Winding),
        _ => Err(unknown("rule", name)),
    }
}

/// `given`: points, polygons; `out`: inside (as the rule says, the border not), on the border, winding, crossings.
#[pyfunction]
pub fn point_in_polygon(
    py: Python<'_>,
    rule_name: &str,
    corners: usize,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let rule = rule(rule_name)?;
    real!(first(&given)?, T => {
        let (mut given, mut out) = (given.iter(), out.iter());
        let points = In::<T>::of("points", next(&mut given)?)?;
        let polygons = In::<T>::of("polygon", next(&mut given)?)?;
        let mut inside = Out::<bool>::of("inside", next(&mut out)?)?;
        let mut border = Out::<bool>::of("on_border", next(&mut out)?)?;
        let mut winding = Out::<i32>::of("winding", next(&mut out)?)?;
        let mut crossings = Out::<i32>::of("crossings", next(&mut out)?)?;
        let points = points.items::<2>()?;
        let polygons = Polygons::of(polygons.items::<2>()?, corners, points.len())?;
        let out = (inside.slice()?, border.slice()?, winding.slice()?, crossings.slice()?);
        same_length(&[points.len(), out.0.len(), out.1.len(), out.2.len(), out.3.len()])?;
        run(py, None, |watch| {
            for_each(watch, (points, out), polygons.piece(), |start, (points, out)| {
                for (i, &p) in points.iter().enumerate() {
                    let place = kernels::point_in_polygon::point_in_polygon(p, polygons.get(start + i));
                    (out.0[i], out.1[i]) = (place.inside(rule), place.on_border);
                    (out.2[i], out.3[i]) = (place.winding, place.crossings);
                }
            })
        })
    })
}

/// `given`: origins, directions, t_min, t_max, polygons; `out`: t, normal, on the border, winding, crossings.
#[pyfunction]
pub fn ray_polygon(
    py: Python<'_>,
    rule_name: &str,
    corners: usize,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let rule = rule(rule_name)?;
    real!(first(&given)?, T => {
        let (mut given, mut out) = (given.iter(), out.iter());
        let origins = In::<T>::of("origins", next(&mut given)?)?;
        let directions = In::<T>::of("directions", next(&mut given)?)?;
        let low = In::<T>::of("t_min", next(&mut given)?)?;
        let high = In::<T>::of("t_max", next(&mut given)?)?;
        let polygons = In::<T>::of("polygon", next(&mut given)?)?;
        let mut t = Out::<T>::of("t", next(&mut out)?)?;
        let mut normal = Out::<T>::of("normal", next(&mut out)?)?;
        let mut border = Out::<bool>::of("on_border", next(&mut out)?)?;
        let mut winding = Out::<i32>::of("winding", next(&mut out)?)?;
        let mut crossings = Out::<i32>::of("crossings", next(&mut out)?)?;
        let (origins, directions) = (origins.items::<3>()?, directions.items::<3>()?);
        let (low, high) = (low.slice()?, high.slice()?);
        let polygons = Polygons::of(polygons.items::<3>()?, corners, origins.len())?;
        let found = (t.slice()?, normal.items::<3>()?);
        let place = (border.slice()?, winding.slice()?, crossings.slice()?);
        same_length(&[origins.len(), directions.len(), low.len(), high.len(), found.0.len(), found.1.len()])?;
        same_length(&[origins.len(), place.0.len(), place.1.len(), place.2.len()])?;
        let rays = (origins, directions, low, high);
        run(py, None, |watch| {
            for_each(watch, (rays, found, place), polygons.piece(), |start, (rays, found, place)| {
                for i in 0..rays.0.len() {
                    let (o, d) = (rays.0[i].into(), rays.1[i].into());
                    let polygon = polygons.get(start + i);
                    let x = kernels::ray_polygon::ray_polygon(o, d, polygon, rule, rays.2[i], rays.3[i]);
                    (found.0[i], found.1[i]) = (x.t, x.normal.to_array());
                    (place.0[i], place.1[i], place.2[i]) = (x.place.on_border, x.place.winding, x.place.crossings);
                }
            })
        })
    })
}

#[pyfunction]
pub fn signed_area(
    py: Python<'_>,
    corners: usize,
    polygons: Bound<'_, PyAny>,
    out: Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(&polygons, T => {
        let polygons = In::<T>::of("polygons", &polygons)?;
        let mut out = Out::<T>::of("area", &out)?;
        let (vertices, out) = (polygons.items::<2>()?, out.slice()?);
        same_length(&[vertices.len(), corners * out.len()])?;
        let piece = (1 << 18) / corners.max(1);
        run(py, None, |watch| {
            for_each(watch, out, piece, |start, out| {
                for (i, area) in out.iter_mut().enumerate() {
                    let polygon = &vertices[(start + i) * corners..(start + i + 1) * corners];
                    *area = kernels::signed_area::signed_area(polygon);
                }
            })
        })
    })
}

/// `given`: sets of points, centres; `out`: indices.
#[pyfunction]
pub fn sort_by_angle(
    py: Python<'_>,
    size: usize,
    given: [Bound<'_, PyAny>; 2],
    out: Bound<'_, PyAny>,
) -> PyResult<()> {
    real!(&given[0], T => {
        let (points, centers) = (In::<T>::of("points", &given[0])?, In::<T>::of("center", &given[1])?);
        let mut out = Out::<i64>::of("order", &out)?;
        let (points, centers, out) = (points.items::<2>()?, centers.items::<2>()?, out.slice()?);
        same_length(&[points.len(), size * centers.len(), out.len()])?;
        if size == 0 {
            return Ok(());
        }
        let mut sets: Vec<&mut [i64]> = out.chunks_mut(size).collect();
        run(py, None, |watch| {
            for_each(watch, (&mut sets[..], centers), (1 << 14) / size, |start, (sets, centers)| {
                for (i, order) in sets.iter_mut().enumerate() {
                    let points = &points[(start + i) * size..(start + i + 1) * size];
                    kernels::sort_by_angle::sort_by_angle(points, centers[i], order);
                }
            })
        })
    })
}
