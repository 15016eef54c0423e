"""Triangles and polygons that overlap boxes and each other. Exact (see `shadelab.geometry`)."""

from __future__ import annotations

from typing import Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels
from ._overlap import BOOL, Bools, Given, aabb, one

__all__ = ["PolygonBox", "TriangleBox", "TrianglesMeeting", "polygon_aabb", "triangle_aabb", "triangle_triangle"]


class TriangleBox(NamedTuple):
    """What separates a triangle from a box."""

    overlap: Bools
    axis: NDArray[np.int32]
    """The first axis that separates them: 0-2 the box's normals, 3 the triangle's, 4 + 3 k + e the product of axis k
    with the edge from vertex e to the next; -1 where they overlap."""


class PolygonBox(NamedTuple):
    """What of a polygon meets a box."""

    overlap: Bools
    by: NDArray[np.int8]
    """0 nothing, 1 an edge, 2 the interior alone."""


class TrianglesMeeting(NamedTuple):
    """How two triangles meet."""

    overlap: Bools
    coplanar: Bools
    """Whether one lies in the plane of the other, or has no area."""
    start: Floats
    end: Floats
    """The common segment of triangles in different planes, its ends alike where they touch in a point; else NaN."""


@overload
def triangle_aabb(
    a: ArrayLike,
    b: ArrayLike,
    c: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    full_output: Literal[False] = False,
) -> Bools: ...
@overload
def triangle_aabb(
    a: ArrayLike, b: ArrayLike, c: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: Literal[True]
) -> TriangleBox: ...
def triangle_aabb(
    a: ArrayLike, b: ArrayLike, c: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: bool = False
) -> Bools | TriangleBox:
    """Whether a triangle overlaps an axis-aligned box, by all thirteen separating axes.

    Parameters
    ----------
    a, b, c : array_like, shape (..., 3)
        The triangle's vertices.
    lower, upper : array_like, shape (..., 3)
        The box's corners; it may be flat. Leading axes broadcast.
    full_output : bool
        Also tell which axis separates them.

    Returns
    -------
    ndarray of bool, shape (...), or TriangleBox
        True where they have a point in common. False where a number is NaN or infinite, or `lower` exceeds `upper`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Exact, also for slivers and for triangles without area: comparisons, and orientations in the coordinate planes and
    in
    space. 30 to 100 ns.

    References
    ----------
    T. Akenine-Möller, *Fast 3D Triangle-Box Overlap Testing*, Journal of Graphics Tools 6(1), 2001.

    Examples
    --------
    >>> t = triangle_aabb([3.1, 0, 0], [0, 3.1, 0], [0, 0, 3.1], [[0, 0, 0.0], [0, 0, 0]], [[1, 1, 1.0], [1, 1, 2]],
    ...                   full_output=True)
    >>> t.overlap, t.axis
    (array([False,  True]), array([ 3, -1], dtype=int32))
    """
    given: Given = {"a": (a, 3), "b": (b, 3), "c": (c, 3), **aabb("", lower, upper)}
    axis = one(_kernels.triangle_aabb, given, (0, np.int32))
    overlap = axis == -1
    return TriangleBox(overlap, np.maximum(axis, np.int32(-1))) if _arrays.flag("full_output", full_output) else overlap


