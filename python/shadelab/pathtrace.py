"""Ray casting, direct light, path tracing: the references, each with its own error."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _arrays, light
from ._arrays import Floats
from ._kernels import pathtrace as _kernels
from .accel import BVH, Hit

if TYPE_CHECKING:
    from .scene import Camera, Scene

__all__ = ["DirectLight", "Traced", "direct_light", "path_trace", "ray_cast"]

Size = tuple[int, int]

# Rays leave surfaces by this many rounding units of the largest coordinate: a point's own rounding is worth about 4.
_OFFSET = 16.0


class _Estimate(NamedTuple):
    radiance: Floats
    variance: Floats
    samples: int


def _merge(a: _Estimate, b: _Estimate) -> _Estimate:
    """Two estimates of the same from different samples, as one."""
    n = a.samples + b.samples
    if a.samples == 0 or b.samples == 0:
        return b if a.samples == 0 else a
    x, y = a.radiance.astype(np.float64), b.radiance.astype(np.float64)
    mean = (a.samples * x + b.samples * y) / n
    # Sums of squares about the means; a lone sample has none.
    squares = (y - x) ** 2 * (a.samples * b.samples / n)
    for e in (a, b):
        if e.samples > 1:
            squares = squares + e.variance.astype(np.float64) * (e.samples * (e.samples - 1.0))
    dtype = a.radiance.dtype
    return _Estimate(mean.astype(dtype), (squares / (n * (n - 1.0))).astype(dtype), n)


class Traced(NamedTuple):
    """A path-traced picture."""

    radiance: Floats
    """Mean of the samples, (H, W, 3), in W/(m² sr)."""
    variance: Floats
    """Variance of that mean, (H, W, 3)."""
    samples: int
    """How many samples each pixel has."""

    def merge(self, other: Traced) -> Traced:
        """One estimate of this run and another over different samples (by `start` or by seed)."""
        return Traced(*_merge(_Estimate(*self), _Estimate(*other)))


class DirectLight(NamedTuple):
    """Direct light at given points."""

    radiance: Floats
    """Mean of the samples, (..., 3), in W/(m² sr)."""
    variance: Floats
    """Variance of that mean if samples were independent, (..., 3): for scrambled points an upper bound as a rule."""
    samples: int
    """How many samples each rectangle has."""

    def merge(self, other: DirectLight) -> DirectLight:
        """One estimate of this run and another over different samples (by `start` or by seed)."""
        return DirectLight(*_merge(_Estimate(*self), _Estimate(*other)))


def _size(size: Any) -> Size:
    try:
        width, height = size
    except (TypeError, ValueError):
        raise ValueError(f"size: expected (width, height), got {size!r}") from None
    return _arrays.count("size", width, 1), _arrays.count("size", height, 1)


def _pinhole(camera: Camera, size: Size) -> tuple[tuple[float, ...], ...]:
    """Eye, direction through the picture's top left corner, and its steps a pixel to the right and down."""
    eye, target, up = (np.asarray(v, np.float64) for v in (camera.eye, camera.target, camera.up))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    height = 2 * math.tan(camera.fov_y / 2)
    step = height / size[1]
    down = -np.cross(right, forward)
    corner = forward - right * (step * size[0] / 2) - down * (height / 2)
    return tuple(tuple(float(x) for x in v) for v in (eye, corner, right * step, down * step))


def _check_bvh(bvh: Any) -> None:
    if not isinstance(bvh, BVH):
        raise TypeError(f"bvh: expected a BVH, got {type(bvh).__name__}")


def _offset(positions: Floats) -> float:
    largest = float(np.abs(positions).max()) if positions.size else 0.0
    return _OFFSET * float(np.finfo(positions.dtype).eps) * largest


def ray_cast(bvh: BVH, camera: Camera, size: Size) -> Hit:
    """What the centre of each pixel sees.

    Parameters
    ----------
    bvh : BVH
        The mesh; its precision governs.
    camera : Camera
        Of `shadelab.scene`.
    size : (width, height)

    Returns
    -------
    Hit
        Pictures (H, W): `t`, the distance from the eye, and `face`, `u`, `v`; see `shadelab.accel.Hit`.

    Raises
    ------
    TypeError, ValueError
        If `size` is not of two positive integers.

    Notes
    -----
    As fast as `BVH.closest_hit` without the arrays of rays. Rays lie within 4 rounding units of their true direction.

    References
    ----------
    A. Appel, *Some techniques for shading machine renderings of solids*, 1968.

    Examples
    --------
    >>> from shadelab.scene import Camera
    >>> bvh = BVH([[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> ray_cast(bvh, Camera((0, 0, 2), (0, 0, 0)), (3, 3)).face
    array([[-1,  0, -1],
           [-1,  0, -1],
           [ 0,  0,  0]], dtype=int32)
    """
    _check_bvh(bvh)
    width, height = _size(size)
    dtype = bvh._positions.dtype
    t, u, v = (np.empty((height, width), dtype) for _ in range(3))
    face = np.empty((height, width), np.int32)
    _kernels.ray_cast(bvh._tree, _pinhole(camera, (width, height)), width, [a.reshape(-1) for a in (t, face, u, v)])
    return Hit(t, face, u, v)


