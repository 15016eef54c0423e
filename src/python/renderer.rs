//! Bindings of `renderer`.

use pyo3::prelude::*;

#[pymodule]
pub mod renderer {
    use crate::light::unshadowed::Viewer;
    use crate::python::array::{In, Out, run, unknown};
    use crate::python::environment::Surroundings;
    use crate::python::light::lights;
    use crate::real;
    use crate::renderer::shade::{self as kernels, Lights, Method, Surfaces};
    use pyo3::prelude::*;

    /// Points, normals, and where they are seen from: one eye, or directions.
    type Places<'py> = [Bound<'py, PyAny>; 3];
    /// Normals of faces, whether the inside is seen, colours, rows of materials.
    type More<'py> = [Option<Bound<'py, PyAny>>; 4];

    fn method(number: i32) -> PyResult<Method> {
        match number {
            0 => Ok(Method::Sampling),
            1 => Ok(Method::Ltc),
            2 => Ok(Method::Representative),
            3 => Ok(Method::Point),
            other => Err(unknown("methods", &other.to_string())),
        }
    }

    /// `tables`: kinds and rows of materials, and their methods with how many samples.
    #[pyfunction]
    fn shade(
        py: Python<'_>,
        places: Places<'_>,
        is_eye: bool,
        more: More<'_>,
        tables: [Bound<'_, PyAny>; 3],
        light_table: &Bound<'_, PyAny>,
        fractions: Vec<Option<Bound<'_, PyAny>>>,
        sky: Option<PyRef<'_, Surroundings>>,
        seed: u64,
        out: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        real!(out, T => {
            let [points, normals, viewer] = &places;
            let (points, normals) = (In::<T>::of("points", points)?, In::<T>::of("normals", normals)?);
            let viewer = In::<T>::of("wo", viewer)?;
            let [faces, inside, colors, ids] = &more;
            let faces = faces.as_ref().map(|f| In::<T>::of("geometric_normals", f)).transpose()?;
            let inside = inside.as_ref().map(|f| In::<bool>::of("inside", f)).transpose()?;
            let colors = colors.as_ref().map(|c| In::<T>::of("colors", c)).transpose()?;
            let ids = ids.as_ref().map(|i| In::<i32>::of("material_ids", i)).transpose()?;
            let [kinds, rows, methods] = &tables;
            let (kinds, rows) = (In::<i32>::of("kinds", kinds)?, In::<T>::of("rows", rows)?);
            let methods = In::<i32>::of("methods", methods)?;
            let methods = methods.items()?.iter().map(|&[m, n]| Ok((method(m)?, n as u32))).collect::<PyResult<Vec<_>>>()?;
            let lamps = lights::<T>(light_table)?;
            let fractions = fractions
                .iter()
                .map(|f| f.as_ref().map(|f| In::<T>::of("lit", f)).transpose())
                .collect::<PyResult<Vec<_>>>()?;
            let fractions =
                fractions.iter().map(|f| f.as_ref().map(|f| f.slice()).transpose()).collect::<PyResult<Vec<_>>>()?;
            let sky = sky.as_ref().map(|s| s.of::<T>()).transpose()?.map(|p| &**p);
            let mut out = Out::<T>::of("out", out)?;
            let seen = viewer.items()?;
            let surfaces = Surfaces {
                points: points.items()?,
                normals: normals.items()?,
                faces: faces.as_ref().map(|f| f.items()).transpose()?,
                inside: inside.as_ref().map(|i| i.slice()).transpose()?,
                colors: colors.as_ref().map(|c| c.items()).transpose()?,
                viewer: if is_eye { Viewer::Eye(seen[0].into()) } else { Viewer::Directions(seen) },
                material_ids: ids.as_ref().map(|i| i.slice()).transpose()?,
                kinds: kinds.slice()?,
                rows: rows.items()?,
                methods: &methods,
            };
            let lights = Lights { lights: &lamps, fractions: &fractions, sky, seed };
            let out = out.items()?;
            run(py, progress, |watch| kernels::shade(watch, &surfaces, &lights, out))
        })
    }
}
