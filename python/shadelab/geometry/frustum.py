"""View frusta: their planes, and what lies inside, outside, or across them."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = ["FrustumSide", "frustum_aabb", "frustum_obb", "frustum_planes", "frustum_sphere"]

_DEPTHS = ("standard", "zero_to_one", "reversed")
Sides = NDArray[np.int8]


class FrustumSide(NamedTuple):
    """How things lie to a frustum."""

    side: Sides
    """1 inside, -1 outside, 0 neither for certain."""
    plane: NDArray[np.int32]
    """The first plane that it lies wholly behind (0-5: left, right, bottom, top, near, far); -1 if none."""


def nine(name: str, rows: ArrayLike) -> ArrayLike:
    """Matrices of 3 x 3 as items of nine numbers, with as much say in the precision as they had."""
    matrices = _arrays.matrices(name, rows, 3)
    flat = matrices.reshape(*matrices.shape[:-2], 9)
    return flat if hasattr(rows, "dtype") else flat.tolist()


def _planes(planes: ArrayLike) -> tuple[ArrayLike, int]:
    array = _arrays.floats("planes", planes)
    if array.shape[-2:] != (6, 4):
        raise ValueError(f"planes: expected shape (..., 6, 4), got {array.shape}")
    flat = array.reshape(*array.shape[:-2], 24)
    return flat if hasattr(planes, "dtype") else flat.tolist(), 24


def _sides(kernel: Any, given: dict[str, tuple[ArrayLike, int]], full_output: bool) -> Sides | FrustumSide:
    result = FrustumSide(*_arrays.elementwise(kernel, given, [(0, np.int8), (0, np.int32)]))
    return result if _arrays.flag("full_output", full_output) else result.side


def frustum_planes(matrix: ArrayLike, *, depth: Literal["standard", "zero_to_one", "reversed"] = "standard") -> Floats:
    """The six planes of what a projection shows.

    Parameters
    ----------
    matrix : array_like, shape (..., 4, 4)
        From the space in which the planes are wanted to clip space: `projection @ view` gives them in world space,
        `projection` alone in eye space.
    depth : {"standard", "zero_to_one", "reversed"}
        The convention of clip space: -w to w from near to far, 0 to w, or w to 0.

    Returns
    -------
    ndarray, shape (..., 6, 4)
        Left, right, bottom, top, near, far as `(n, d)`: a point shows where `n · p + d >= 0` for all six, and that is
        its distance from the plane. Normals are of unit length and point inwards. The far plane of an infinite
        projection is `(0, 0, 0, 1)`, in front of which everything lies.

    Raises
    ------
    TypeError, ValueError
        If the matrix is not real or not 4 x 4; the depth convention is unknown.

    Notes
    -----
    Each coefficient is right to one rounding, for the matrix as given. In float32 the matrix itself has lost the far
    plane of a projection whose far is 1e6 times its near: multiply matrices in float64.

    References
    ----------
    G. Gribb, K. Hartmann, *Fast Extraction of Viewing Frustum Planes from the World-View-Projection Matrix*, 2001.

    Examples
    --------
    >>> from shadelab import transform
    >>> planes = frustum_planes(transform.perspective(fov_y=np.pi / 2, near=1.0, far=10.0))
    >>> np.round(planes[4:], 12) + 0.0
    array([[ 0.,  0., -1., -1.],
           [ 0.,  0.,  1., 10.]])
    """
    _arrays.choice("depth", depth, _DEPTHS)
    array = _arrays.matrices("matrix", matrix)
    flat = array.reshape(*array.shape[:-2], 16)
    (planes,) = _arrays.elementwise(_kernels.frustum_planes, {"matrix": (flat, 16)}, [24], depth)
    return planes.reshape(*array.shape[:-2], 6, 4)


@overload
def frustum_aabb(
    planes: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: Literal[False] = False
) -> Sides: ...
@overload
def frustum_aabb(
    planes: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: Literal[True]
) -> FrustumSide: ...
def frustum_aabb(
    planes: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, full_output: bool = False
) -> Sides | FrustumSide:
    """How axis-aligned boxes lie to a frustum.

    Parameters
    ----------
    planes : array_like, shape (..., 6, 4)
        What `frustum_planes` gives.
    lower, upper : array_like, shape (..., 3)
        The boxes' corners. Leading axes broadcast.
    full_output : bool
        Also tell which plane a box lies behind.

    Returns
    -------
    ndarray of int8, shape (...), or FrustumSide
        1 inside, -1 outside, 0 neither for certain: boxes that cross the frustum's border, that rounding cannot tell,
        and where `lower` exceeds `upper` or a number is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    Conservative both ways, in float32 as in float64: no box with a point that shows is called outside, and a box called
    inside shows to the last corner, in exact arithmetic on the matrix that the planes were made of. A box within 1.2e-7
    (float32) or 2e-15 (float64) of a plane, times the magnitude of its coordinates, is neither. Nor are boxes outside
    that lie beside an edge of the frustum but behind no single plane: of boxes strewn around a frustum that do not
    show, 0.1 % of those with edges of up to a tenth of the far plane's height, 12 % of those with edges as long as
    it. Planes from elsewhere serve as well, of whatever length. About 0.1 µs.

    References
    ----------
    U. Assarsson, T. Möller, *Optimized View Frustum Culling Algorithms for Bounding Boxes*, Journal of Graphics Tools
    5(1), 2000.

    Examples
    --------
    >>> from shadelab import transform
    >>> planes = frustum_planes(transform.perspective(fov_y=np.pi / 2, near=1.0, far=10.0))
    >>> frustum_aabb(planes, [[-1, -1, -5.0], [-1, -1, -2], [-1, -1, 0]], [[1, 1, -4.0], [1, 1, -0.5], [1, 1, 1]])
    array([ 1,  0, -1], dtype=int8)
    """
    given = {"planes": _planes(planes), "lower": (lower, 3), "upper": (upper, 3)}
    return _sides(_kernels.frustum_aabb, given, full_output)


@overload
def frustum_obb(
    planes: ArrayLike,
    center: ArrayLike,
    axes: ArrayLike,
    half_extents: ArrayLike,
    *,
    full_output: Literal[False] = False,
) -> Sides: ...
@overload
def frustum_obb(
    planes: ArrayLike, center: ArrayLike, axes: ArrayLike, half_extents: ArrayLike, *, full_output: Literal[True]
) -> FrustumSide: ...
def frustum_obb(
    planes: ArrayLike, center: ArrayLike, axes: ArrayLike, half_extents: ArrayLike, *, full_output: bool = False
) -> Sides | FrustumSide:
    """How oriented boxes lie to a frustum.

    Parameters
    ----------
    planes : array_like, shape (..., 6, 4)
        What `frustum_planes` gives.
    center : array_like, shape (..., 3)
        The boxes' centres.
    axes : array_like, shape (..., 3, 3)
        Their axes as rows: a box is the set of points `center + x @ axes` with `|x| <= half_extents`.
    half_extents : array_like, shape (..., 3)
        Half their sizes along each axis, not negative. Leading axes broadcast.
    full_output : bool
        Also tell which plane a box lies behind.

    Returns
    -------
    ndarray of int8, shape (...), or FrustumSide
        1 inside, -1 outside, 0 neither for certain: boxes that cross the frustum's border, that rounding cannot tell,
        and where a half extent is negative or a number is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    Conservative as `frustum_aabb`, for the box as given, be its axes orthonormal or not. About 0.15 µs.

    References
    ----------
    U. Assarsson, T. Möller, *Optimized View Frustum Culling Algorithms for Bounding Boxes*, Journal of Graphics Tools
    5(1), 2000.

    Examples
    --------
    >>> from shadelab import transform
    >>> planes = frustum_planes(transform.perspective(fov_y=np.pi / 2, near=1.0, far=10.0))
    >>> turned = [[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1.0]]
    >>> frustum_obb(planes, [[0, 0, -5.0], [4.5, 0, -4], [9, 0, -5]], turned, [1, 1, 1])
    array([ 1,  0, -1], dtype=int8)
    """
    box = {"center": (center, 3), "axes": (nine("axes", axes), 9), "half_extents": (half_extents, 3)}
    return _sides(_kernels.frustum_obb, {"planes": _planes(planes), **box}, full_output)


@overload
def frustum_sphere(
    planes: ArrayLike, center: ArrayLike, radius: ArrayLike, *, full_output: Literal[False] = False
) -> Sides: ...
@overload
def frustum_sphere(
    planes: ArrayLike, center: ArrayLike, radius: ArrayLike, *, full_output: Literal[True]
) -> FrustumSide: ...
def frustum_sphere(
    planes: ArrayLike, center: ArrayLike, radius: ArrayLike, *, full_output: bool = False
) -> Sides | FrustumSide:
    """How balls lie to a frustum.

    Parameters
    ----------
    planes : array_like, shape (..., 6, 4)
        What `frustum_planes` gives.
    center : array_like, shape (..., 3)
        The balls' centres.
    radius : array_like, shape (...)
        Their radii, not negative. Leading axes broadcast.
    full_output : bool
        Also tell which plane a ball lies behind.

    Returns
    -------
    ndarray of int8, shape (...), or FrustumSide
        1 inside, -1 outside, 0 neither for certain: balls that cross the frustum's border, that rounding cannot tell,
        and where the radius is negative or a number is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of its shape, or leading axes do not broadcast.

    Notes
    -----
    Conservative as `frustum_aabb`: balls beside an edge or a corner of the frustum that lie behind no single plane are
    not called outside. About 0.1 µs.

    References
    ----------
    U. Assarsson, T. Möller, *Optimized View Frustum Culling Algorithms for Bounding Boxes*, Journal of Graphics Tools
    5(1), 2000.

    Examples
    --------
    >>> from shadelab import transform
    >>> planes = frustum_planes(transform.perspective(fov_y=np.pi / 2, near=1.0, far=10.0))
    >>> frustum_sphere(planes, [0, 0, -5.0], [3, 4]), frustum_sphere(planes, [0, 0, 3.0], 3.5)
    (array([1, 0], dtype=int8), array(-1, dtype=int8))
    """
    given = {"planes": _planes(planes), "center": (center, 3), "radius": (radius, 0)}
    return _sides(_kernels.frustum_sphere, given, full_output)