@overload
def polygon_aabb(
    polygon: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: Literal[False] = False
) -> Bools: ...
@overload
def polygon_aabb(
    polygon: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: Literal[True]
) -> PolygonBox: ...
def polygon_aabb(
    polygon: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: bool = False
) -> Bools | PolygonBox:
    """Whether a flat polygon overlaps an axis-aligned box.

    Parameters
    ----------
    polygon : array_like, shape (..., N, 3)
        Corners in order around; simple, convex or not, in either winding. Repeated and collinear corners are fine.
    lower, upper : array_like, shape (..., 3)
        The box's corners; it may be flat. Leading axes broadcast.
    full_output : bool
        Also tell whether an edge meets the box, or the interior alone.

    Returns
    -------
    ndarray of bool, shape (...), or PolygonBox
        True where they have a point in common. False where a number is NaN or infinite, or `lower` exceeds `upper`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    Exact for polygons that lie in a plane. One whose corners were rounded off it counts with its edges as they are and
    its interior in the plane through the first corner along the areas' normal. About 0.2 µs an edge.

    References
    ----------
    D. Green, D. Hatch, *Fast Polygon-Cube Intersection Testing*, Graphics Gems V, 1995.

    Examples
    --------
    >>> square = [[-9, -9, 0.5], [9, -9, 0.5], [9, 9, 0.5], [-9, 9, 0.5]]
    >>> polygon_aabb(square, [[0, 0, 0], [0, 0, 0.6]], [[1, 1, 1], [1, 1, 1]])
    array([ True, False])
    """
    dtype = _arrays.result_dtype(polygon=polygon, lower=lower, upper=upper)
    corners = _arrays.vectors("polygon", polygon, 3, dtype)
    if corners.ndim < 2 or corners.shape[-2] == 0:
        raise ValueError(f"polygon: expected shape (..., N, 3), got {corners.shape}")
    box = {
        "lower": (_arrays.vectors("lower", lower, 3, dtype), 1),
        "upper": (_arrays.vectors("upper", upper, 3, dtype), 1),
    }
    shape, flat = _arrays.broadcast({"polygon": (corners, 2), **box})
    by = np.empty(shape, np.int8)
    _kernels.polygon_aabb(corners.shape[-2], flat, by)
    overlap = np.asarray(by > 0)
    return PolygonBox(overlap, by) if _arrays.flag("full_output", full_output) else overlap


@overload
def triangle_triangle(
    a0: ArrayLike,
    a1: ArrayLike,
    a2: ArrayLike,
    b0: ArrayLike,
    b1: ArrayLike,
    b2: ArrayLike,
    *,
    full_output: Literal[False] = False,
) -> Bools: ...
@overload
def triangle_triangle(
    a0: ArrayLike,
    a1: ArrayLike,
    a2: ArrayLike,
    b0: ArrayLike,
    b1: ArrayLike,
    b2: ArrayLike,
    *,
    full_output: Literal[True],
) -> TrianglesMeeting: ...
def triangle_triangle(
    a0: ArrayLike,
    a1: ArrayLike,
    a2: ArrayLike,
    b0: ArrayLike,
    b1: ArrayLike,
    b2: ArrayLike,
    *,
    full_output: bool = False,
) -> Bools | TrianglesMeeting:
    """Whether triangles have a point in common.

    Parameters
    ----------
    a0, a1, a2, b0, b1, b2 : array_like, shape (..., 3)
        The vertices of triangles A and B, in either winding. Leading axes broadcast.
    full_output : bool
        Also tell whether they are coplanar, and give the segment that they have in common.

    Returns
    -------
    ndarray of bool, shape (...), or TrianglesMeeting
        True where they overlap or touch: in an edge, in a vertex, in their plane. False where a number is NaN or
        infinite.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Exact for magnitudes from 1e-50 to 1e50 (all of float32; beyond, products overflow), in space and in one plane,
    also for slivers and for triangles without area, which count as their edges. The
    segment's ends are right to 4 rounding units of the largest coordinate, near-parallel planes included. Coplanar
    triangles have an area in common, which `clip_polygon` gives. About 0.25 µs, in one plane
    1.5 µs.

    References
    ----------
    T. Möller, *A Fast Triangle-Triangle Intersection Test*, Journal of Graphics Tools 2(2), 1997. P. Guigue, O.
    Devillers, *Fast and Robust Triangle-Triangle Overlap Test Using Orientation Predicates*, Journal of Graphics
    Tools 8(1), 2003.

    Examples
    --------
    >>> m = triangle_triangle([0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1.0], [1, 1, 1], [1, -9, 1], full_output=True)
    >>> bool(m.overlap), bool(m.coplanar), m.end, m.start
    (True, False, array([1., 1., 0.]), array([1., 0., 0.]))
    """
    given: Given = {"a0": (a0, 3), "a1": (a1, 3), "a2": (a2, 3), "b0": (b0, 3), "b1": (b1, 3), "b2": (b2, 3)}
    if not _arrays.flag("full_output", full_output):
        return one(_kernels.triangle_triangle, given)
    return TrianglesMeeting(*_arrays.elementwise(_kernels.triangle_triangle_segment, given, [BOOL, BOOL, 3, 3]))
