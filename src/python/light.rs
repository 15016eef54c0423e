//! Bindings of `light`.

use crate::brdf::metallic_roughness::Materials;
use crate::light::Light;
use crate::light::rect::Rect;
use crate::light::unshadowed::{Receivers, Viewer};
use crate::python::array::In;
use crate::real::Real;
use crate::vec::Vec3;
use numpy::Element;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Lights from the rows that `shadelab.light` packs: kind, three vectors, colour, two_sided.
pub fn lights<T: Real>(table: &Bound<'_, PyAny>) -> PyResult<Vec<Light<T>>> {
    let table = In::<f64>::of("lights", table)?;
    table.items::<14>()?.iter().map(light).collect()
}

fn light<T: Real>(row: &[f64; 14]) -> PyResult<Light<T>> {
    let vector = |at: usize| Vec3::new(row[at], row[at + 1], row[at + 2]);
    let rounded = |v: Vec3<f64>| v.map(T::of);
    let color = rounded(vector(10));
    match row[0] as i32 {
        0 => Ok(Light::Point { position: rounded(vector(1)), intensity: color }),
        1 => Ok(Light::Directional { direction: rounded(vector(1).normalize()), irradiance: color }),
        2 => {
            let [center, u, v] = [1, 4, 7].map(|at| rounded(vector(at)));
            Ok(Light::Rect(Rect::new(center, u, v, color, row[13] != 0.0)))
        }
        kind => Err(PyValueError::new_err(format!("lights: unknown kind {kind}"))),
    }
}

/// The one rectangle of a table.
fn rectangle<T: Real>(table: &Bound<'_, PyAny>) -> PyResult<Rect<T>> {
    match lights(table)?.first() {
        Some(Light::Rect(rect)) => Ok(*rect),
        _ => Err(PyValueError::new_err("light: expected a RectLight")),
    }
}

/// The arrays of receivers, held while a kernel reads them.
pub struct ReceiverArrays<'py, T: Element> {
    points: In<'py, T>,
    normals: In<'py, T>,
    /// One row: the eye's position; else directions to it.
    viewer: In<'py, T>,
    is_eye: bool,
    material_ids: Option<In<'py, i32>>,
    base_color: In<'py, T>,
    metallic: In<'py, T>,
    roughness: In<'py, T>,
    specular: In<'py, T>,
}

/// What Python hands over: points, normals, viewer, base_color, metallic, roughness, specular.
pub type ReceiverTuple<'py> = [Bound<'py, PyAny>; 7];

impl<'py, T: Real + Element> ReceiverArrays<'py, T> {
    pub fn of(
        [points, normals, viewer, base_color, metallic, roughness, specular]: &ReceiverTuple<'py>,
        is_eye: bool,
        material_ids: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        Ok(ReceiverArrays {
            points: In::of("points", points)?,
            normals: In::of("normals", normals)?,
            viewer: In::of("wo", viewer)?,
            is_eye,
            material_ids: material_ids.map(|ids| In::of("material_ids", ids)).transpose()?,
            base_color: In::of("base_color", base_color)?,
            metallic: In::of("metallic", metallic)?,
            roughness: In::of("roughness", roughness)?,
            specular: In::of("specular", specular)?,
        })
    }
    pub fn get(&self) -> PyResult<Receivers<'_, T>> {
        let viewer = self.viewer.items()?;
        Ok(Receivers {
            points: self.points.items()?,
            normals: self.normals.items()?,
            viewer: if self.is_eye { Viewer::Eye(viewer[0].into()) } else { Viewer::Directions(viewer) },
            material_ids: self.material_ids.as_ref().map(|ids| ids.slice()).transpose()?,
            materials: Materials {
                base_color: self.base_color.items()?,
                metallic: self.metallic.slice()?,
                roughness: self.roughness.slice()?,
                specular: self.specular.slice()?,
            },
        })
    }
}

