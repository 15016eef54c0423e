//! Bindings of facets: ndf, masking_shadowing, kulla_conty; conversions of specular_glossiness.

use crate::brdf::compensated_glass;
use crate::brdf::kulla_conty::{Albedo, Form, SIZE, knot, missing};
use crate::brdf::ndf as kernels;
use crate::brdf::specular_glossiness as workflow;
use crate::brdf::{Masking, Microfacets, Shape};
use crate::elementwise;
use crate::python::array::{Arrays, unknown};
use crate::real::{Lanes, Real};
use crate::vec::Vec3;
use num_traits::{One, Zero};
use pyo3::prelude::*;

fn shape(name: &str) -> PyResult<Shape> {
    match name {
        "ggx" => Ok(Shape::Ggx),
        "beckmann" => Ok(Shape::Beckmann),
        _ => Err(unknown("distribution", name)),
    }
}

fn masking(name: &str) -> PyResult<Masking> {
    match name {
        "height_correlated" => Ok(Masking::HeightCorrelated),
        "separable" => Ok(Masking::Separable),
        "schlick" => Ok(Masking::Schlick),
        "v_cavity" => Ok(Masking::VCavity),
        _ => Err(unknown("masking", name)),
    }
}

/// Widths in (0, 1], else NaN.
#[inline(always)]
fn facets<T: Real>(alpha: [T; 2], shape: Shape, masking: Masking) -> Microfacets<T> {
    let [x, y] = alpha.map(|a| if a > T::zero() && a <= T::one() { a } else { T::NAN });
    Microfacets { alpha_x: x, alpha_y: y, ratio: [y / x, x / y], shape, masking }
}

#[pyfunction]
pub fn ndf(py: Python<'_>, distribution: &str, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    let gtr = distribution == "gtr";
    let shape = if gtr { Shape::Ggx } else { shape(distribution)? };
    elementwise!(py, given, out,
        |normal: [T; 3], alpha: [T; 1], alpha_y: [T; 1], gamma: [T; 1]| -> (d: [T; 1]) {
            let facets = facets([alpha[0], alpha_y[0]], shape, Masking::Separable);
            let normal = Vec3::from(normal);
            if normal.z <= T::zero() {
                [T::zero()]
            } else if gtr {
                [kernels::gtr(normal, facets.alpha_x, gamma[0])]
            } else {
                [facets.distribution(normal)]
            }
        }
    )
}

/// `out`: G.
#[pyfunction]
pub fn masking_shadowing(
    py: Python<'_>,
    distribution: &str,
    form: &str,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let (shape, form) = (shape(distribution)?, masking(form)?);
    elementwise!(py, given, out,
        |wi: [T; 3], wo: [T; 3], alpha: [T; 1], alpha_y: [T; 1]| -> (g: [T; 1]) {
            let facets = facets([alpha[0], alpha_y[0]], shape, form);
            let (wi, wo) = (Vec3::from(wi), Vec3::from(wo));
            if wi.z <= T::zero() || wo.z <= T::zero() {
                [T::zero()]
            } else {
                let v = facets.visibility(wi, wo, (wi + wo).normalize());
                [Lanes::min(v * T::of(4.0) * wi.z * wo.z, T::one()) + v * T::zero()]
            }
        }
    )
}

/// `out`: the added lobe of a reflectance of one, E(θi), E(θo), their average, the colour of the form.
#[pyfunction]
pub fn kulla_conty(
    py: Python<'_>,
    distribution: &str,
    form: &str,
    published: bool,
    given: Arrays<'_>,
    out: Arrays<'_>,
) -> PyResult<()> {
    let (shape, masking) = (shape(distribution)?, masking(form)?);
    let color = if published { Form::AsPublished } else { Form::Bounces };
    elementwise!(py, given, out,
        |wi: [T; 3], wo: [T; 3], alpha: [T; 1], fresnel: [T; 1]|
        -> (lobe: [T; 1], ei: [T; 1], eo: [T; 1], average: [T; 1], share: [T; 1]) {
            let (wi, wo) = (Vec3::from(wi), Vec3::from(wo));
            let valid = alpha[0] > T::zero() && alpha[0] <= T::one() && !(wi.z + wo.z).is_nan();
            if !valid {
                ([T::NAN], [T::NAN], [T::NAN], [T::NAN], [T::NAN])
            } else {
                let slice = Albedo::of(shape, masking).width(alpha[0]);
                let seen = wi.z > T::zero() && wo.z > T::zero();
                let lobe = if seen { missing(&slice, wi, wo) } else { T::zero() };
                let average = T::of(slice.average());
                let at = |w: Vec3<T>| T::of(slice.at(w.z.to_f64()));
                ([lobe], [at(wi)], [at(wo)], [average], [color.color(fresnel[0], average)])
            }
        }
    )
}

/// The table of E by roughness² and cosine, its averages, and the knots of both axes: of perfect mirrors, or of the
/// interfaces of an index.
#[pyfunction]
pub fn albedo_table(
    py: Python<'_>,
    distribution: &str,
    form: &str,
    eta: Option<f64>,
) -> PyResult<(Vec<Vec<f64>>, Vec<f64>, Vec<f64>)> {
    let (shape, masking) = (shape(distribution)?, masking(form)?);
    let of_glass;
    let table = match eta {
        None => Albedo::of(shape, masking),
        Some(eta) => {
            of_glass = py.detach(|| compensated_glass::table(shape, masking, eta));
            &of_glass
        }
    };
    let rows = table.by_cosine.iter().map(|r| r.to_vec()).collect();
    Ok((rows, table.average.to_vec(), (0..SIZE).map(knot).collect()))
}

/// `out`: base colour, metallic.
#[pyfunction]
pub fn to_metallic_roughness(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |diffuse: [T; 3], specular: [T; 3]| -> (base: [T; 3], metallic: [T; 1]) {
        let (base, metallic) = workflow::to_metallic_roughness(diffuse.into(), specular.into());
        (base.to_array(), [metallic])
    })
}

/// `out`: diffuse, specular.
#[pyfunction]
pub fn to_specular_glossiness(py: Python<'_>, given: Arrays<'_>, out: Arrays<'_>) -> PyResult<()> {
    elementwise!(py, given, out, |base: [T; 3], metallic: [T; 1]| -> (diffuse: [T; 3], specular: [T; 3]) {
        let (diffuse, specular) = workflow::to_specular_glossiness(base.into(), metallic[0]);
        (diffuse.to_array(), specular.to_array())
    })
}
