"""Points: where they lie in triangles."""

from __future__ import annotations

from typing import Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = ["ClosestPoint", "barycentric", "closest_point_triangle", "perspective_barycentric"]


def barycentric(points: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike) -> Floats:
    """Barycentric coordinates of points in triangles.

    Parameters
    ----------
    points : array_like, shape (..., 3)
        Points; those off a triangle's plane are projected into it.
    a, b, c : array_like, shape (..., 3)
        The triangles' vertices. Leading axes broadcast.

    Returns
    -------
    ndarray, shape (..., 3)
        Weights of `a`, `b`, `c`; they sum to one up to rounding, and all are non-negative inside.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Computed in the promoted precision of all four arguments. The error grows as the rounding unit times the square of
    the triangle's longest edge over its height. A triangle of zero area gives NaN, and so
    do coordinates beyond 1e9 or below 1e-9 in float32 (1e75, 1e-75 in float64), whose fourth powers leave the range.
    About 2 ns a point and thread.

    References
    ----------
    C. Ericson, *Real-Time Collision Detection*, 2005, section 3.4.

    Examples
    --------
    >>> barycentric([0.25, 0.25, 0.0], [0, 0, 0], [1, 0, 0], [0, 1, 0])
    array([0.5 , 0.25, 0.25])
    """
    given = {"points": (points, 3), "a": (a, 3), "b": (b, 3), "c": (c, 3)}
    return _arrays.elementwise(_kernels.barycentric, given, [3])[0]


def perspective_barycentric(weights: ArrayLike, w: ArrayLike, *, inverse: bool = False) -> Floats:
    """Barycentric coordinates on the screen into those on the triangle before projection.

    Parameters
    ----------
    weights : array_like, shape (..., 3)
        Barycentric coordinates of a pixel in the projected triangle.
    w : array_like, shape (..., 3)
        The fourth clip coordinates of its vertices (before the division by it). Leading axes broadcast.
    inverse : bool
        From the triangle to the screen instead.

    Returns
    -------
    ndarray, shape (..., 3)
        The weights with which attributes of the vertices are interpolated; their sum is one.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Computed in the promoted precision of both. `weights / w`, over their sum. Where weights and `w` are positive, each
    is right to 5 machine epsilons of itself, whatever the size of `w`. A vertex in the eye's plane (`w` = 0) takes all
    weight; with vertices behind the eye (`w` < 0) the formula holds where the sum is not zero, else the point is
    infinitely far: NaN. Depth after the division is interpolated by the weights on the screen, not by these.

    References
    ----------
    P. Heckbert, H. Moreton, *Interpolation for Polygon Texture Mapping and Shading*, 1991.

    Examples
    --------
    >>> perspective_barycentric([0.5, 0.5, 0], [1, 3, 1])
    array([0.75, 0.25, 0.  ])
    """
    given = {"weights": (weights, 3), "w": (w, 3)}
    return _arrays.elementwise(_kernels.perspective_barycentric, given, [3], _arrays.flag("inverse", inverse))[0]


class ClosestPoint(NamedTuple):
    """The points of triangles nearest to given points."""

    point: Floats
    """The nearest point, shape (..., 3)."""
    distance: Floats
    """Its distance."""
    weights: Floats
    """Its barycentric coordinates, shape (..., 3): none negative, their sum one."""
    region: NDArray[np.int8]
    """Where it lies: 0 the face; 1, 2, 3 the edges ab, bc, ca; 4, 5, 6 the vertices a, b, c; -1 for NaN."""


@overload
def closest_point_triangle(
    points: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: Literal[False] = ...
) -> Floats: ...
@overload
def closest_point_triangle(
    points: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: Literal[True]
) -> ClosestPoint: ...
def closest_point_triangle(
    points: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: bool = False
) -> Floats | ClosestPoint:
    """Find the points of triangles that are nearest to given points.

    Parameters
    ----------
    points : array_like, shape (..., 3)
        Points.
    a, b, c : array_like, shape (..., 3)
        The triangles' vertices, in either winding. Leading axes broadcast.
    full_output : bool
        Give `ClosestPoint`: distance, weights and region as well.

    Returns
    -------
    ndarray, shape (..., 3), or ClosestPoint
        The nearest points.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Computed in the promoted precision of all arguments. Slivers, and triangles that are lines or points, are held by
    their edges: `distance` is right to 8 machine epsilons of the distance of the point from the farthest vertex, and
    the point to that much and its own rounding. NaN or infinity gives NaN at that element.

    References
    ----------
    C. Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5.

    Examples
    --------
    >>> found = closest_point_triangle([0.5, -1, 1], [0, 0, 0], [1, 0, 0], [0, 1, 0], full_output=True)
    >>> found.point, found.weights, int(found.region)
    (array([0.5, 0. , 0. ]), array([0.5, 0.5, 0. ]), 1)
    """
    given = {"points": (points, 3), "a": (a, 3), "b": (b, 3), "c": (c, 3)}
    out: list[int | tuple[int, type]] = [3, 0, 3, (0, np.int8)]
    found = ClosestPoint(*_arrays.elementwise(_kernels.closest_point_triangle, given, out))
    return found if _arrays.flag("full_output", full_output) else found.point
