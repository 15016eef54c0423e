"""The rasterisation pipeline: coverage, depth, interpolation, G-buffer."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._arrays import Floats
from ._kernels import raster as _kernels

__all__ = [
    "GBuffer",
    "Interpolated",
    "Raster",
    "g_buffer",
    "interpolate",
    "rasterize",
    "rasterize_depth",
    "render_lambert",
]

MAX_SIZE = 16384
"""The largest width and height of a picture, in pixels."""

Cull: TypeAlias = Literal["none", "back", "front"]
Depth: TypeAlias = Literal["standard", "zero_to_one", "reversed"]


class Raster(NamedTuple):
    """What is seen at each sample: arrays (H, W), or (H, W, S) of several samples a pixel."""

    face: NDArray[np.int32]
    """The nearest face; -1 where there is none."""
    u: Floats
    """Weight of the face's second vertex; 0 where there is no face."""
    v: Floats
    """Weight of the face's third vertex; 0 where there is no face."""
    depth: Floats
    """z / w in the range of the depth convention; infinite where there is no face."""


def _size(size: tuple[int, int]) -> tuple[int, int]:
    try:
        width, height = size
    except (TypeError, ValueError):
        raise ValueError(f"size: expected (width, height), got {size!r}") from None
    return _arrays.count("size", width, 0, MAX_SIZE), _arrays.count("size", height, 0, MAX_SIZE)


def _samples(samples: int) -> int:
    if samples not in (1, 2, 4, 8):
        raise ValueError(f"samples: expected 1, 2, 4 or 8, got {samples!r}")
    return int(samples)


def _clip(clip: ArrayLike) -> Floats:
    array = _arrays.vectors("clip", clip, 4)
    if array.ndim != 2:
        raise ValueError(f"clip: expected shape (n, 4), got {array.shape}")
    return array


def _faces(faces: ArrayLike) -> NDArray[np.int32]:
    """Faces as int32; the kernel compares them with the number of vertices."""
    array = np.asarray(faces)
    if array.dtype != np.int32:
        return _arrays.indices("faces", array.reshape(0, 3) if array.size == 0 else array, 3)
    if array.ndim != 2 or array.shape[-1] != 3:
        raise ValueError(f"faces: expected shape (m, 3), got {array.shape}")
    return np.require(array, requirements=["C", "A"])


def _seen_faces(face: ArrayLike) -> NDArray[np.int32]:
    array = np.asarray(face)
    if array.dtype.kind not in "iu":
        raise TypeError(f"raster.face: expected integers, got dtype {array.dtype}")
    return np.require(array, dtype=np.int32, requirements=["C", "A"])


def _modes(cull: str, depth: str) -> tuple[str, str]:
    return (
        _arrays.choice("cull", cull, ("none", "back", "front")),
        _arrays.choice("depth", depth, ("standard", "zero_to_one", "reversed")),
    )


