//! Bindings of `transform`: affine, view, projection, normal_matrix, points.
use pyo3::prelude::*;

#[pymodule]
pub mod transform {
    use crate::python::array::{In, Out, run};
    use crate::real;
    use crate::transform::projection::Depth;
    use crate::transform::{affine, normal_matrix, points, projection, view};
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    type Array<'a, 'py> = &'a Bound<'py, PyAny>;

    fn depth_of(name: &str) -> PyResult<Depth> {
        match name {
            "standard" => Ok(Depth::Standard),
            "zero_to_one" => Ok(Depth::ZeroToOne),
            "reversed" => Ok(Depth::Reversed),
            _ => Err(PyValueError::new_err(format!("depth: unknown convention {name:?}"))),
        }
    }

    #[pyfunction]
    fn rotate_axis(
        py: Python<'_>,
        axis: Array<'_, '_>,
        angle: Array<'_, '_>,
        out: Array<'_, '_>,
    ) -> PyResult<()> {
        real!(axis, T => {
            let (axis, angle) = (In::<T>::of("axis", axis)?, In::<T>::of("angle", angle)?);
            let mut out = Out::<T>::of("out", out)?;
            let (axis, angle, out) = (axis.items()?, angle.slice()?, bytemuck::cast_slice_mut(out.items::<16>()?));
            run(py, None, |watch| affine::rotate_axis_many(watch, axis, angle, out))
        })
    }

    #[pyfunction]
    fn translate(py: Python<'_>, offset: Array<'_, '_>, out: Array<'_, '_>) -> PyResult<()> {
        real!(offset, T => {
            let offset = In::<T>::of("offset", offset)?;
            let mut out = Out::<T>::of("out", out)?;
            let (offset, out) = (offset.items()?, bytemuck::cast_slice_mut(out.items::<16>()?));
            run(py, None, |watch| affine::translate_many(watch, offset, out))
        })
    }

    #[pyfunction]
    fn scale(py: Python<'_>, factors: Array<'_, '_>, out: Array<'_, '_>) -> PyResult<()> {
        real!(factors, T => {
            let factors = In::<T>::of("factors", factors)?;
            let mut out = Out::<T>::of("out", out)?;
            let (factors, out) = (factors.items()?, bytemuck::cast_slice_mut(out.items::<16>()?));
            run(py, None, |watch| affine::scale_many(watch, factors, out))
        })
    }

    #[pyfunction]
    fn look_at(
        py: Python<'_>,
        eye: Array<'_, '_>,
        target: Array<'_, '_>,
        up: Array<'_, '_>,
        out: Array<'_, '_>,
    ) -> PyResult<()> {
        real!(eye, T => {
            let (eye, target, up) = (In::<T>::of("eye", eye)?, In::of("target", target)?, In::of("up", up)?);
            let mut out = Out::<T>::of("out", out)?;
            let (eye, target, up) = (eye.items()?, target.items()?, up.items()?);
            let out = bytemuck::cast_slice_mut(out.items::<16>()?);
            run(py, None, |watch| view::look_at_many(watch, eye, target, up, out))
        })
    }

    /// `planes`: (n, 6) left, right, bottom, top, near, far, or (n, 4) field of view, aspect, near, far.
    #[pyfunction]
    fn perspective(py: Python<'_>, planes: Array<'_, '_>, depth: &str, out: Array<'_, '_>) -> PyResult<()> {
        let depth = depth_of(depth)?;
        real!(planes, T => {
            let planes = In::<T>::of("planes", planes)?;
            let mut out = Out::<T>::of("out", out)?;
            let fields = planes.shape().last() == Some(&4);
            let out = bytemuck::cast_slice_mut(out.items::<16>()?);
            if fields {
                let planes = planes.items()?;
                run(py, None, |watch| projection::perspective_fov_many(watch, planes, depth, out))
            } else {
                let planes = planes.items()?;
                run(py, None, |watch| projection::perspective_many(watch, planes, depth, out))
            }
        })
    }

    #[pyfunction]
    fn orthographic(py: Python<'_>, planes: Array<'_, '_>, depth: &str, out: Array<'_, '_>) -> PyResult<()> {
        let depth = depth_of(depth)?;
        real!(planes, T => {
            let planes = In::<T>::of("planes", planes)?;
            let mut out = Out::<T>::of("out", out)?;
            let (planes, out) = (planes.items()?, bytemuck::cast_slice_mut(out.items::<16>()?));
            run(py, None, |watch| projection::orthographic_many(watch, planes, depth, out))
        })
    }

