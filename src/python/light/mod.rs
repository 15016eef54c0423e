//! Bindings of `light`.

mod ltc;
mod picture;
mod solid_angle;
mod tree;

use crate::brdf::metallic_roughness::Materials;
use crate::light::Light;
use crate::light::disk::Disk;
use crate::light::polygon_light::PolygonLight;
use crate::light::rect::Rect;
use crate::light::sphere::Sphere;
use crate::light::spot::Spot;
use crate::light::textured::Textured;
use crate::light::unshadowed::{Receivers, Viewer};
use crate::python::array::{In, unknown};
use crate::real::Real;
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;
use numpy::Element;
use picture::LightPicture;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Lights from the numbers that `shadelab.light` packs: kind, how many numbers follow, and these; and, if some show
/// pictures, a pair of the numbers and the pictures in both precisions.
pub fn lights<T: Real>(table: &Bound<'_, PyAny>) -> PyResult<Vec<Light<T>>> {
    let (table, shown) = match table.extract::<(Bound<'_, PyAny>, Vec<Bound<'_, PyAny>>)>() {
        Ok((numbers, shown)) => (numbers, shown),
        Err(_) => (table.clone(), Vec::new()),
    };
    let table = In::<f64>::of("lights", &table)?;
    let mut rest = table.slice()?;
    let (mut lights, mut shown) = (Vec::new(), shown.into_iter());
    while let [kind, count, values @ ..] = rest {
        let (own, others) =
            values.split_at_checked(*count as usize).ok_or_else(|| unknown("lights", "length"))?;
        let made = light(*kind as i32, own)?;
        lights.push(match made {
            Light::Rect(rect) if *kind == TEXTURED => {
                let source = shown.next().ok_or_else(|| unknown("lights", "picture"))?;
                // Asked for in the precision that is needed.
                let held = source.call1((T::DOUBLE,))?;
                Light::Textured(Textured::new(rect, held.cast::<LightPicture>()?.get().of::<T>()?))
            }
            made => made,
        });
        rest = others;
    }
    Ok(lights)
}

/// The kind of rectangles that show a picture.
const TEXTURED: f64 = 8.0;

/// The one light of a table.
pub fn one_light<T: Real>(table: &Bound<'_, PyAny>) -> PyResult<Light<T>> {
    lights(table)?.pop().ok_or_else(|| unknown("light", "nothing"))
}