def rasterize(
    clip: ArrayLike,
    faces: ArrayLike,
    size: tuple[int, int],
    samples: int = 1,
    *,
    cull: Cull = "none",
    depth: Depth = "standard",
    out: Raster | None = None,
) -> Raster:
    """The nearest face at each sample of a picture, where on the face it lies, and its depth.

    Parameters
    ----------
    clip : array_like, shape (V, 4)
        Vertices in clip space: ``projection @ view @ model @ (x, y, z, 1)``. Their precision is the result's.
    faces : array_like of int, shape (F, 3)
        Vertices of each triangle; counter-clockwise on the screen is front.
    size : (int, int)
        Width and height in pixels, at most 16384.
    samples : {1, 2, 4, 8}
        Samples of a pixel: its centre, or the standard rotated grid [4]_.
    cull : {"none", "back", "front"}
        Which faces are dropped.
    depth : {"standard", "zero_to_one", "reversed"}
        What z / w means: -1 near to 1 far, 0 near to 1 far, or 1 near to 0 far.
    out : Raster, optional
        Arrays to write into.

    Returns
    -------
    Raster
        `face`, `u`, `v`, `depth`, each (H, W), or (H, W, S) where `samples` is above one. The point seen is
        ``(1 - u - v) a + u b + v c`` of the whole triangle, also where it was cut by the near plane.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range; the first index out of range is named.

    Notes
    -----
    Positions are snapped to 1/256 pixel, and coverage is then decided in integers: exactly. By the top-left rule a
    sample on an edge that two triangles share belongs to one of them, so a closed surface has neither holes nor
    samples drawn twice. Equal depths go to the lowest face. The result does not depend on the number of threads or on
    the SIMD level.

    `u`, `v` and `depth` are those of the unsnapped triangle at the sample, clamped to the triangle where snapping
    covered a sample outside of it; perspective-correct in homogeneous form [2]_. Their error grows with the ratio of
    a triangle's longest edge to its height on the screen.

    Triangles are cut by near and far planes, and by a guard band 8192 pixels about the picture; those with a vertex
    that is not finite are skipped. Cost: each triangle once, each covered sample once for each layer, and 16 (28) bytes
    written a sample in float32 (float64).

    References
    ----------
    .. [1] J. Pineda, *A Parallel Algorithm for Polygon Rasterization*, 1988.
    .. [2] M. Olano, T. Greer, *Triangle Scan Conversion using 2D Homogeneous Coordinates*, 1997.
    .. [3] J. F. Blinn, M. E. Newell, *Clipping Using Homogeneous Coordinates*, 1978.
    .. [4] Microsoft, *Direct3D 11.3 Functional Specification*, 2015, sections 3.4.2 and 19.2.

    Examples
    --------
    >>> clip = [[-1, -1, 0, 1], [1, -1, 0, 1], [-1, 1, 0, 1]]
    >>> rasterize(clip, [[0, 1, 2]], (4, 4)).face
    array([[-1, -1, -1, -1],
           [ 0, -1, -1, -1],
           [ 0,  0, -1, -1],
           [ 0,  0,  0, -1]], dtype=int32)
    """
    points, triangles = _clip(clip), _faces(faces)
    (width, height), samples = _size(size), _samples(samples)
    modes = _modes(cull, depth)
    shape = (height, width) if samples == 1 else (height, width, samples)
    given: Any = Raster(None, None, None, None) if out is None else Raster(*out)  # type: ignore[arg-type]
    result = Raster(
        _arrays.output("out.face", given.face, shape, np.int32),
        _arrays.output("out.u", given.u, shape, points.dtype),
        _arrays.output("out.v", given.v, shape, points.dtype),
        _arrays.output("out.depth", given.depth, shape, points.dtype),
    )
    _kernels.rasterize(points, triangles, (width, height), samples, *modes, tuple(result))
    return result


def rasterize_depth(
    clip: ArrayLike,
    faces: ArrayLike,
    size: tuple[int, int],
    samples: int = 1,
    *,
    cull: Cull = "none",
    depth: Depth = "standard",
    out: Floats | None = None,
) -> Floats:
    """The depth of `rasterize` alone, as for a shadow map or a depth prepass.

    Parameters
    ----------
    clip, faces, size, samples, cull, depth
        As in `rasterize`.
    out : ndarray, optional
        The array to write into.

    Returns
    -------
    ndarray, shape (H, W) or (H, W, S)
        z / w of the nearest face, infinite where there is none; to the bit the `depth` of `rasterize`.

    Raises
    ------
    TypeError, ValueError
        As `rasterize`.

    Examples
    --------
    >>> clip = [[-1, -1, 0, 1], [3, -1, 0, 1], [-1, 3, 0.5, 1]]
    >>> rasterize_depth(clip, [[0, 1, 2]], (2, 2))
    array([[0.1875, 0.1875],
           [0.0625, 0.0625]])
    """
    points, triangles = _clip(clip), _faces(faces)
    (width, height), samples = _size(size), _samples(samples)
    modes = _modes(cull, depth)
    shape = (height, width) if samples == 1 else (height, width, samples)
    result: Floats = _arrays.output("out", out, shape, points.dtype)
    _kernels.rasterize_depth(points, triangles, (width, height), samples, *modes, result)
    return result


class Interpolated(NamedTuple):
    """An attribute at each sample, and its change from one pixel to the next: arrays (H, W[, S], C)."""

    value: Floats
    """The attribute; 0 where there is no face."""
    dx: Floats
    """Its derivative to the right, per pixel."""
    dy: Floats
    """Its derivative downwards, per pixel."""


