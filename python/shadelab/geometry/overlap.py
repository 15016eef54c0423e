"""Overlap tests: what meets what, and on which side of a plane it lies.

Every answer is that of exact arithmetic on the numbers given: what touches overlaps, in one point as well as in many,
and rounding never decides. Ordinary cases cost tens of nanoseconds to a few hundred; cases that double precision cannot
settle are settled without rounding, and cost up to a few microseconds. Magnitudes within 1e-50 and 1e50 (all of
float32) are exact throughout; beyond, products overflow or vanish, and what cannot be told counts as overlap.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels
from .frustum import nine
from .points import closest_point_triangle

__all__ = [
    "AxisGaps",
    "Contact",
    "PlaneSide",
    "PlanesPoint",
    "PolygonBox",
    "Separation",
    "TriangleBox",
    "TrianglesMeeting",
    "aabb_aabb",
    "obb_obb",
    "plane_aabb",
    "plane_obb",
    "polygon_aabb",
    "sphere_aabb",
    "sphere_sphere",
    "sphere_triangle",
    "three_planes",
    "triangle_aabb",
    "triangle_triangle",
]

Bools = NDArray[np.bool_]
Given = dict[str, tuple[ArrayLike, int]]
_BOOL = (0, np.bool_)


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


class AxisGaps(NamedTuple):
    """How two axis-aligned boxes lie."""

    overlap: Bools
    gaps: Floats
    """Distance between their intervals on each axis; negative is the depth of their overlap."""


class Separation(NamedTuple):
    """What separates two oriented boxes."""

    overlap: Bools
    axis: NDArray[np.int32]
    """The axis of the widest gap: 0-2 the faces of A, 3-5 of B, 6 + 3 i + j the product of edge i of A and edge j of B;
    -1 where the boxes overlap."""
    gap: Floats
    """Distance between the boxes' shadows on it; where they overlap, minus the least depth."""
    direction: Floats
    """The unit axis, pointing from A to B."""


class Contact(NamedTuple):
    """How a ball lies to something."""

    overlap: Bools
    point: Floats
    """The point of the other that is nearest to the ball's centre."""
    distance: Floats
    """From the ball's centre to that point."""


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


def _boxes(prefix: str, lower: ArrayLike, upper: ArrayLike) -> Given:
    return {f"{prefix}lower": (lower, 3), f"{prefix}upper": (upper, 3)}


def _obb(prefix: str, center: ArrayLike, axes: ArrayLike, half: ArrayLike) -> Given:
    flat = nine(f"{prefix}axes", axes)
    return {f"{prefix}center": (center, 3), f"{prefix}axes": (flat, 9), f"{prefix}half_extents": (half, 3)}


def _one(kernel: Callable[..., None], given: Given, kind: Any = _BOOL) -> Any:
    return _arrays.elementwise(kernel, given, [kind])[0]


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
    return result if full_output else result.point


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
    given = {"plane": (plane, 4), **_boxes("", lower, upper)}
    side = _one(_kernels.plane_aabb, given, (0, np.int8))
    if not full_output:
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
    given = {"plane": (plane, 4), **_obb("", center, axes, half_extents)}
    side = _one(_kernels.plane_obb, given, (0, np.int8))
    if not full_output:
        return side
    return PlaneSide(side, *_arrays.elementwise(_kernels.plane_obb_interval, given, [0, 0]))


@overload
def aabb_aabb(
    a_lower: ArrayLike,
    a_upper: ArrayLike,
    b_lower: ArrayLike,
    b_upper: ArrayLike,
    *,
    full_output: Literal[False] = False,
) -> Bools: ...
@overload
def aabb_aabb(
    a_lower: ArrayLike, a_upper: ArrayLike, b_lower: ArrayLike, b_upper: ArrayLike, *, full_output: Literal[True]
) -> AxisGaps: ...
def aabb_aabb(
    a_lower: ArrayLike, a_upper: ArrayLike, b_lower: ArrayLike, b_upper: ArrayLike, *, full_output: bool = False
) -> Bools | AxisGaps:
    """Whether axis-aligned boxes overlap.

    Parameters
    ----------
    a_lower, a_upper, b_lower, b_upper : array_like, shape (..., 3)
        The boxes' corners; infinite ones are fine. Leading axes broadcast.
    full_output : bool
        Also give the gap along each axis.

    Returns
    -------
    ndarray of bool, shape (...), or AxisGaps
        True where they have a point in common. A box whose lower corner exceeds its upper one is empty, and overlaps
        nothing; NaN neither.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Comparisons alone, so exact. About 5 ns.

    References
    ----------
    C. Ericson, *Real-Time Collision Detection*, 2005, section 4.2.

    Examples
    --------
    >>> aabb_aabb([0, 0, 0.0], [1, 1, 1], [[1, 0, 0], [1.1, 0, 0]], [[2, 1, 1], [2, 1, 1]])
    array([ True, False])
    """
    given = _boxes("a_", a_lower, a_upper) | _boxes("b_", b_lower, b_upper)
    overlap = _one(_kernels.aabb_aabb, given)
    if not full_output:
        return overlap
    return AxisGaps(overlap, _one(_kernels.aabb_aabb_gaps, given, 3))


