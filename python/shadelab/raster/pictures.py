"""Whole pictures by the fused pipeline."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._kernels import raster as _kernels
from . import _arguments
from ._arguments import Cull, Depth

__all__ = ["render_lambert"]


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
    triangles = _arguments.faces(faces)
    transform = _arrays.matrices("matrix", matrix, 4, points.dtype)
    if transform.ndim != 2:
        raise ValueError(f"matrix: expected shape (4, 4), got {transform.shape}")
    (width, height), samples = _arguments.size(size), _arguments.samples(samples)
    modes = _arguments.modes(cull, depth)
    light = _arguments.triple("to_light", to_light)
    length = float(np.linalg.norm(light))
    if length == 0:
        raise ValueError("to_light: expected a direction, got a vector of length zero")
    shading = (
        light / length,
        _arguments.triple("color", color),
        _arguments.triple("background", background),
        _arrays.flag("two_sided", two_sided),
    )
    if _arrays.choice("format", format, ("float", "rgba8")) == "float":
        picture = _arrays.output("out", out, (height, width, 3), points.dtype)
    else:
        picture = _arrays.output("out", out, (height, width, 4), np.uint8)
    _kernels.render_lambert(
        points, directions, triangles, transform, (width, height), samples, *modes, shading, picture
    )
    return picture
