"""Planes: where three meet, and on which side of one a box lies. Exact (see `shadelab.geometry`)."""

from __future__ import annotations

from typing import Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels
from ._overlap import Given, aabb, obb, one

__all__ = ["PlaneSide", "PlanesPoint", "plane_aabb", "plane_obb", "three_planes"]


class PlanesPoint(NamedTuple):
    """Where three planes meet, and how firmly."""

    point: Floats
    """The point; NaN where there is none, or more than one."""
    volume: Floats
    """What the unit normals span, from -1 to 1: 1 orthogonal, 0 no point. Errors of the planes grow by its inverse."""


class PlaneSide(NamedTuple):
    """On which side of a plane a box lies."""

    side: NDArray[np.int8]
    """1 in front, -1 behind, 0 where the plane meets the box."""
    distance: Floats
    """Signed distance of the box's centre from the plane."""
    radius: Floats
    """Half the extent of the box along the normal; the plane meets the box where this is at least the distance."""


@overload
def three_planes(a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: Literal[False] = False) -> Floats: ...
@overload
def three_planes(a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: Literal[True]) -> PlanesPoint: ...
def three_planes(a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: bool = False) -> Floats | PlanesPoint:
    """The point where three planes meet.

    Parameters
    ----------
    a, b, c : array_like, shape (..., 4)
        Planes `n · x + d = 0` as `(n, d)`; normals need not be of unit length. Leading axes broadcast.
    full_output : bool
        Also tell how firmly the planes hold the point.

    Returns
    -------
    ndarray, shape (..., 3), or PlanesPoint
        The point; NaN where two planes are parallel, or all three share a direction.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of four components, or leading axes do not broadcast.

    Notes
    -----
    Cramer's rule, with determinants evaluated exactly where double precision would lose their digits: each coordinate
    is right to 1e-13 of itself in float64 and to one rounding in float32, for the coefficients as given, however near
    to parallel; NaN comes if and only if they are exactly so. Whether the coefficients are right is another matter:
    their errors grow by up to the inverse of `volume`. About 0.4 µs, near parallel 5 to 10 µs.

    References
    ----------
    R. Goldman, *Intersection of Three Planes*, Graphics Gems, 1990.

    Examples
    --------
    >>> three_planes([1, 0, 0, -1.0], [0, 1, 0, -2.0], [1, 1, 1, -6.0])
    array([1., 2., 3.])
    """
    given: Given = {"a": (a, 4), "b": (b, 4), "c": (c, 4)}
    result = PlanesPoint(*_arrays.elementwise(_kernels.three_planes, given, [3, 0]))
    return result if _arrays.flag("full_output", full_output) else result.point


@overload
def plane_aabb(
    plane: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: Literal[False] = False
) -> NDArray[np.int8]: ...
@overload
def plane_aabb(plane: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: Literal[True]) -> PlaneSide: ...
def plane_aabb(
    plane: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: bool = False
) -> NDArray[np.int8] | PlaneSide:
    """On which side of a plane an axis-aligned box lies.

    Parameters
    ----------
    plane : array_like, shape (..., 4)
        Plane `n · x + d = 0` as `(n, d)`; its front is where `n` points. The normal may be of any length.
    lower, upper : array_like, shape (..., 3)
        The box's corners. Leading axes broadcast.
    full_output : bool
        Also give the centre's distance and the box's radius along the normal.

    Returns
    -------
    ndarray of int8, shape (...), or PlaneSide
        1 in front, -1 behind, 0 where the plane meets the box (also in a single point). 0 as well where a number is
        NaN or infinite, or `lower` exceeds `upper`: what cannot be told is not ruled out.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    The corners farthest along and against the normal decide; their sides are exact. About 0.1 µs.

    References
    ----------
    T. Akenine-Möller et al., *Real-Time Rendering*, 4th edition, 2018, section 22.10.1.

    Examples
    --------
    >>> plane_aabb([0, 1.0, 0, -1], [[0, 1, 0], [0, 2, 0], [0, -1, 0]], [[1, 2, 1], [1, 3, 1], [1, 0, 1]])
    array([ 0,  1, -1], dtype=int8)
    """
    given = {"plane": (plane, 4), **aabb("", lower, upper)}
    side = one(_kernels.plane_aabb, given, (0, np.int8))
    if not _arrays.flag("full_output", full_output):
        return side
    return PlaneSide(side, *_arrays.elementwise(_kernels.plane_aabb_interval, given, [0, 0]))


@overload
def plane_obb(
    plane: ArrayLike,
    center: ArrayLike,
    axes: ArrayLike,
    half_extents: ArrayLike,
    *,
    full_output: Literal[False] = False,
) -> NDArray[np.int8]: ...
@overload
def plane_obb(
    plane: ArrayLike, center: ArrayLike, axes: ArrayLike, half_extents: ArrayLike, *, full_output: Literal[True]
) -> PlaneSide: ...
def plane_obb(
    plane: ArrayLike, center: ArrayLike, axes: ArrayLike, half_extents: ArrayLike, *, full_output: bool = False
) -> NDArray[np.int8] | PlaneSide:
    """On which side of a plane an oriented box lies.

    Parameters
    ----------
    plane : array_like, shape (..., 4)
        Plane `n · x + d = 0` as `(n, d)`; its front is where `n` points. The normal may be of any length.
    center : array_like, shape (..., 3)
        The box's centre.
    axes : array_like, shape (..., 3, 3)
        The box's axes as rows. The box is the set of points `center + x @ axes` with `|x| <= half_extents`.
    half_extents : array_like, shape (..., 3)
        Half the box's size along each axis, not negative. Leading axes broadcast.
    full_output : bool
        Also give the centre's distance and the box's radius along the normal.

    Returns
    -------
    ndarray of int8, shape (...), or PlaneSide
        1 in front, -1 behind, 0 where the plane meets the box (also in a single point). 0 as well where a number is
        NaN or infinite, or a half extent is negative: what cannot be told is not ruled out.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    Exact for the box as given, whose axes, as rounded, are never quite orthonormal. About 0.2 µs.

    References
    ----------
    T. Akenine-Möller et al., *Real-Time Rendering*, 4th edition, 2018, section 22.10.2.

    Examples
    --------
    >>> plane_obb([0, 1.0, 0, 0], [0, 1.5, 0], [[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]], [1, 1, 1]).item()
    1
    """
    given = {"plane": (plane, 4), **obb("", center, axes, half_extents)}
    side = one(_kernels.plane_obb, given, (0, np.int8))
    if not _arrays.flag("full_output", full_output):
        return side
    return PlaneSide(side, *_arrays.elementwise(_kernels.plane_obb_interval, given, [0, 0]))
