"""Polygons: in the plane, and rays at flat ones in space."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = [
    "PolygonHit",
    "PolygonPlace",
    "point_in_polygon",
    "ray_polygon",
    "signed_area",
    "sort_by_angle",
]

Rule = Literal["even_odd", "winding"]


class PolygonPlace(NamedTuple):
    """Where points lie with respect to polygons."""

    inside: NDArray[np.bool_]
    """Whether the point is inside, by the rule and by what was asked for the border."""
    on_border: NDArray[np.bool_]
    """Whether it lies on an edge or a vertex, exactly."""
    winding: NDArray[np.int32]
    """How often the border turns around the point, counter-clockwise positive; 0 on the border."""
    crossings: NDArray[np.int32]
    """How often the ray to the right crosses the border; 0 on the border."""


class PolygonHit(NamedTuple):
    """Where rays meet polygons, and how those lie around them."""

    t: Floats
    """Where the ray meets the polygon, in units of the direction's length; infinite if it does not."""
    normal: Floats
    """The unit normal about which the vertices run counter-clockwise, shape (..., 3); NaN without area."""
    on_border: NDArray[np.bool_]
    """Whether the line passes through the border."""
    winding: NDArray[np.int32]
    """How often the border turns around the line, positive counter-clockwise as seen from the ray: from the front."""
    crossings: NDArray[np.int32]
    """How often a half plane that ends in the line crosses the border; odd inside."""


def _corners(name: str, polygon: ArrayLike, n: int, dtype: Any = None) -> Floats:
    array = _arrays.vectors(name, polygon, n, dtype)
    if array.ndim < 2 or array.shape[-2] == 0:
        raise ValueError(f"{name}: expected shape (..., n, {n}) with vertices, got {array.shape}")
    return array


def _with_polygons(core: dict[str, tuple[Floats, int]], polygon: Floats) -> tuple[tuple[int, ...], list[Floats]]:
    """Broadcast; a single polygon is not copied for every element."""
    if polygon.ndim == 2:
        shape, flat = _arrays.broadcast(core)
        return shape, [*flat, polygon]
    return _arrays.broadcast({**core, "polygon": (polygon, 2)})


@overload
def point_in_polygon(
    points: ArrayLike, polygon: ArrayLike, *, rule: Rule = ..., border: bool = ..., full_output: Literal[False] = ...
) -> NDArray[np.bool_]: ...
@overload
def point_in_polygon(
    points: ArrayLike, polygon: ArrayLike, *, rule: Rule = ..., border: bool = ..., full_output: Literal[True]
) -> PolygonPlace: ...
def point_in_polygon(
    points: ArrayLike,
    polygon: ArrayLike,
    *,
    rule: Rule = "even_odd",
    border: bool = True,
    full_output: bool = False,
) -> NDArray[np.bool_] | PolygonPlace:
    """Tell which points lie in polygons.

    Parameters
    ----------
    points : array_like, shape (..., 2)
        Points.
    polygon : array_like, shape (..., n, 2)
        One polygon for all points, or polygons whose leading axes broadcast with those of the points; the last vertex
        joins the first. Polygons of fewer vertices are filled up by repeating one.
    rule : {"even_odd", "winding"}
        Inside is where a ray crosses the border an odd number of times, or where the border turns around the point.
        They differ only where the border crosses itself.
    border : bool
        Whether points on the border count as inside.
    full_output : bool
        Give `PolygonPlace`: whether the point is on the border, the winding number, the crossings.

    Returns
    -------
    ndarray of bool, shape (...), or PolygonPlace
        Whether points are inside; False where a number is NaN or infinite.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast; the rule is unknown.

    Notes
    -----
    Exact: every side is told by the sign of an exact determinant. Repeated and collinear vertices, spikes, and polygons
    of one or two vertices (which have a border alone) need no care. Coordinates in float64 are to lie between 1e-140
    and 1e150 in size, or be zero; all of float32 will do. Time grows with the number of vertices; no table is
    built.

    References
    ----------
    M. Shimrat, *Algorithm 112: Position of Point Relative to Polygon*, CACM 5(8), 1962. K. Weiler, *An Incremental
    Angle Point in Polygon Test*, Graphics Gems IV, 1994. J. R. Shewchuk, *Adaptive Precision Floating-Point Arithmetic
    and Fast Robust Geometric Predicates*, 1997.

    Examples
    --------
    >>> square = [[0, 0], [2, 0], [2, 2], [0, 2]]
    >>> point_in_polygon([[1, 1], [3, 1], [2, 1]], square)
    array([ True, False,  True])
    """
    _arrays.choice("rule", rule, ("even_odd", "winding"))
    dtype = _arrays.result_dtype(points=points, polygon=polygon)
    corners = _corners("polygon", polygon, 2, dtype)
    shape, flat = _with_polygons({"points": (_arrays.vectors("points", points, 2, dtype), 1)}, corners)
    kinds = (np.bool_, np.bool_, np.int32, np.int32)
    found: list[NDArray[Any]] = [np.empty(shape, kind) for kind in kinds]
    _kernels.point_in_polygon(rule, corners.shape[-2], flat, [x.reshape(-1) for x in found])
    place = PolygonPlace(*found)
    if _arrays.flag("border", border):
        np.logical_or(place.inside, place.on_border, out=place.inside)
    return place if _arrays.flag("full_output", full_output) else place.inside


