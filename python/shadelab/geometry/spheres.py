"""Balls that overlap balls, boxes and triangles. Exact (see `shadelab.geometry`)."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels
from ._overlap import Bools, Given, aabb, one
from .points import closest_point_triangle

__all__ = ["Contact", "sphere_aabb", "sphere_sphere", "sphere_triangle"]


class Contact(NamedTuple):
    """How a ball lies to something."""

    overlap: Bools
    point: Floats
    """The point of the other that is nearest to the ball's centre."""
    distance: Floats
    """From the ball's centre to that point."""


@overload
def sphere_sphere(
    a_center: ArrayLike,
    a_radius: ArrayLike,
    b_center: ArrayLike,
    b_radius: ArrayLike,
    *,
    full_output: Literal[False] = False,
) -> Bools: ...
@overload
def sphere_sphere(
    a_center: ArrayLike, a_radius: ArrayLike, b_center: ArrayLike, b_radius: ArrayLike, *, full_output: Literal[True]
) -> Contact: ...
def sphere_sphere(
    a_center: ArrayLike, a_radius: ArrayLike, b_center: ArrayLike, b_radius: ArrayLike, *, full_output: bool = False
) -> Bools | Contact:
    """Whether balls overlap.

    Parameters
    ----------
    a_center, b_center : array_like, shape (..., 3)
        Their centres.
    a_radius, b_radius : array_like, shape (...)
        Their radii; zero makes a point. Leading axes broadcast.
    full_output : bool
        Also give the point of ball B nearest to the centre of A.

    Returns
    -------
    ndarray of bool, shape (...), or Contact
        True where they have a point in common. A negative radius is an empty ball, which overlaps nothing; NaN neither.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    Exact, for magnitudes from 1e-50 to 1e50 (all of float32). About 30 ns.

    References
    ----------
    C. Ericson, *Real-Time Collision Detection*, 2005, section 4.3.

    Examples
    --------
    >>> sphere_sphere([0, 0, 0.0], 1.0, [[3, 4, 0], [3, 4, 0.01]], 4.0)
    array([ True, False])
    """
    given: Given = {
        "a_center": (a_center, 3),
        "a_radius": (a_radius, 0),
        "b_center": (b_center, 3),
        "b_radius": (b_radius, 0),
    }
    overlap = one(_kernels.sphere_sphere, given)
    if not _arrays.flag("full_output", full_output):
        return overlap
    dtype = _arrays.result_dtype(**{n: v for n, (v, _) in given.items()})
    a, b = _centers(overlap, a_center, dtype, "a_center"), _centers(overlap, b_center, dtype, "b_center")
    radius = _arrays.floats("b_radius", b_radius, dtype)
    with np.errstate(all="ignore"):
        # An empty ball has no point.
        radius = np.where(radius >= 0, radius, dtype.type(np.nan))
        offset = a - b
        apart = _length(offset)
        share = np.where(apart <= radius, dtype.type(1), radius / apart)
        return Contact(overlap, b + share[..., None] * offset, np.maximum(apart - radius, dtype.type(0)))


def _centers(overlap: Bools, center: ArrayLike, dtype: DTypeLike, name: str = "center") -> Floats:
    """One for each answer."""
    return np.broadcast_to(_arrays.vectors(name, center, 3, dtype), (*overlap.shape, 3))


def _length(v: Floats) -> Any:
    return np.hypot(np.hypot(v[..., 0], v[..., 1]), v[..., 2])


@overload
def sphere_aabb(
    center: ArrayLike, radius: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: Literal[False] = False
) -> Bools: ...
@overload
def sphere_aabb(
    center: ArrayLike, radius: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: Literal[True]
) -> Contact: ...
def sphere_aabb(
    center: ArrayLike, radius: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: bool = False
) -> Bools | Contact:
    """Whether a ball overlaps an axis-aligned box.

    Parameters
    ----------
    center : array_like, shape (..., 3)
        The ball's centre.
    radius : array_like, shape (...)
        Its radius; zero makes a point.
    lower, upper : array_like, shape (..., 3)
        The box's corners. Leading axes broadcast.
    full_output : bool
        Also give the point of the box nearest to the centre.

    Returns
    -------
    ndarray of bool, shape (...), or Contact
        True where they have a point in common. A negative radius or a box whose lower corner exceeds its upper one is
        empty, and overlaps nothing; NaN neither.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    Exact, for magnitudes from 1e-50 to 1e50 (all of float32). About 0.1 µs.

    References
    ----------
    J. Arvo, *A Simple Method for Box-Sphere Intersection Testing*, Graphics Gems, 1990.

    Examples
    --------
    >>> sphere_aabb([4, 5, 0.5], [4.9, 5.0], [0, 0, 0], [1, 1, 1])
    array([False,  True])
    """
    box = aabb("", lower, upper)
    overlap = one(_kernels.sphere_aabb, {"center": (center, 3), "radius": (radius, 0), **box})
    if not _arrays.flag("full_output", full_output):
        return overlap
    dtype = _arrays.result_dtype(center=center, radius=radius, lower=lower, upper=upper)
    centers = _centers(overlap, center, dtype)
    point = one(_kernels.sphere_aabb_nearest, {"center": (centers, 3), **box}, 3)
    with np.errstate(all="ignore"):
        return Contact(overlap, point, np.asarray(_length(point - centers)))


@overload
def sphere_triangle(
    center: ArrayLike,
    radius: ArrayLike,
    a: ArrayLike,
    b: ArrayLike,
    c: ArrayLike,
    *,
    full_output: Literal[False] = False,
) -> Bools: ...
@overload
def sphere_triangle(
    center: ArrayLike, radius: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: Literal[True]
) -> Contact: ...
def sphere_triangle(
    center: ArrayLike, radius: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: bool = False
) -> Bools | Contact:
    """Whether a ball overlaps a triangle.

    Parameters
    ----------
    center : array_like, shape (..., 3)
        The ball's centre.
    radius : array_like, shape (...)
        Its radius; zero makes a point.
    a, b, c : array_like, shape (..., 3)
        The triangle's vertices. Leading axes broadcast.
    full_output : bool
        Also give the point of the triangle nearest to the centre.

    Returns
    -------
    ndarray of bool, shape (...), or Contact
        True where they have a point in common. A negative radius is an empty ball, which overlaps nothing; NaN neither.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    Exact, for magnitudes from 1e-50 to 1e50 (all of float32): the ball reaches a vertex, the inner part of an edge or
    of the face, each a sign without division; beyond, products overflow and tell overlaps that are none. Triangles
    without area count as their edges. 0.1 to 0.3 µs.

    References
    ----------
    C. Ericson, *Real-Time Collision Detection*, 2005, section 5.2.7.

    Examples
    --------
    >>> sphere_triangle([0.25, 0.25, 2.0], [1.9, 2.0], [0, 0, 0], [1, 0, 0], [0, 1, 0])
    array([False,  True])
    """
    ball: Given = {"center": (center, 3), "radius": (radius, 0)}
    overlap = one(_kernels.sphere_triangle, {**ball, "a": (a, 3), "b": (b, 3), "c": (c, 3)})
    if not _arrays.flag("full_output", full_output):
        return overlap
    dtype = _arrays.result_dtype(center=center, radius=radius, a=a, b=b, c=c)
    nearest = closest_point_triangle(_centers(overlap, center, dtype), a, b, c, full_output=True)
    return Contact(overlap, nearest.point, nearest.distance)