    #[pyfunction]
    fn viewport(size: [f64; 2], origin: [f64; 2], out: Array<'_, '_>) -> PyResult<()> {
        real!(out, T => {
            let mut out = Out::<T>::of("out", out)?;
            let [w, h] = size.map(|x| x as T);
            let [x, y] = origin.map(|x| x as T);
            let rows = projection::viewport([w, h], [x, y]);
            out.items::<16>()?[0] = bytemuck::cast(rows);
            Ok(())
        })
    }

    #[pyfunction]
    fn linear_depth(
        py: Python<'_>,
        depth: Array<'_, '_>,
        matrix: Array<'_, '_>,
        out: Array<'_, '_>,
    ) -> PyResult<()> {
        real!(depth, T => {
            let (depth, matrix) = (In::<T>::of("depth", depth)?, In::<T>::of("projection", matrix)?);
            let mut out = Out::<T>::of("out", out)?;
            let matrix = bytemuck::cast(matrix.items::<16>()?[0]);
            let (depth, out) = (depth.slice()?, out.slice()?);
            run(py, None, |watch| projection::linear_depth_many(watch, depth, &matrix, out))
        })
    }

    #[pyfunction]
    #[pyo3(name = "normal_matrix")]
    fn normal_matrices(py: Python<'_>, matrix: Array<'_, '_>, out: Array<'_, '_>) -> PyResult<()> {
        real!(matrix, T => {
            let matrix = In::<T>::of("matrix", matrix)?;
            let mut out = Out::<T>::of("out", out)?;
            let matrix = bytemuck::cast_slice(matrix.items::<16>()?);
            let out = bytemuck::cast_slice_mut(out.items::<9>()?);
            run(py, None, |watch| normal_matrix::normal_matrix_many::<T>(watch, matrix, out))
        })
    }

    /// `kind`: point, vector, normal, homogeneous.
    #[pyfunction]
    fn transform(
        py: Python<'_>,
        kind: &str,
        given: Array<'_, '_>,
        matrix: Array<'_, '_>,
        out: Array<'_, '_>,
    ) -> PyResult<()> {
        real!(given, T => {
            let (given, matrix) = (In::<T>::of("points", given)?, In::<T>::of("matrix", matrix)?);
            let mut out = Out::<T>::of("out", out)?;
            let (given, matrix) = (given.items()?, bytemuck::cast_slice(matrix.items::<16>()?));
            let kind = match kind {
                "point" => points::Kind::Point,
                "vector" => points::Kind::Vector,
                "normal" => points::Kind::Normal,
                _ => {
                    let out = out.items()?;
                    return run(py, None, |watch| points::homogeneous(watch, given, matrix, out));
                }
            };
            let out = out.items()?;
            run(py, None, |watch| points::transform(watch, kind, given, matrix, out))
        })
    }

    #[pyfunction]
    fn project(
        py: Python<'_>,
        given: Array<'_, '_>,
        matrix: Array<'_, '_>,
        size: [f64; 2],
        out: Array<'_, '_>,
    ) -> PyResult<()> {
        real!(given, T => {
            let (given, matrix) = (In::<T>::of("points", given)?, In::<T>::of("matrix", matrix)?);
            let mut out = Out::<T>::of("out", out)?;
            let (given, matrix) = (given.items()?, bytemuck::cast_slice(matrix.items::<16>()?));
            let out = out.items()?;
            run(py, None, |watch| points::project(watch, given, matrix, size.map(|s| s as T), out))
        })
    }

    #[pyfunction]
    fn unproject(
        py: Python<'_>,
        given: Array<'_, '_>,
        matrix: Array<'_, '_>,
        size: [f64; 2],
        out: Array<'_, '_>,
    ) -> PyResult<()> {
        real!(given, T => {
            let (given, matrix) = (In::<T>::of("pixels", given)?, In::<f64>::of("matrix", matrix)?);
            let mut out = Out::<T>::of("out", out)?;
            let matrices: &[[[f64; 4]; 4]] = bytemuck::cast_slice(matrix.items::<16>()?);
            let inverses = matrices
                .iter()
                .map(points::inverse::<T>)
                .collect::<Option<Vec<_>>>()
                .ok_or_else(|| PyValueError::new_err("matrix: expected an invertible matrix, got a singular one"))?;
            let (given, out) = (given.items()?, out.items()?);
            run(py, None, |watch| points::unproject(watch, given, &inverses, size.map(|s| s as T), out))
        })
    }
}
