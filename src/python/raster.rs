//! Bindings of `raster`.
use pyo3::prelude::*;

#[pymodule]
pub mod raster {
    use crate::parallel::{self, Interrupted, Watch};
    use crate::python::array::{In, Out, run};
    use crate::raster::{
        self as kernels, Attributes, Cull, Depth, GBuffer, Options, Seen, Shading, Surface, View, Visibility,
    };
    use crate::real;
    use crate::real::Real;
    use crate::vec::Mat4;
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Refuses indices outside `[0, below)`, naming the first.
    fn check_indices(py: Python<'_>, faces: &[[i32; 3]], below: usize) -> PyResult<()> {
        let bad = run(py, None, |watch| first_bad_face(watch, faces, below))?;
        let Some(i) = bad else { return Ok(()) };
        let k = (0..3).find(|&k| faces[i][k] < 0 || faces[i][k] as usize >= below).unwrap_or(0);
        let index = faces[i][k];
        Err(PyValueError::new_err(format!("faces: index {index} at ({i}, {k}) is out of range [0, {below})")))
    }

    fn first_bad_face(
        watch: &mut dyn Watch,
        faces: &[[i32; 3]],
        below: usize,
    ) -> Result<Option<usize>, Interrupted> {
        let first = AtomicUsize::new(usize::MAX);
        let bad = |f: &[i32; 3]| f.iter().any(|&k| k < 0 || k as usize >= below);
        parallel::for_each(watch, faces, 1 << 16, |start, faces| {
            // As unsigned numbers negative indices are the largest, so one maximum tells, in lanes.
            let largest = faces.as_flattened().iter().fold(0u32, |m, &k| m.max(k as u32));
            if largest as usize >= below
                && let Some(i) = faces.iter().position(bad)
            {
                first.fetch_min(start + i, Ordering::Relaxed);
            }
        })?;
        let first = first.into_inner();
        Ok((first < usize::MAX).then_some(first))
    }

    fn options(size: (usize, usize), samples: usize, cull: &str, depth: &str) -> PyResult<Options> {
        let cull = match cull {
            "none" => Cull::None,
            "back" => Cull::Back,
            "front" => Cull::Front,
            other => return Err(PyValueError::new_err(format!("cull: unknown mode {other:?}"))),
        };
        let depth = match depth {
            "standard" => Depth::Standard,
            "zero_to_one" => Depth::ZeroToOne,
            "reversed" => Depth::Reversed,
            other => return Err(PyValueError::new_err(format!("depth: unknown convention {other:?}"))),
        };
        Ok(Options { width: size.0, height: size.1, samples, cull, depth })
    }

    #[pyfunction]
    fn rasterize(
        py: Python<'_>,
        clip: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        size: (usize, usize),
        samples: usize,
        cull: &str,
        depth: &str,
        out: (Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>),
    ) -> PyResult<()> {
        let options = options(size, samples, cull, depth)?;
        let faces = In::<i32>::of("faces", faces)?;
        real!(clip, T => {
            let clip = In::<T>::of("clip", clip)?;
            let (mut face, mut u) = (Out::<i32>::of("out.face", &out.0)?, Out::<T>::of("out.u", &out.1)?);
            let (mut v, mut depth) = (Out::<T>::of("out.v", &out.2)?, Out::<T>::of("out.depth", &out.3)?);
            let (clip, faces) = (clip.items()?, faces.items()?);
            check_indices(py, faces, clip.len())?;
            let out = Visibility { face: face.slice()?, u: u.slice()?, v: v.slice()?, depth: depth.slice()? };
            run(py, None, |watch| kernels::rasterize(watch, clip, faces, &options, out))
        })
    }

    #[pyfunction]
    fn rasterize_depth(
        py: Python<'_>,
        clip: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        size: (usize, usize),
        samples: usize,
        cull: &str,
        depth: &str,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let options = options(size, samples, cull, depth)?;
        let faces = In::<i32>::of("faces", faces)?;
        real!(clip, T => {
            let clip = In::<T>::of("clip", clip)?;
            let mut out = Out::<T>::of("out", out)?;
            let (clip, faces, out) = (clip.items()?, faces.items()?, out.slice()?);
            check_indices(py, faces, clip.len())?;
            run(py, None, |watch| kernels::rasterize_depth(watch, clip, faces, &options, out))
        })
    }

    #[pyfunction]
    fn render_lambert(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        normals: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        matrix: &Bound<'_, PyAny>,
        size: (usize, usize),
        samples: usize,
        cull: &str,
        depth: &str,
        shading: ([f64; 3], [f64; 3], [f64; 3], bool),
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let options = options(size, samples, cull, depth)?;
        let faces = In::<i32>::of("faces", faces)?;
        let bytes = Out::<u8>::of("out", out);
        real!(positions, T => {
            let (positions, normals) =
                (In::<T>::of("positions", positions)?, In::<T>::of("normals", normals)?);
            let matrix = In::<T>::of("matrix", matrix)?;
            let (positions, normals, faces) = (positions.items()?, normals.items()?, faces.items()?);
            let rows: &[[T; 4]] = matrix.items()?;
            let matrix = Mat4::from_rows([rows[0], rows[1], rows[2], rows[3]]);
            check_indices(py, faces, positions.len())?;
            let (to_light, color, background, two_sided) = shading;
            let [to_light, color, background] =
                [to_light, color, background].map(|v| v.map(<T as Real>::of));
            let shading = Shading { to_light, color, background, two_sided };
            match bytes {
                Ok(mut bytes) => {
                    let out = bytes.items::<4>()?;
                    run(py, None, |watch| {
                        kernels::render_lambert(watch, positions, normals, faces, matrix, &options, &shading, out)
                    })
                }
                Err(_) => {
                    let mut out = Out::<T>::of("out", out)?;
                    let out = out.items::<3>()?;
                    run(py, None, |watch| {
                        kernels::render_lambert(watch, positions, normals, faces, matrix, &options, &shading, out)
                    })
                }
            }
        })
    }

