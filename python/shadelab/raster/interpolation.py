"""Attributes of vertices at each sample, right in perspective, and their derivatives."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import raster as _kernels
from . import _arguments
from .visibility import Raster

__all__ = ["Interpolated", "interpolate"]


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
    >>> from shadelab.raster import rasterize
    >>> clip, faces = [[-1, -1, 0, 1], [3, -1, 0, 1], [-1, 3, 0, 1]], [[0, 1, 2]]
    >>> seen = rasterize(clip, faces, (4, 1))
    >>> interpolate([[0.0], [8.0], [0.0]], faces, seen, derivatives=True, clip=clip).dx[0, :, 0]
    array([1., 1., 1., 1.])
    """
    if not all(hasattr(raster, name) for name in ("face", "u", "v")):
        raise TypeError(f"raster: expected what `rasterize` returns, got {type(raster).__name__}")
    derivatives = _arrays.flag("derivatives", derivatives)
    dtype = _arrays.result_dtype(raster=raster.u)
    values = _arrays.floats("attributes", attributes, dtype)
    if values.ndim != 2:
        raise ValueError(f"attributes: expected shape (n, c), got {values.shape}")
    triangles = _arguments.faces(faces)
    seen: list[NDArray[Any]] = [_arguments.seen_faces(raster.face)]
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
    points = _arguments.clip(np.asarray(_arrays.floats("clip", clip, dtype)))
    if len(points) != len(values):
        raise ValueError(f"clip: expected shape ({len(values)}, 4), got {points.shape}")
    dx, dy = np.empty(full, dtype), np.empty(full, dtype)
    view = (shape[1], shape[0], shape[2] if len(shape) == 3 else 1)
    _kernels.interpolate(given, triangles, tuple(seen), result, (points, view, dx, dy))
    return Interpolated(result, dx, dy)
