"""Which face is seen at each sample: the rasteriser, and depth alone."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import raster as _kernels
from . import _arguments
from ._arguments import Cull, Depth

__all__ = ["Raster", "rasterize", "rasterize_depth"]


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
    points, triangles = _arguments.clip(clip), _arguments.faces(faces)
    (width, height), samples = _arguments.size(size), _arguments.samples(samples)
    modes = _arguments.modes(cull, depth)
    shape = (height, width) if samples == 1 else (height, width, samples)
    try:
        given: Any = Raster(*(out if out is not None else (None,) * 4))
    except TypeError:
        raise TypeError(f"out: expected a Raster, got {type(out).__name__}") from None
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
    points, triangles = _arguments.clip(clip), _arguments.faces(faces)
    (width, height), samples = _arguments.size(size), _arguments.samples(samples)
    modes = _arguments.modes(cull, depth)
    shape = (height, width) if samples == 1 else (height, width, samples)
    result: Floats = _arrays.output("out", out, shape, points.dtype)
    _kernels.rasterize_depth(points, triangles, (width, height), samples, *modes, result)
    return result