@overload
def ray_polygon(
    origins: ArrayLike,
    directions: ArrayLike,
    polygon: ArrayLike,
    *,
    rule: Rule = ...,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[False] = ...,
) -> Floats: ...
@overload
def ray_polygon(
    origins: ArrayLike,
    directions: ArrayLike,
    polygon: ArrayLike,
    *,
    rule: Rule = ...,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[True],
) -> PolygonHit: ...
def ray_polygon(
    origins: ArrayLike,
    directions: ArrayLike,
    polygon: ArrayLike,
    *,
    rule: Rule = "even_odd",
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
    full_output: bool = False,
) -> Floats | PolygonHit:
    """Intersect rays with flat polygons, convex or not, from either side.

    Parameters
    ----------
    origins, directions : array_like, shape (..., 3)
        Rays. Directions need not be of unit length.
    polygon : array_like, shape (..., n, 3)
        One polygon for all rays, or polygons whose leading axes broadcast with those of the rays; the last vertex joins
        the first. Polygons of fewer vertices are filled up by repeating one.
    rule : {"even_odd", "winding"}
        What is inside of a polygon that crosses itself, as for `point_in_polygon`.
    t_min, t_max : float or array_like, shape (...)
        Hits lie in the open interval, in units of the direction's length.
    full_output : bool
        Give `PolygonHit`: normal, winding number, crossings and whether the border is met.

    Returns
    -------
    ndarray, shape (...), or PolygonHit
        `t`, infinite where the ray misses.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast; the rule is unknown; a scalar interval
        holds NaN.

    Notes
    -----
    Computed in the promoted precision of rays and polygons. Vertices are brought into the ray's frame, which moves them
    by at most `3.5 eps` of their distance from the origin, alike for every polygon that shares them; there sides are
    told exactly. The border belongs to the polygon: no ray passes between polygons that share edges. Rays in the plane
    miss, and so do rays at polygons without area. `t` is that of the plane with Newell's normal through the mean of the
    vertices; a polygon that is not quite flat is still closed at its edges. NaN or infinity, or a direction of no
    length, give NaN at that element. Directions of every normal length are as good as unit ones.

    References
    ----------
    S. Woop, C. Benthin, I. Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013. T. Akenine-Möller, E. Haines
    et al., *Real-Time Rendering*, 4th edition, 2018, section 22.9.

    Examples
    --------
    >>> corner = [[0, 0, 1], [3, 0, 1], [3, 1, 1], [1, 1, 1], [1, 3, 1], [0, 3, 1]]
    >>> ray_polygon([[0.5, 2, 0], [2, 2, 0]], [0, 0, 1.0], corner)
    array([ 1., inf])
    """
    _arrays.choice("rule", rule, ("even_odd", "winding"))
    dtype = _arrays.result_dtype(origins=origins, directions=directions, polygon=polygon)
    core = {n: (_arrays.vectors(n, v, 3, dtype), 1) for n, v in (("origins", origins), ("directions", directions))}
    core |= {n: (_arrays.knob_array(n, v, dtype), 0) for n, v in (("t_min", t_min), ("t_max", t_max))}
    corners = _corners("polygon", polygon, 3, dtype)
    shape, flat = _with_polygons(core, corners)
    kinds = (dtype, (dtype, 3), np.bool_, np.int32, np.int32)
    found: list[NDArray[Any]] = [np.empty(shape, kind) for kind in kinds]
    _kernels.ray_polygon(rule, corners.shape[-2], flat, [x.reshape(-1) for x in found])
    return PolygonHit(*found) if _arrays.flag("full_output", full_output) else found[0]