@overload
def interpolate(
    attributes: ArrayLike,
    faces: ArrayLike,
    raster: Raster,
    derivatives: Literal[False] = False,
    *,
    clip: ArrayLike | None = None,
    out: Floats | None = None,
) -> Floats: ...


@overload
def interpolate(
    attributes: ArrayLike,
    faces: ArrayLike,
    raster: Raster,
    derivatives: Literal[True],
    *,
    clip: ArrayLike | None = None,
    out: Floats | None = None,
) -> Interpolated: ...


def interpolate(
    attributes: ArrayLike,
    faces: ArrayLike,
    raster: Raster,
    derivatives: bool = False,
    *,
    clip: ArrayLike | None = None,
    out: Floats | None = None,
) -> Floats | Interpolated:
    """Attributes of vertices at what was rasterised, perspective-correct, and their screen derivatives.

    Parameters
    ----------
    attributes : array_like, shape (V, C)
        Values at the vertices: normals, texture coordinates, colours. Computed in the precision of `raster`.
    faces : array_like of int, shape (F, 3)
        The faces that were rasterised.
    raster : Raster
        What `rasterize` returned.
    derivatives : bool
        Return the derivatives along the picture's axes too.
    clip : array_like, shape (V, 4), optional
        The vertices that were rasterised; needed for derivatives.
    out : ndarray, optional
        The array for the values.

    Returns
    -------
    ndarray, shape (H, W, C) or (H, W, S, C), or Interpolated
        ``a + u (b - a) + v (c - a)`` at each sample, zero where there is no face; with `derivatives` a named tuple
        `value`, `dx`, `dy`.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range, or `derivatives` are asked for without `clip`.

    Notes
    -----
    Derivatives are those of the triangle's own plane, not differences between neighbouring pixels, so they hold at
    silhouettes too; `dy` points downwards, as rows do. They grow without bound towards a triangle's horizon, and are
    zero on triangles that are edge-on to within rounding. Attributes that are equal give their value to the bit. Errors
    are those of `u` and `v` times the attribute's range. Cost: reads 12 (20) bytes a sample, writes C numbers.

    References
    ----------
    P. S. Heckbert, *Survey of Texture Mapping*, 1986. M. Olano, T. Greer, *Triangle Scan Conversion using 2D
    Homogeneous Coordinates*, 1997.

    Examples
    --------
    >>> clip, faces = [[-1, -1, 0, 1], [3, -1, 0, 1], [-1, 3, 0, 1]], [[0, 1, 2]]
    >>> seen = rasterize(clip, faces, (4, 1))
    >>> interpolate([[0.0], [8.0], [0.0]], faces, seen, derivatives=True, clip=clip).dx[0, :, 0]
    array([1., 1., 1., 1.])
    """
    dtype = _arrays.result_dtype(raster=raster.u)
    values = _arrays.floats("attributes", attributes, dtype)
    if values.ndim != 2:
        raise ValueError(f"attributes: expected shape (n, c), got {values.shape}")
    triangles = _faces(faces)
    seen: list[NDArray[Any]] = [_seen_faces(raster.face)]
    shape = seen[0].shape
    if len(shape) not in (2, 3) or (len(shape) == 3 and shape[2] not in (2, 4, 8)):
        raise ValueError(f"raster: expected pictures (H, W) or (H, W, S) with S of 2, 4 or 8, got {shape}")
    for name, array in (("raster.u", raster.u), ("raster.v", raster.v)):
        coordinate = _arrays.floats(name, array, dtype)
        if coordinate.shape != shape:
            raise ValueError(f"{name}: expected shape {shape}, got {coordinate.shape}")
        seen.append(coordinate)
    full = (*shape, values.shape[1])
    result: Floats = _arrays.output("out", out, full, dtype)
    given = (values, values.shape[1])
    if not derivatives:
        _kernels.interpolate(given, triangles, tuple(seen), result)
        return result
    if clip is None:
        raise ValueError("clip: expected the vertices that were rasterised, since derivatives are asked for")
    points = _clip(np.asarray(_arrays.floats("clip", clip, dtype)))
    if len(points) != len(values):
        raise ValueError(f"clip: expected shape ({len(values)}, 4), got {points.shape}")
    dx, dy = np.empty(full, dtype), np.empty(full, dtype)
    view = (shape[1], shape[0], shape[2] if len(shape) == 3 else 1)
    _kernels.interpolate(given, triangles, tuple(seen), result, (points, view, dx, dy))
    return Interpolated(result, dx, dy)