def direct_light(
    bvh: BVH,
    lights: light.Light | Sequence[light.Light],
    points: ArrayLike,
    normals: ArrayLike,
    base_color: ArrayLike,
    metallic: ArrayLike = 0.0,
    roughness: ArrayLike = 0.5,
    specular: ArrayLike = 1.0,
    *,
    wo: ArrayLike | None = None,
    eye: ArrayLike | None = None,
    material_ids: ArrayLike | None = None,
    samples: int = 256,
    start: int = 0,
    seed: int = 0,
    geometric_normals: ArrayLike | None = None,
    offset: float | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> DirectLight:
    """Light from the lights, reflected once at given points, with exact shadows: the reference of shadow techniques.

    Parameters
    ----------
    bvh : BVH
        What stands in the way; its precision governs.
    lights : light or sequence of lights
        Their sum is returned.
    points, normals : array_like, shape (..., 3)
        Surface points and unit (shading) normals.
    base_color : array_like, shape (3,), (..., 3) or (m, 3)
        See `shadelab.brdf.metallic_roughness`: one material for all points, one for each, or a table of m.
    metallic, roughness, specular : array_like
        Likewise, without the last axis.
    wo : array_like, shape (..., 3), optional
        Unit directions to the eye. Either this or `eye` is needed.
    eye : array_like, shape (3,), optional
        The eye's position.
    material_ids : array_like of int, shape (...), optional
        Rows of the table; a negative one marks no surface, whose radiance is zero.
    samples : int
        Of each rectangle (a point of it, and a direction of the mirrors' lobe); powers of two are the best.
    start : int
        Index of the first sample, for going on where a run ended: `merge` the results.
    seed : int
        Runs of different seeds are independent.
    geometric_normals : array_like, shape (..., 3), optional
        Unit normals of the faces themselves, for light from below them and for `offset`; `normals` if None.
    offset : float, optional
        How far above the surface shadow rays start; 16 rounding units of the largest coordinate if None.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Returns
    -------
    DirectLight
        Radiance towards the eye, the variance of that mean, the number of samples. Zero seen from below a surface, NaN
        where an element is not a number.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, a row is out of the table, or neither or both of `wo` and `eye` are given.

    Notes
    -----
    Unbiased, but for light that passes between a surface and what touches it within `offset`. Samples are
    Owen-scrambled Sobol' points: behind an edge of shadow the error falls about as samples^(-3/4), so that `variance`
    overstates it; half the squared difference of two seeds is an unbiased measure. Sums are in double. The same bits
    for the same seed, whatever the threads.

    References
    ----------
    E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995.
    A. B. Owen, *Scrambled net variance for integrals of smooth functions*, 1997.

    Examples
    --------
    >>> blocker = BVH([[-1.0, 1, -1], [1, 1, -1], [0, 1, 1]], [[0, 1, 2]])
    >>> sun, up = light.DirectionalLight((0, -1, 0), irradiance=(np.pi,) * 3), [0.0, 1.0, 0.0]
    >>> direct_light(blocker, sun, [[0.0, 0, 0], [5.0, 0, 0]], up, [0.5] * 3, specular=0.0, wo=up).radiance
    array([[0. , 0. , 0. ],
           [0.5, 0.5, 0.5]])
    """
    _check_bvh(bvh)
    table = light._table("lights", lights)
    dtype = bvh._positions.dtype
    r = light._receivers(points, normals, wo, eye, (base_color, metallic, roughness, specular), material_ids, dtype)
    samples = _arrays.count("samples", samples, 1, 1 << 24)
    start = _arrays.count("start", start, 0, 2**32 - samples)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    above = _offset(bvh._positions) if offset is None else _arrays.number("offset", offset, 0.0)
    faces = None
    if geometric_normals is not None:
        faces = _arrays.vectors("geometric_normals", geometric_normals, 3, dtype)
        if faces.shape != (*r.shape, 3):
            raise ValueError(f"geometric_normals: expected shape {(*r.shape, 3)}, got {faces.shape}")
        faces = faces.reshape(-1, 3)
    mean, variance = (np.empty((*r.shape, 3), dtype) for _ in range(2))
    _kernels.direct_light(
        bvh._tree,
        r.arrays,
        r.is_eye,
        r.material_ids,
        (faces, above),
        table,
        (samples, start, seed),
        (mean.reshape(-1, 3), variance.reshape(-1, 3)),
        _arrays.progress_callback(progress, "direct light"),
    )
    return DirectLight(mean, variance, samples)


def path_trace(
    scene: Scene,
    size: Size = (1280, 720),
    samples: int = 64,
    max_depth: int = 8,
    seed: int = 0,
    *,
    start: int = 0,
    target_error: float | None = None,
    bvh: BVH | None = None,
    dtype: DTypeLike = np.float32,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Traced:
    """The exact picture of a scene, up to noise: all light paths, by chance.

    Parameters
    ----------
    scene : Scene
        Of `shadelab.scene`.
    size : (width, height)
    samples : int
        Of each pixel; the most of them if `target_error` is given.
    max_depth : int
        The most reflections of a path: 0 shows emission alone, 1 direct light.
    seed : int
        The same seed gives the same bits whatever the threads; different ones are independent.
    start : int
        Index of the first sample, for going on where a run ended: `merge` the results.
    target_error : float, optional
        Stops once the picture's standard error (root mean square over pixels and channels) is this fraction of its
        mean radiance, asked after 16, 32, 64 … samples.
    bvh : BVH, optional
        Of the flattened scene, in `dtype`: of the same vertices and faces; built if None.
    dtype : float32 or float64
        Of the computation; sums are in double.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Returns
    -------
    Traced
        Radiance (H, W, 3), the variance of that mean, the number of samples.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Unbiased up to `max_depth`. Box-filtered pixels; every light is sampled at every reflection, so time grows with
    their number. Rectangles are seen from the side that shines, stop what meets it, and are not there from behind;
    surfaces have two sides. (`shadelab.render` draws no lights.) The camera's `near` and `far` cut nothing off:
    paths start at the eye. No firefly is clamped: caustics from narrow mirrors converge slowly, and `variance` shows
    where. Fails to find light that only a mirror chain leads to (point lights seen in mirrors).

    References
    ----------
    J. T. Kajiya, *The rendering equation*, 1986.
    E. Veach, *Robust Monte Carlo methods for light transport simulation*, 1997.

    Examples
    --------
    >>> from shadelab import mesh, scene
    >>> ball = scene.Scene(mesh.icosphere(2), background=(1.0, 1.0, 1.0))
    >>> path_trace(ball, (8, 8), samples=4).radiance.shape
    (8, 8, 3)
    """
    width, height = _size(size)
    samples = _arrays.count("samples", samples, 1, 1 << 24)
    max_depth = _arrays.count("max_depth", max_depth, 0, 1 << 16)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    start = _arrays.count("start", start, 0, 2**32 - 1 - samples)
    if target_error is not None:
        target_error = _arrays.number("target_error", target_error, above=0.0)
    precision = np.dtype(dtype)
    if precision not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise TypeError(f"dtype: expected float32 or float64, got {precision}")
    call = _arrays.progress_callback(progress, "path trace")
    trace = _tracer(scene, (width, height), max_depth, seed, bvh, precision)
    if target_error is None:
        return trace(start, samples, call)
    result = Traced(np.zeros((height, width, 3), precision), np.zeros((height, width, 3), precision), 0)
    while result.samples < samples:
        # Twice as many each time, so that the checks cost little.
        count = min(max(16, result.samples), samples - result.samples)
        result = result.merge(trace(start + result.samples, count, call))
        mean = float(result.radiance.mean(dtype=np.float64))
        if float(result.variance.mean(dtype=np.float64)) <= (target_error * mean) ** 2:
            break
    return result


def _tracer(
    scene: Scene, size: Size, max_depth: int, seed: int, bvh: BVH | None, dtype: np.dtype[Any]
) -> Callable[[int, int, Any], Traced]:
    """A function of (start, samples, progress) that renders the scene."""
    arrays = scene.flatten(dtype)
    if bvh is None:
        bvh = BVH(arrays.positions, arrays.faces)
    else:
        _check_bvh(bvh)
        own, mine = (bvh._positions, bvh._faces), (arrays.positions, arrays.faces)
        if own[0].dtype != dtype or not all(np.array_equal(a, b) for a, b in zip(own, mine, strict=True)):
            raise ValueError(f"bvh: expected one of the flattened scene in {dtype}")
    _arrays.warn_if_coarse(arrays.positions, dtype, 4)
    mesh = (arrays.positions, arrays.faces, arrays.normals, arrays.material_ids)
    tables = (arrays.base_color, arrays.metallic, arrays.roughness, arrays.specular, arrays.emission)
    flat = [np.require(a, requirements=["C", "A"]) for a in (*mesh, *tables)]
    camera = _pinhole(scene.camera, size)
    surroundings = (tuple(float(c) for c in scene.background), _offset(arrays.positions))
    lights = light._table("lights", scene.lights)
    tree = bvh._tree

    def trace(start: int, samples: int, progress: Any) -> Traced:
        mean, variance = (np.empty((size[1], size[0], 3), dtype) for _ in range(2))
        options = (size[0], samples, start, max_depth, seed)
        out: tuple[NDArray[Any], ...] = (mean.reshape(-1, 3), variance.reshape(-1, 3))
        _kernels.path_trace(
            tree, flat[:4], arrays.colors, flat[4:], lights, surroundings, camera, options, out, progress
        )
        return Traced(mean, variance, samples)

    return trace