    /// Refuses faces of a raster outside `[-1, count)`, naming the first.
    fn check_seen(py: Python<'_>, seen: &[i32], count: usize) -> PyResult<()> {
        let bad = |f: &i32| *f < -1 || i64::from(*f) >= count as i64;
        match py.detach(|| seen.iter().position(bad)) {
            None => Ok(()),
            Some(i) => Err(PyValueError::new_err(format!(
                "raster: face {} at element {i} is out of range [-1, {count})",
                seen[i]
            ))),
        }
    }

    #[pyfunction]
    #[pyo3(signature = (attributes, faces, seen, out, slopes=None))]
    fn interpolate(
        py: Python<'_>,
        attributes: (Bound<'_, PyAny>, usize),
        faces: &Bound<'_, PyAny>,
        seen: (Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>),
        out: &Bound<'_, PyAny>,
        slopes: Option<(Bound<'_, PyAny>, (usize, usize, usize), Bound<'_, PyAny>, Bound<'_, PyAny>)>,
    ) -> PyResult<()> {
        let (attributes, channels) = attributes;
        let faces = In::<i32>::of("faces", faces)?;
        let face = In::<i32>::of("raster.face", &seen.0)?;
        real!(&attributes, T => {
            let values = In::<T>::of("attributes", &attributes)?;
            let (u, v) = (In::<T>::of("raster.u", &seen.1)?, In::<T>::of("raster.v", &seen.2)?);
            let mut out = Out::<T>::of("out", out)?;
            let (faces, out) = (faces.items()?, out.slice()?);
            let attributes = Attributes { values: values.slice()?, channels, faces };
            let seen = Seen { face: face.slice()?, u: u.slice()?, v: v.slice()? };
            if channels == 0 {
                return Ok(());
            }
            check_indices(py, faces, attributes.values.len() / channels)?;
            check_seen(py, seen.face, faces.len())?;
            run(py, None, |watch| kernels::interpolate(watch, attributes, seen, out))?;
            if let Some((clip, (width, height, samples), dx, dy)) = &slopes {
                let clip = In::<T>::of("clip", clip)?;
                let (mut dx, mut dy) = (Out::<T>::of("dx", dx)?, Out::<T>::of("dy", dy)?);
                let view =
                    View { clip: clip.items()?, width: *width, height: *height, samples: *samples };
                let (dx, dy) = (dx.slice()?, dy.slice()?);
                check_indices(py, faces, view.clip.len())?;
                run(py, None, |watch| kernels::derivatives(watch, attributes, seen, view, dx, dy))?;
            }
            Ok(())
        })
    }

    #[pyfunction]
    fn g_buffer(
        py: Python<'_>,
        clip: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        surface: (Bound<'_, PyAny>, Option<Bound<'_, PyAny>>, Option<Bound<'_, PyAny>>),
        size: (usize, usize),
        samples: usize,
        cull: &str,
        depth: &str,
        out: [Bound<'_, PyAny>; 7],
    ) -> PyResult<()> {
        let options = options(size, samples, cull, depth)?;
        let faces = In::<i32>::of("faces", faces)?;
        let ids = surface.2.as_ref().map(|ids| In::<i32>::of("material_ids", ids)).transpose()?;
        let (mut face, mut material) =
            (Out::<i32>::of("out.face", &out[0])?, Out::<i32>::of("out.material", &out[6])?);
        real!(clip, T => {
            let clip = In::<T>::of("clip", clip)?;
            let positions = In::<T>::of("positions", &surface.0)?;
            let normals = surface.1.as_ref().map(|n| In::<T>::of("normals", n)).transpose()?;
            let real = |name, i: usize| Out::<T>::of(name, &out[i]);
            let (mut u, mut v, mut depth) = (real("out.u", 1)?, real("out.v", 2)?, real("out.depth", 3)?);
            let (mut position, mut normal) = (real("out.position", 4)?, real("out.normal", 5)?);
            let (clip, faces) = (clip.items()?, faces.items()?);
            check_indices(py, faces, clip.len())?;
            let surface = Surface {
                positions: positions.items()?,
                normals: normals.as_ref().map(|n| n.items()).transpose()?,
                material_ids: ids.as_ref().map(|ids| ids.slice()).transpose()?,
            };
            let out = GBuffer {
                visibility: Visibility {
                    face: face.slice()?,
                    u: u.slice()?,
                    v: v.slice()?,
                    depth: depth.slice()?,
                },
                position: position.items()?,
                normal: normal.items()?,
                material: material.slice()?,
            };
            run(py, None, |watch| kernels::g_buffer(watch, clip, faces, surface, &options, out))
        })
    }
}