class GBuffer(NamedTuple):
    """What deferred shading asks of each sample: arrays (H, W) or (H, W, S), vectors (…, 3)."""

    face: NDArray[np.int32]
    """The nearest face; -1 where there is none."""
    u: Floats
    """Weight of the face's second vertex."""
    v: Floats
    """Weight of the face's third vertex."""
    depth: Floats
    """z / w in the range of the depth convention; infinite where there is no face."""
    position: Floats
    """The point seen, in the space of the given positions; 0 where there is no face."""
    normal: Floats
    """Unit normal, interpolated or the face's own; 0 where there is no face."""
    material: NDArray[np.int32]
    """The face's material; -1 where there is no face."""


def g_buffer(
    clip: ArrayLike,
    faces: ArrayLike,
    positions: ArrayLike,
    size: tuple[int, int],
    samples: int = 1,
    *,
    normals: ArrayLike | None = None,
    material_ids: ArrayLike | None = None,
    cull: Cull = "none",
    depth: Depth = "standard",
    out: GBuffer | None = None,
) -> GBuffer:
    """Face, depth, position, normal and material of each sample, in one pass.

    Parameters
    ----------
    clip, faces, size, samples, cull, depth
        As in `rasterize`.
    positions : array_like, shape (V, 3)
        The vertices in the space in which shading happens, usually the world's.
    normals : array_like, shape (V, 3), optional
        Normals at the vertices; without them each face has its own, ``cross(b - a, c - a)`` made a unit vector.
    material_ids : array_like of int, shape (F,), optional
        Material of each face; without them all are 0.
    out : GBuffer, optional
        Arrays to write into: fresh memory costs as much as drawing.

    Returns
    -------
    GBuffer
        `face`, `u`, `v`, `depth`, `position`, `normal`, `material`.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range.

    Notes
    -----
    The same bits as `rasterize` and `interpolate`, except that normals are of unit length (a vanishing one is zero).
    Writes 44 (80) bytes a sample in float32 (float64).

    References
    ----------
    T. Saito, T. Takahashi, *Comprehensible Rendering of 3-D Shapes*, 1990.

    Examples
    --------
    >>> clip, positions = [[-1, -1, 0, 1], [3, -1, 0, 1], [-1, 3, 0, 1]], [[0, 0, 5], [4, 0, 5], [0, 4, 5]]
    >>> seen = g_buffer(clip, [[0, 1, 2]], positions, (2, 2))
    >>> seen.position[1, 0], seen.normal[1, 0]
    (array([0.5, 0.5, 5. ]), array([0., 0., 1.]))
    """
    points, triangles = _clip(clip), _faces(faces)
    dtype = points.dtype
    world = _arrays.vectors("positions", positions, 3, dtype)
    directions = None if normals is None else _arrays.vectors("normals", normals, 3, dtype)
    for name, array in (("positions", world), ("normals", directions)):
        if array is not None and array.shape != (len(points), 3):
            raise ValueError(f"{name}: expected shape ({len(points)}, 3), got {array.shape}")
    ids = None if material_ids is None else _arrays.indices("material_ids", material_ids)
    if ids is not None and ids.shape != (len(triangles),):
        raise ValueError(f"material_ids: expected shape ({len(triangles)},), got {ids.shape}")
    (width, height), samples = _size(size), _samples(samples)
    modes = _modes(cull, depth)
    shape = (height, width) if samples == 1 else (height, width, samples)
    result = GBuffer(
        *(
            _arrays.output(
                f"out.{name}",
                None if out is None else getattr(out, name),
                (*shape, 3) if name in ("position", "normal") else shape,
                np.int32 if name in ("face", "material") else dtype,
            )
            for name in GBuffer._fields
        )
    )
    _kernels.g_buffer(points, triangles, (world, directions, ids), (width, height), samples, *modes, list(result))
    return result


