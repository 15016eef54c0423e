"""The unit square warped onto spherical triangles and rectangles, and the change from area to solid angle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, overload

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import sampling as _kernels

__all__ = [
    "DirectionSample",
    "area_to_solid_angle",
    "spherical_rectangle_to_square",
    "spherical_triangle_to_square",
    "square_to_spherical_rectangle",
    "square_to_spherical_rectangle_pdf",
    "square_to_spherical_triangle",
    "square_to_spherical_triangle_pdf",
]


class DirectionSample(NamedTuple):
    """Directions towards a shape, and what it covers of the sphere."""

    direction: Floats
    """Unit, shape (..., 3)."""
    solid_angle: Floats
    """Of the shape; one over it is the density of the directions."""


def _towards(kernel: Callable[..., None], given: dict[str, tuple[ArrayLike, Any]], full_output: bool) -> Any:
    found = DirectionSample(*_arrays.elementwise(kernel, given, [3, 0]))
    return found if full_output else found.direction


@overload
def square_to_spherical_triangle(
    u: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: Literal[False] = False
) -> Floats: ...


@overload
def square_to_spherical_triangle(
    u: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: Literal[True]
) -> DirectionSample: ...


def square_to_spherical_triangle(
    u: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike, *, full_output: bool = False
) -> Floats | DirectionSample:
    """Points of the unit square onto the directions towards a triangle, solid angles in constant proportion.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1]: the share of the area up to an arc through `b`, and the place along that arc (0 is `b`).
    a, b, c : array_like, shape (..., 3)
        The corners as seen from the origin, of any length, either way round. Leading axes broadcast.
    full_output : bool
        Also give the solid angle.

    Returns
    -------
    ndarray, shape (..., 3), or DirectionSample
        Unit directions.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape.

    Notes
    -----
    The solid angle is right to 32 rounding units of itself, or of the longest side's square where the triangle is a
    sliver, however small it is; the directions to a few rounding units of 1. Triangles that see the origin in their
    plane, or of no area, give NaN. Angular sizes, and ratios of the corners' distances, below 1e-15 leave the range of
    float32's squares (1e-120 in float64).

    References
    ----------
    J. Arvo, *Stratified sampling of spherical triangles*, 1995.
    A. van Oosterom, J. Strackee, *The solid angle of a plane triangle*, 1983.

    Examples
    --------
    >>> found = square_to_spherical_triangle([0.0, 1.0], [1, 0, 0], [0, 1, 0], [0, 0, 1], full_output=True)
    >>> found.direction.round(15) + 0.0, found.solid_angle
    (array([1., 0., 0.]), array(1.57079633))
    """
    given = {"u": (u, 2), "a": (a, 3), "b": (b, 3), "c": (c, 3)}
    return _towards(_kernels.square_to_spherical_triangle, given, full_output)


def spherical_triangle_to_square(directions: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike) -> Floats:
    """The inverse of `square_to_spherical_triangle`.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions in the triangle.
    a, b, c : array_like, shape (..., 3)
        The corners as seen from the origin.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1); at `b` itself, where all u meet, u is arbitrary.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape.

    Notes
    -----
    A direction's rounding counts over the triangle's angular size.

    Examples
    --------
    >>> corners = [1, 0, 0], [0, 1, 0], [0, 0, 1]
    >>> spherical_triangle_to_square(square_to_spherical_triangle([0.25, 0.75], *corners), *corners)
    array([0.25, 0.75])
    """
    given = {"directions": (directions, 3), "a": (a, 3), "b": (b, 3), "c": (c, 3)}
    return _arrays.elementwise(_kernels.spherical_triangle_to_square, given, [2])[0]


def square_to_spherical_triangle_pdf(directions: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike) -> Floats:
    """The density of `square_to_spherical_triangle`'s directions per solid angle.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions.
    a, b, c : array_like, shape (..., 3)
        The corners as seen from the origin.

    Returns
    -------
    ndarray, shape (...)
        One over the triangle's solid angle towards it, else 0.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape.

    Notes
    -----
    The sides count as inside, 16 machine epsilons wide.

    Examples
    --------
    >>> square_to_spherical_triangle_pdf([[0.6, 0.48, 0.64], [0, 0.6, -0.8]], [1, 0, 0], [0, 1, 0], [0, 0, 1])
    array([0.63661977, 0.        ])
    """
    given = {"directions": (directions, 3), "a": (a, 3), "b": (b, 3), "c": (c, 3)}
    return _arrays.elementwise(_kernels.square_to_spherical_triangle_pdf, given, [0])[0]


@overload
def square_to_spherical_rectangle(
    u: ArrayLike, center: ArrayLike, edge_u: ArrayLike, edge_v: ArrayLike, *, full_output: Literal[False] = False
) -> Floats: ...


@overload
def square_to_spherical_rectangle(
    u: ArrayLike, center: ArrayLike, edge_u: ArrayLike, edge_v: ArrayLike, *, full_output: Literal[True]
) -> DirectionSample: ...


def square_to_spherical_rectangle(
    u: ArrayLike, center: ArrayLike, edge_u: ArrayLike, edge_v: ArrayLike, *, full_output: bool = False
) -> Floats | DirectionSample:
    """Points of the unit square onto the directions towards a rectangle, solid angles in constant proportion.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1]: along `edge_u` and along `edge_v`.
    center : array_like, shape (..., 3)
        The rectangle's centre as seen from the origin.
    edge_u, edge_v : array_like, shape (..., 3)
        Its full edges, perpendicular. Leading axes broadcast.
    full_output : bool
        Also give the solid angle.

    Returns
    -------
    ndarray, shape (..., 3), or DirectionSample
        Unit directions.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape.

    Notes
    -----
    The solid angle is right to a few rounding units of itself, and directions to a few rounding units of 1, for
    small, distant, wide and grazing rectangles alike, in float32 too. Edges more than 1e-3 from perpendicular, and an
    origin in the rectangle's plane, give NaN.

    References
    ----------
    C. Ureña, M. Fajardo, A. King, *An area-preserving parametrization for spherical rectangles*, 2013.

    Examples
    --------
    >>> found = square_to_spherical_rectangle([0.5, 0.5], [0, 0, 1], [2, 0, 0], [0, 2, 0], full_output=True)
    >>> found.direction, found.solid_angle
    (array([0., 0., 1.]), array(2.0943951))
    """
    given = {"u": (u, 2), "center": (center, 3), "edge_u": (edge_u, 3), "edge_v": (edge_v, 3)}
    return _towards(_kernels.square_to_spherical_rectangle, given, full_output)


def spherical_rectangle_to_square(
    directions: ArrayLike, center: ArrayLike, edge_u: ArrayLike, edge_v: ArrayLike
) -> Floats:
    """The inverse of `square_to_spherical_rectangle`.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions towards the rectangle; others are moved to its nearest edge.
    center, edge_u, edge_v : array_like, shape (..., 3)
        Its centre as seen from the origin, and its full edges.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1); NaN for directions away from the plane.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape.

    Notes
    -----
    A direction's rounding counts over the rectangle's angular size.

    Examples
    --------
    >>> spherical_rectangle_to_square([0, 0, 1], [0, 0, 1], [2, 0, 0], [0, 2, 0])
    array([0.5, 0.5])
    """
    given = {"directions": (directions, 3), "center": (center, 3), "edge_u": (edge_u, 3), "edge_v": (edge_v, 3)}
    return _arrays.elementwise(_kernels.spherical_rectangle_to_square, given, [2])[0]


def square_to_spherical_rectangle_pdf(
    directions: ArrayLike, center: ArrayLike, edge_u: ArrayLike, edge_v: ArrayLike
) -> Floats:
    """The density of `square_to_spherical_rectangle`'s directions per solid angle.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions.
    center, edge_u, edge_v : array_like, shape (..., 3)
        The rectangle's centre as seen from the origin, and its full edges.

    Returns
    -------
    ndarray, shape (...)
        One over the rectangle's solid angle towards it, else 0.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape.

    Notes
    -----
    The edges count as inside, as wide as a direction's rounding.

    Examples
    --------
    >>> square_to_spherical_rectangle_pdf([[0, 0, 1], [0, 0, -1]], [0, 0, 1], [2, 0, 0], [0, 2, 0])
    array([0.47746483, 0.        ])
    """
    given = {"directions": (directions, 3), "center": (center, 3), "edge_u": (edge_u, 3), "edge_v": (edge_v, 3)}
    return _arrays.elementwise(_kernels.square_to_spherical_rectangle_pdf, given, [0])[0]


def area_to_solid_angle(
    density: ArrayLike,
    points: ArrayLike,
    normals: ArrayLike,
    origins: ArrayLike = (0.0, 0.0, 0.0),
    *,
    inverse: bool = False,
) -> Floats:
    """A density per area of a surface as one per solid angle of a point that sees it.

    Parameters
    ----------
    density : array_like, shape (...)
        Per area at `points` (`inverse`: per solid angle).
    points, normals : array_like, shape (..., 3)
        On the surface; normals need not be unit, and point either way.
    origins : array_like, shape (..., 3)
        Where the surface is seen from. Leading axes broadcast.
    inverse : bool
        From solid angle to area instead.

    Returns
    -------
    ndarray, shape (...)
        `density` r² / abs(cos θ): infinite where the surface is seen edge-on.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape.

    Notes
    -----
    Right to 8 rounding units of itself as far as `points - origins` is exact; distances of 1e-18 and 1e18 hold.

    References
    ----------
    M. F. Cohen, J. R. Wallace, *Radiosity and Realistic Image Synthesis*, 1993, section 2.4.

    Examples
    --------
    >>> area_to_solid_angle(0.25, [0, 0, 2], [0, 0, 1])
    array(1.)
    """
    given = {"density": (density, 0), "points": (points, 3), "normals": (normals, 3), "origins": (origins, 3)}
    return _arrays.elementwise(_kernels.area_to_solid_angle, given, [0], bool(inverse))[0]
