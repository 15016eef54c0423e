//! Bindings of `shadow`.
use pyo3::prelude::*;

#[pymodule]
pub mod shadow {
    use crate::python::accel::Tree;
    use crate::python::array::{In, Out, run};
    use crate::raster::{Cull, MAX_SIZE};
    use crate::real;
    use crate::real::Real;
    use crate::shadow as kernels;
    use crate::shadow::fit::Eye;
    use crate::vec::Vec3;
    use kernels::lookup::{Bias, Map};
    use kernels::pattern::{Kind, Pattern};
    use kernels::shadow_map::View;
    use numpy::Element;
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    /// Origin (3), rows right, up, axis (9), window (4) and near (1) of a map.
    type Geometry = [f64; 17];
    /// Constant, slope, normal offset, plane.
    type Granted = (f64, f64, f64, bool);
    /// Kind, samples, seed.
    type Taps<'a> = (&'a str, usize, Option<u64>);

    fn map<'a, T: Real + Element>(depth: &'a In<'_, T>, g: &Geometry) -> PyResult<Map<'a, T>> {
        let at = |i: usize| T::of(g[i]);
        let three = |i: usize| [at(i), at(i + 1), at(i + 2)];
        let frame = [three(3), three(6), three(9)];
        let size = match depth.shape() {
            &[height, width] => [width, height],
            _ => return Err(PyValueError::new_err("depth: expected shape (H, W)")),
        };
        Map::new(depth.slice()?, size, three(0), frame, [at(12), at(13), at(14), at(15)], at(16))
            .ok_or_else(|| PyValueError::new_err("window: expected left < right and bottom < top"))
    }

    fn bias<T: Real>((constant, slope, normal_offset, plane): Granted) -> Bias<T> {
        Bias { constant: T::of(constant), slope: T::of(slope), normal_offset: T::of(normal_offset), plane }
    }

    fn pattern<T: Real>((kind, samples, seed): Taps<'_>) -> PyResult<Pattern<T>> {
        let kind = match kind {
            "vogel" => Kind::Vogel,
            "box" => Kind::Box,
            "grid" => Kind::Grid,
            _ => return Err(PyValueError::new_err("kernel: unknown")),
        };
        Ok(Pattern::new(kind, samples, seed))
    }

    /// Calls `$f::<T, true>` or `$f::<T, false>`.
    macro_rules! by_projection {
        ($perspective:expr, $t:ident, $f:ident, ($($arg:expr),*)) => {
            if $perspective { $f::<$t, true>($($arg),*) } else { $f::<$t, false>($($arg),*) }
        };
    }

    /// Origin, frame, window, near, far of a view; whether it is perspective.
    type Seen = ([f64; 3], [[f64; 3]; 3], [f64; 4], f64, f64, bool);

    /// Bounds of what is seen from an origin in a frame: (low, high) of both window coordinates and of the depth.
    #[pyfunction]
    fn span(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        origin: [f64; 3],
        frame: [[f64; 3]; 3],
        perspective: Option<f64>,
    ) -> PyResult<([f64; 3], [f64; 3])> {
        let eye = Eye { origin, frame, perspective };
        real!(points, T => {
            let points = In::<T>::of("points", points)?;
            let points = points.items()?;
            let span = run(py, None, |watch| kernels::fit::span(watch, points, &eye))?;
            Ok((span.low, span.high))
        })
    }

    #[pyfunction]
    fn shadow_map(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        seen: Seen,
        cull: &str,
        progress: Option<Py<PyAny>>,
        depth: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let cull = match cull {
            "back" => Cull::Back,
            "front" => Cull::Front,
            _ => Cull::None,
        };
        let (origin, frame, window, near, far, perspective) = seen;
        let view = View { origin, frame, window, near, far, perspective };
        let faces = In::<i32>::of("faces", faces)?;
        real!(depth, T => {
            let positions = In::<T>::of("positions", positions)?;
            let mut depth = Out::<T>::of("depth", depth)?;
            let &[height, width] = depth.shape() else {
                return Err(PyValueError::new_err("depth: expected shape (H, W)"));
            };
            let (p, f, depth) = (positions.items()?, faces.items()?, depth.slice()?);
            if width.max(height) > MAX_SIZE || f.iter().flatten().any(|&k| k < 0 || k as usize >= p.len()) {
                return Err(PyValueError::new_err("faces or depth: out of range"));
            }
            run(py, progress, |watch| {
                kernels::shadow_map::shadow_map(watch, p, f, &view, [width, height], cull, depth)
            })
        })
    }

    #[pyfunction]
    fn hard(
        py: Python<'_>,
        depth: &Bound<'_, PyAny>,
        geometry: Geometry,
        perspective: bool,
        receivers: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        granted: Granted,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        use kernels::hard::hard as kernel;
        real!(depth, T => {
            let (depth, points) = (In::<T>::of("depth", depth)?, In::<T>::of("receivers", receivers)?);
            let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
            let mut out = Out::<T>::of("out", out)?;
            let (map, bias) = (map(&depth, &geometry)?, bias(granted));
            let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
            let out = out.slice()?;
            run(py, None, |watch| by_projection!(perspective, T, kernel, (watch, &map, p, n, &bias, out)))
        })
    }

    #[pyfunction]
    fn pcf(
        py: Python<'_>,
        depth: &Bound<'_, PyAny>,
        geometry: Geometry,
        perspective: bool,
        receivers: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        taps: Taps<'_>,
        radius: f64,
        texels: bool,
        granted: Granted,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        use kernels::pcf::{Radius, pcf as kernel};
        real!(depth, T => {
            let (depth, points) = (In::<T>::of("depth", depth)?, In::<T>::of("receivers", receivers)?);
            let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
            let mut out = Out::<T>::of("out", out)?;
            let (map, bias, taps) = (map(&depth, &geometry)?, bias(granted), pattern(taps)?);
            let radius = if texels { Radius::Texels(T::of(radius)) } else { Radius::World(T::of(radius)) };
            let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
            let out = out.slice()?;
            run(py, None, |watch| {
                by_projection!(perspective, T, kernel, (watch, &map, p, n, &taps, radius, &bias, out))
            })
        })
    }

    #[pyfunction]
    fn pcss(
        py: Python<'_>,
        depth: &Bound<'_, PyAny>,
        geometry: Geometry,
        perspective: bool,
        receivers: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        light: [f64; 2],
        search: Taps<'_>,
        frustum: bool,
        filter: Taps<'_>,
        granted: Granted,
        out: &Bound<'_, PyAny>,
        more: Option<[Bound<'_, PyAny>; 3]>,
    ) -> PyResult<()> {
        use kernels::pcss::{Knobs, pcss as kernel};
        real!(depth, T => {
            let (depth, points) = (In::<T>::of("depth", depth)?, In::<T>::of("receivers", receivers)?);
            let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
            let mut out = Out::<T>::of("out", out)?;
            let mut more = match &more {
                Some([a, b, c]) => Some((Out::<T>::of("blocker_depth", a)?, Out::of("penumbra", b)?, Out::of("search_radius", c)?)),
                None => None,
            };
            let more = match &mut more {
                Some((a, b, c)) => Some((a.slice()?, b.slice()?, c.slice()?)),
                None => None,
            };
            let (search, filter) = (pattern(search)?, pattern(filter)?);
            let knobs = Knobs { light: light.map(T::of), search: &search, frustum, filter: &filter, bias: bias(granted) };
            let map = map(&depth, &geometry)?;
            let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
            let out = out.slice()?;
            run(py, None, |watch| by_projection!(perspective, T, kernel, (watch, &map, p, n, &knobs, out, more)))
        })
    }

    #[pyfunction]
    fn ray_traced(
        py: Python<'_>,
        tree: &Bound<'_, Tree>,
        receivers: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        ignore: Option<&Bound<'_, PyAny>>,
        light: (&str, [[f64; 3]; 3]),
        samples: usize,
        seed: u64,
        offset: f64,
        progress: Option<Py<PyAny>>,
        out: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        use kernels::ray_traced::{Emitter, Knobs, ray_traced as kernel};
        real!(receivers, T => {
            let points = In::<T>::of("receivers", receivers)?;
            let normals = normals.map(|n| In::<T>::of("normals", n)).transpose()?;
            let ignore = ignore.map(|f| In::<i32>::of("ignore_face", f)).transpose()?;
            let mut out = Out::<T>::of("out", out)?;
            let (kind, vectors) = light;
            let [a, u, v] = vectors.map(|v| Vec3::from(v.map(T::of)));
            let emitter = match kind {
                "rect" => Emitter::Rect { center: a, u, v },
                "directional" => Emitter::Directional { towards: a },
                _ => Emitter::Point { position: a },
            };
            let knobs = Knobs { emitter, samples, seed, offset: T::of(offset) };
            let tree = tree.get().of::<T>()?.clone();
            let (p, n) = (points.items()?, normals.as_ref().map(In::items).transpose()?);
            let (ignore, out) = (ignore.as_ref().map(In::slice).transpose()?, out.slice()?);
            run(py, progress, |watch| kernel(watch, &tree, p, n, ignore, &knobs, out))
        })
    }
}