#[pymodule]
pub mod light {
    use super::{ReceiverArrays, ReceiverTuple, double_corners, lights, rectangle};
    use crate::light::{irradiance as received, polygon, rect, unshadowed as direct};
    use crate::python::array::{In, Out, run};
    use crate::real;
    use pyo3::prelude::*;

    /// Moments 0 … 6 of the polygon `corners` (doubles).
    #[pyfunction]
    fn polygon_moments(
        py: Python<'_>,
        corners: &Bound<'_, PyAny>,
        points: &Bound<'_, PyAny>,
        normals: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let corners = double_corners(corners)?;
        real!(out, T => {
            let (p, n) = (In::<T>::of("points", points)?, In::<T>::of("normals", normals)?);
            let mut out = Out::<T>::of("out", out)?;
            let (p, n, out) = (p.items()?, n.items()?, out.items()?);
            run(py, None, |watch| polygon::polygon_moments_many(watch, &corners, p, n, out))
        })
    }

    #[pyfunction]
    fn irradiance(
        py: Python<'_>,
        light: &Bound<'_, PyAny>,
        points: &Bound<'_, PyAny>,
        normals: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(out, T => {
            let light = lights::<T>(light)?[0];
            let (p, n) = (In::<T>::of("points", points)?, In::<T>::of("normals", normals)?);
            let mut out = Out::<T>::of("out", out)?;
            let (p, n, out) = (p.items()?, n.items()?, out.items()?);
            run(py, None, |watch| received::irradiance_many(watch, &light, p, n, out))
        })
    }

    #[pyfunction]
    fn rect_sample(
        py: Python<'_>,
        light: &Bound<'_, PyAny>,
        points: &Bound<'_, PyAny>,
        u: &Bound<'_, PyAny>,
        out: [Bound<'_, PyAny>; 3],
    ) -> PyResult<()> {
        real!(points, T => {
            let light = rectangle::<T>(light)?;
            let (p, u) = (In::<T>::of("points", points)?, In::<T>::of("u", u)?);
            let [wi, distance, pdf] = &out;
            let (mut wi, mut distance) = (Out::<T>::of("wi", wi)?, Out::<T>::of("distance", distance)?);
            let mut pdf = Out::<T>::of("pdf", pdf)?;
            let (p, u, wi, distance, pdf) = (p.items()?, u.items()?, wi.items()?, distance.slice()?, pdf.slice()?);
            run(py, None, |watch| rect::rect_sample_many(watch, light, p, u, wi, distance, pdf))
        })
    }

    #[pyfunction]
    fn rect_pdf(
        py: Python<'_>,
        light: &Bound<'_, PyAny>,
        points: &Bound<'_, PyAny>,
        wi: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(out, T => {
            let light = rectangle::<T>(light)?;
            let (p, wi) = (In::<T>::of("points", points)?, In::<T>::of("wi", wi)?);
            let mut out = Out::<T>::of("out", out)?;
            let (p, wi, out) = (p.items()?, wi.items()?, out.slice()?);
            run(py, None, |watch| rect::rect_pdf_many(watch, light, p, wi, out))
        })
    }

    #[pyfunction]
    fn unshadowed(
        py: Python<'_>,
        receivers: ReceiverTuple<'_>,
        is_eye: bool,
        material_ids: Option<&Bound<'_, PyAny>>,
        light_table: &Bound<'_, PyAny>,
        samples: u32,
        seed: u64,
        out: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        real!(out, T => {
            let (lights, arrays) = (lights::<T>(light_table)?, ReceiverArrays::<T>::of(&receivers, is_eye, material_ids)?);
            let receivers = arrays.get()?;
            let mut out = Out::<T>::of("out", out)?;
            let out = out.items()?;
            run(py, progress, |watch| direct::unshadowed_many(watch, &receivers, &lights, samples, seed, out))
        })
    }
}

fn double_corners(corners: &Bound<'_, PyAny>) -> PyResult<Vec<Vec3<f64>>> {
    Ok(In::<f64>::of("corners", corners)?.items()?.iter().map(|&c| c.into()).collect())
}