def render_lambert(
    positions: ArrayLike,
    faces: ArrayLike,
    normals: ArrayLike,
    matrix: ArrayLike,
    size: tuple[int, int],
    samples: int = 1,
    *,
    to_light: ArrayLike = (0.0, 0.0, 1.0),
    color: ArrayLike = (1.0, 1.0, 1.0),
    background: ArrayLike = (0.0, 0.0, 0.0),
    two_sided: bool = False,
    cull: Cull = "none",
    depth: Depth = "standard",
    format: Literal["float", "rgba8"] = "float",
    out: NDArray[Any] | None = None,
) -> NDArray[Any]:
    """A picture of a matte mesh under one distant light, in one pass from vertices to pixels.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Vertices. Their precision is that of the arithmetic, and of a picture of floats.
    faces : array_like of int, shape (F, 3)
        Vertices of each triangle; counter-clockwise on the screen is front.
    normals : array_like, shape (V, 3)
        Normals at the vertices, of unit length or nearly, in the space of `positions`. Interpolated, then brought to
        unit length at each sample.
    matrix : array_like, shape (4, 4)
        From the space of `positions` to clip space: ``projection @ view``.
    size : (int, int)
        Width and height in pixels, at most 16384.
    samples : {1, 2, 4, 8}
        Samples of a pixel, each shaded; the pixel is their mean.
    to_light : array_like, shape (3,)
        Direction to the light, in the space of `positions`; of any length but zero.
    color : array_like, shape (3,)
        Linear colour of a surface that faces the light: its radiance, base colour over pi times irradiance.
    background : array_like, shape (3,)
        Linear colour where there is no surface.
    two_sided : bool
        Light both sides of a surface alike, ``|n . l|``; else ``max(0, n . l)``.
    cull, depth
        As in `rasterize`.
    format : {"float", "rgba8"}
        "float": linear colour, (H, W, 3). "rgba8": what a render target of 8 bits holds, (H, W, 4) of uint8:
        linear colour clipped to [0, 1] and rounded to 1/255, and the fraction of the pixel that is covered.
    out : ndarray, optional
        The array to write into.

    Returns
    -------
    ndarray, shape (H, W, 3) or (H, W, 4)
        The picture.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range; the first index out of range is named.

    Notes
    -----
    The same pixels as `rasterize`, `interpolate` and the shading in NumPy, up to rounding, at a fraction of the cost:
    face, barycentrics and normals never leave the cache, and memory carries the picture alone, 12 (24) bytes a pixel,
    or 4 as rgba8. A vanishing normal gives black.

    References
    ----------
    J. H. Lambert, *Photometria*, 1760. B. T. Phong, *Illumination for Computer Generated Pictures*, 1975.

    Examples
    --------
    >>> positions = [[-1, -1, 0], [3, -1, 0], [-1, 3, 0]]
    >>> picture = render_lambert(positions, [[0, 1, 2]], [[0, 0, 1]] * 3, np.eye(4), (2, 1), to_light=(0, 3, 4))
    >>> picture[0, 0].round(6)
    array([0.8, 0.8, 0.8])
    """
    points = _arrays.vectors("positions", positions, 3)
    if points.ndim != 2:
        raise ValueError(f"positions: expected shape (n, 3), got {points.shape}")
    directions = _arrays.vectors("normals", normals, 3, points.dtype)
    if directions.shape != points.shape:
        raise ValueError(f"normals: expected shape {points.shape}, got {directions.shape}")
    triangles = _faces(faces)
    transform = _arrays.matrices("matrix", matrix, 4, points.dtype)
    if transform.ndim != 2:
        raise ValueError(f"matrix: expected shape (4, 4), got {transform.shape}")
    (width, height), samples = _size(size), _samples(samples)
    modes = _modes(cull, depth)
    light = _triple("to_light", to_light)
    length = float(np.linalg.norm(light))
    if length == 0:
        raise ValueError("to_light: expected a direction, got a vector of length zero")
    shading = (light / length, _triple("color", color), _triple("background", background), bool(two_sided))
    if _arrays.choice("format", format, ("float", "rgba8")) == "float":
        picture = _arrays.output("out", out, (height, width, 3), points.dtype)
    else:
        picture = _arrays.output("out", out, (height, width, 4), np.uint8)
    _kernels.render_lambert(
        points, directions, triangles, transform, (width, height), samples, *modes, shading, picture
    )
    return picture


def _triple(name: str, value: ArrayLike) -> Floats:
    """Three finite doubles."""
    array = _arrays.vectors(name, value, 3, np.float64)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name}: expected three finite numbers, got {value!r}")
    return array