@overload
def obb_obb(
    a_center: ArrayLike,
    a_axes: ArrayLike,
    a_half_extents: ArrayLike,
    b_center: ArrayLike,
    b_axes: ArrayLike,
    b_half_extents: ArrayLike,
    *,
    full_output: Literal[False] = False,
) -> Bools: ...
@overload
def obb_obb(
    a_center: ArrayLike,
    a_axes: ArrayLike,
    a_half_extents: ArrayLike,
    b_center: ArrayLike,
    b_axes: ArrayLike,
    b_half_extents: ArrayLike,
    *,
    full_output: Literal[True],
) -> Separation: ...
def obb_obb(
    a_center: ArrayLike,
    a_axes: ArrayLike,
    a_half_extents: ArrayLike,
    b_center: ArrayLike,
    b_axes: ArrayLike,
    b_half_extents: ArrayLike,
    *,
    full_output: bool = False,
) -> Bools | Separation:
    """Whether oriented boxes overlap, by all fifteen separating axes.

    Parameters
    ----------
    a_center, b_center : array_like, shape (..., 3)
        The boxes' centres.
    a_axes, b_axes : array_like, shape (..., 3, 3)
        Their axes as rows: a box is the set of points `center + x @ axes` with `|x| <= half_extents`.
    a_half_extents, b_half_extents : array_like, shape (..., 3)
        Half their sizes along each axis; zero makes a flat box. Leading axes broadcast.
    full_output : bool
        Also tell which axis separates them, and by how much.

    Returns
    -------
    ndarray of bool, shape (...), or Separation
        True where they have a point in common. False where a number is NaN or infinite or a half extent is negative.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    Exact for the boxes as given, whose axes, as rounded, are never quite orthonormal: the axes tested are products of
    edges, not the rounded axes themselves. Products of near-parallel edges, which are noise in floating point and the
    usual cause of false separations, have their exact value; those of parallel edges vanish and are passed over.
    0.15 to 0.3 µs; where
    an axis can only be told exactly, some microseconds more.

    References
    ----------
    S. Gottschalk, M. Lin, D. Manocha, *OBBTree: A Hierarchical Structure for Rapid Interference Detection*, SIGGRAPH
    1996.

    Examples
    --------
    >>> turned = [[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1.0]]
    >>> s = obb_obb([0, 0, 0.0], np.eye(3), [1, 1, 1], [2.5, 0, 0], turned, [1, 1, 1], full_output=True)
    >>> bool(s.overlap), int(s.axis), round(float(s.gap), 12), s.direction
    (False, 0, 0.1, array([1., 0., 0.]))
    """
    given = _obb("a_", a_center, a_axes, a_half_extents) | _obb("b_", b_center, b_axes, b_half_extents)
    if not full_output:
        return _one(_kernels.obb_obb, given)
    return Separation(*_arrays.elementwise(_kernels.obb_obb_separation, given, [_BOOL, (0, np.int32), 0, 3]))


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
    overlap = _one(_kernels.sphere_sphere, given)
    if not full_output:
        return overlap
    dtype = _arrays.result_dtype(**{n: v for n, (v, _) in given.items()})
    a, b = (_arrays.floats(n, v, dtype) for n, v in (("a_center", a_center), ("b_center", b_center)))
    radius = _arrays.floats("b_radius", b_radius, dtype)
    offset = a - b
    apart = np.hypot(np.hypot(offset[..., 0], offset[..., 1]), offset[..., 2])
    with np.errstate(all="ignore"):
        share = np.where(apart > radius, radius / apart, dtype.type(1))
    return Contact(overlap, b + share[..., None] * offset, np.maximum(apart - radius, dtype.type(0)))


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
    box = _boxes("", lower, upper)
    overlap = _one(_kernels.sphere_aabb, {"center": (center, 3), "radius": (radius, 0), **box})
    if not full_output:
        return overlap
    point = _one(_kernels.sphere_aabb_nearest, {"center": (center, 3), **box}, 3)
    return _contact(overlap, center, radius, point)


def _contact(overlap: Bools, center: ArrayLike, radius: ArrayLike, point: Floats) -> Contact:
    dtype = _arrays.result_dtype(center=center, radius=radius, point=point)
    offset = point.astype(dtype) - _arrays.floats("center", center, dtype)
    distance = np.hypot(np.hypot(offset[..., 0], offset[..., 1]), offset[..., 2])
    return Contact(overlap, point, distance)


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
    overlap = _one(_kernels.sphere_triangle, {**ball, "a": (a, 3), "b": (b, 3), "c": (c, 3)})
    if not full_output:
        return overlap
    nearest = closest_point_triangle(center, a, b, c, full_output=True)
    return Contact(overlap, nearest.point, nearest.distance)


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
    given: Given = {"a": (a, 3), "b": (b, 3), "c": (c, 3), **_boxes("", lower, upper)}
    axis = _one(_kernels.triangle_aabb, given, (0, np.int32))
    overlap = axis == -1
    return TriangleBox(overlap, np.maximum(axis, np.int32(-1))) if full_output else overlap


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
    return PolygonBox(overlap, by) if full_output else overlap


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
    if not full_output:
        return _one(_kernels.triangle_triangle, given)
    return TrianglesMeeting(*_arrays.elementwise(_kernels.triangle_triangle_segment, given, [_BOOL, _BOOL, 3, 3]))