def signed_area(polygon: ArrayLike) -> Floats:
    """Area of polygons in the plane, positive where the vertices run counter-clockwise.

    Parameters
    ----------
    polygon : array_like, shape (..., n, 2)
        Vertices in order; the last joins the first. A triangle has three.

    Returns
    -------
    ndarray, shape (...)
        Areas. Where the border crosses itself, each part counts as often as the border turns around it.

    Raises
    ------
    TypeError, ValueError
        If the polygon is not real, not of two components, or has no vertices.

    Notes
    -----
    Right to 2 machine epsilons of itself, plus `n eps²` of the sum of `|x y|` over the border: products and sums carry
    the errors of their rounding, so that polygons far from the origin keep their area. NaN or infinity gives NaN at
    that polygon.

    References
    ----------
    T. Ogita, S. M. Rump, S. Oishi, *Accurate Sum and Dot Product*, SIAM Journal on Scientific Computing 26, 2005.

    Examples
    --------
    >>> float(signed_area([[0, 0], [2, 0], [2, 2], [0, 2]]))
    4.0
    """
    corners = _corners("polygon", polygon, 2)
    shape, (flat,) = _arrays.broadcast({"polygon": (corners, 2)})
    out = np.empty(shape, corners.dtype)
    _kernels.signed_area(corners.shape[-2], flat, out.reshape(-1))
    return out


def sort_by_angle(points: ArrayLike, center: ArrayLike = (0.0, 0.0)) -> NDArray[np.int64]:
    """Order points by their angle about a centre, counter-clockwise from the direction of x.

    Parameters
    ----------
    points : array_like, shape (..., n, 2)
        Sets of points.
    center : array_like, shape (..., 2)
        The centre of each set. Leading axes broadcast.

    Returns
    -------
    ndarray of int64, shape (..., n)
        Indices into each set: `np.take_along_axis(points, order[..., None], -2)` is sorted.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of two components, or does not broadcast.

    Notes
    -----
    Exact: no angle is computed; half planes and the signs of exact determinants order the points. In one direction the
    nearer goes first, equal points keep their order; the centre itself comes before all, points with NaN or infinity
    after all. Coordinates in float64 are to lie between 1e-140 and 1e150 in size, or be zero. Sorting the corners of a
    star-shaped polygon about a point of its kernel gives its border.

    References
    ----------
    R. L. Graham, *An Efficient Algorithm for Determining the Convex Hull of a Finite Planar Set*, Information
    Processing Letters 1, 1972.

    Examples
    --------
    >>> sort_by_angle([[0, -1], [-1, 0], [1, 1], [2, 0]])
    array([3, 2, 1, 0])
    """
    dtype = _arrays.result_dtype(points=points, center=center)
    sets = _arrays.vectors("points", points, 2, dtype)
    if sets.ndim < 2:
        raise ValueError(f"points: expected shape (..., n, 2), got {sets.shape}")
    centers = _arrays.vectors("center", center, 2, dtype)
    shape, flat = _arrays.broadcast({"points": (sets, 2), "center": (centers, 1)})
    out = np.empty((*shape, sets.shape[-2]), np.int64)
    _kernels.sort_by_angle(sets.shape[-2], flat, out.reshape(-1))
    return out