fn light<T: Real>(kind: i32, numbers: &[f64]) -> PyResult<Light<T>> {
    let (vectors, rest) = numbers.as_chunks();
    let double = |i: usize| vectors.get(i).map_or(Vec3::splat(f64::NAN), |&v| Vec3::from(v));
    let vector = |i: usize| double(i).map(T::of);
    let unit = |i: usize| double(i).normalize().map(T::of);
    // What is left of thirds: radii, angles, whether both sides shine.
    let last = |i: usize| rest.get(i).copied().unwrap_or(0.0);
    Ok(match kind {
        0 => Light::Point { position: vector(1), intensity: vector(0) },
        1 => Light::Directional { direction: unit(1), irradiance: vector(0) },
        2 | 8 => Light::Rect(Rect::new(vector(1), vector(2), vector(3), vector(0), last(0) != 0.0)),
        3 => Light::Spot(Spot {
            position: vector(1),
            direction: unit(2),
            intensity: vector(0),
            inner: T::of(last(0)),
            outer: T::of(last(1)),
        }),
        4 => Light::Disk(Disk {
            center: vector(1),
            frame: Frame::about(unit(2)),
            radius: T::of(last(0)),
            radiance: vector(0),
            two_sided: last(1) != 0.0,
        }),
        5 => Light::Sphere(Sphere { center: vector(1), radius: T::of(last(0)), radiance: vector(0) }),
        6 => {
            let corners: Vec<_> = (1..vectors.len()).map(double).collect();
            let polygon = PolygonLight::new(&corners, vector(0), last(0) != 0.0);
            Light::Polygon(polygon.ok_or_else(|| {
                PyValueError::new_err("corners: expected a polygon that does not cross itself")
            })?)
        }
        7 => Light::Ambient { radiance: vector(0) },
        kind => return Err(unknown("lights", &format!("kind {kind}"))),
    })
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
    use super::{ReceiverArrays, ReceiverTuple, double_corners, lights, one_light};
    #[pymodule_export]
    use super::{
        ltc::{ltc_fit, ltc_light, ltc_shipped},
        picture::{LightPicture, light_picture},
        solid_angle::{polygon_solid_angle, solid_angle},
        tree::{chance, choose, chooser},
    };
    use crate::light::{irradiance as received, polygon, sample, unshadowed as direct};
    use crate::python::array::{In, Out, run, unknown};
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
            let light = one_light::<T>(light)?;
            let (p, n) = (In::<T>::of("points", points)?, In::<T>::of("normals", normals)?);
            let mut out = Out::<T>::of("out", out)?;
            let (p, n, out) = (p.items()?, n.items()?, out.items()?);
            run(py, None, |watch| received::irradiance_many(watch, &light, p, n, out))
        })
    }

    #[pyfunction]
    fn light_sample(
        py: Python<'_>,
        light: &Bound<'_, PyAny>,
        evenly: bool,
        points: &Bound<'_, PyAny>,
        u: &Bound<'_, PyAny>,
        out: [Bound<'_, PyAny>; 3],
    ) -> PyResult<()> {
        real!(points, T => {
            let light = one_light::<T>(light)?;
            let (p, u) = (In::<T>::of("points", points)?, In::<T>::of("u", u)?);
            let [wi, distance, pdf] = &out;
            let (mut wi, mut distance) = (Out::<T>::of("wi", wi)?, Out::<T>::of("distance", distance)?);
            let mut pdf = Out::<T>::of("pdf", pdf)?;
            let (p, u, wi, distance, pdf) = (p.items()?, u.items()?, wi.items()?, distance.slice()?, pdf.slice()?);
            run(py, None, |watch| sample::light_sample_many(watch, &light, evenly, p, u, wi, distance, pdf))
        })
    }

    #[pyfunction]
    fn light_pdf(
        py: Python<'_>,
        light: &Bound<'_, PyAny>,
        evenly: bool,
        points: &Bound<'_, PyAny>,
        wi: &Bound<'_, PyAny>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        real!(points, T => {
            let light = one_light::<T>(light)?;
            let (p, wi) = (In::<T>::of("points", points)?, In::<T>::of("wi", wi)?);
            let mut out = Out::<T>::of("out", out)?;
            let (p, wi, out) = (p.items()?, wi.items()?, out.slice()?);
            run(py, None, |watch| sample::light_pdf_many(watch, &light, evenly, p, wi, out))
        })
    }

    /// `samples`: how many, and their seed.
    #[pyfunction]
    fn unshadowed(
        py: Python<'_>,
        receivers: ReceiverTuple<'_>,
        is_eye: bool,
        material_ids: Option<&Bound<'_, PyAny>>,
        light_table: &Bound<'_, PyAny>,
        method: &str,
        samples: (u32, u64),
        out: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        real!(out, T => {
            let (lights, arrays) = (lights::<T>(light_table)?, ReceiverArrays::<T>::of(&receivers, is_eye, material_ids)?);
            let receivers = arrays.get()?;
            let mut out = Out::<T>::of("out", out)?;
            let out = out.items()?;
            let (count, seed) = samples;
            let digits = direct::digits(0, count);
            let mirrors = match method {
                "sampling" => direct::Mirrors::Sampled { digits: &digits, seed },
                "ltc" => direct::Mirrors::Transformed,
                "representative_point" => direct::Mirrors::Representative,
                other => return Err(unknown("method", other)),
            };
            run(py, progress, |watch| direct::unshadowed_many(watch, &receivers, &lights, mirrors, out))
        })
    }
}

fn double_corners(corners: &Bound<'_, PyAny>) -> PyResult<Vec<Vec3<f64>>> {
    Ok(In::<f64>::of("corners", corners)?.items()?.iter().map(|&c| c.into()).collect())
}
