"""The unit square warped onto disks, triangles and directions: inverses and densities."""

from __future__ import annotations

from typing import Literal, TypeAlias

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import sampling as _kernels

__all__ = [
    "cosine_hemisphere_to_square",
    "disk_to_square",
    "hemisphere_to_square",
    "square_to_cosine_hemisphere",
    "square_to_cosine_hemisphere_pdf",
    "square_to_disk",
    "square_to_disk_pdf",
    "square_to_hemisphere",
    "square_to_hemisphere_pdf",
    "square_to_triangle",
    "square_to_triangle_pdf",
    "triangle_to_square",
]

DiskMethod: TypeAlias = Literal["concentric", "polar"]
TriangleMethod: TypeAlias = Literal["fold", "root"]


def square_to_disk(u: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """Points of the unit square onto the unit disk, areas in constant proportion.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1].
    method : {"concentric", "polar"}
        Squares become circles, neighbours stay together; or radius √u and angle 2πv, torn along a radius.

    Returns
    -------
    ndarray, shape (..., 2)
        Points, no farther from the centre than one, up to rounding.

    Raises
    ------
    TypeError, ValueError
        If `u` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Within 3 rounding units of 1 of the exact point (4 for "polar"). About 10 ns a point and thread in float32,
    20 in float64.

    References
    ----------
    P. Shirley, K. Chiu, *A low distortion map between disk and square*, 1997.

    Examples
    --------
    >>> square_to_disk([[0.5, 0.5], [1.0, 0.5]])
    array([[0., 0.],
           [1., 0.]])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _arrays.elementwise(_kernels.square_to_disk, {"u": (u, 2)}, [2], method)[0]


def disk_to_square(points: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """The inverse of `square_to_disk`.

    Parameters
    ----------
    points : array_like, shape (..., 2)
        In the unit disk.
    method : {"concentric", "polar"}
        That of the map which is inverted.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1).

    Raises
    ------
    TypeError, ValueError
        If `points` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Back on the square within 4 rounding units of 1. About 20 ns a point and thread in float32, 40 in float64.

    Examples
    --------
    >>> disk_to_square([0.5, 0.0])
    array([0.75, 0.5 ])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _arrays.elementwise(_kernels.disk_to_square, {"points": (points, 2)}, [2], method)[0]


def square_to_disk_pdf(points: ArrayLike) -> Floats:
    """The density of `square_to_disk`'s points per area: 1/π in the disk, 0 outside.

    Parameters
    ----------
    points : array_like, shape (..., 2)

    Returns
    -------
    ndarray, shape (...)

    Raises
    ------
    TypeError, ValueError
        If `points` is not real or not of two components.

    Notes
    -----
    The rim counts as inside, four rounding units wide.

    Examples
    --------
    >>> square_to_disk_pdf([[0.5, 0.0], [1.5, 0.0]])
    array([0.31830989, 0.        ])
    """
    return _arrays.elementwise(_kernels.square_to_disk_pdf, {"points": (points, 2)}, [0])[0]


def square_to_triangle(u: ArrayLike, method: TriangleMethod = "fold") -> Floats:
    """Points of the unit square onto barycentrics (u, v), areas in constant proportion.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1].
    method : {"fold", "root"}
        Folding the square (little distortion, no root), or (1 - √s, t√s), which keeps lines through one corner.

    Returns
    -------
    ndarray, shape (..., 2)
        u, v ≥ 0 with u + v ≤ 1: the point (1 - u - v) a + u b + v c of a triangle a, b, c.

    Raises
    ------
    TypeError, ValueError
        If `u` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Within 1 rounding unit of 1. About 3 ns a point and thread in float32, 5 in float64.

    References
    ----------
    E. Heitz, *A low-distortion map between triangle and square*, 2019 ("fold").
    P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996 ("root").

    Examples
    --------
    >>> square_to_triangle([[0.5, 0.5], [0.0, 1.0]])
    array([[0.25, 0.25],
           [0.  , 1.  ]])
    """
    _arrays.choice("method", method, ("fold", "root"))
    return _arrays.elementwise(_kernels.square_to_triangle, {"u": (u, 2)}, [2], method)[0]


def triangle_to_square(barycentrics: ArrayLike, method: TriangleMethod = "fold") -> Floats:
    """The inverse of `square_to_triangle`.

    Parameters
    ----------
    barycentrics : array_like, shape (..., 2)
        u, v ≥ 0 with u + v ≤ 1.
    method : {"fold", "root"}
        That of the map which is inverted.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1).

    Raises
    ------
    TypeError, ValueError
        If `barycentrics` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Back on the square within 2 rounding units of 1; "root" is singular at u = 1, where all t meet, and near it
    returns t within a rounding unit over √s. About 3 ns a point and thread in float32, 10 in
    float64.

    Examples
    --------
    >>> triangle_to_square([0.25, 0.25])
    array([0.5, 0.5])
    """
    _arrays.choice("method", method, ("fold", "root"))
    return _arrays.elementwise(_kernels.triangle_to_square, {"barycentrics": (barycentrics, 2)}, [2], method)[0]


def square_to_triangle_pdf(barycentrics: ArrayLike) -> Floats:
    """The density of `square_to_triangle`'s barycentrics: 2 in the triangle, 0 outside.

    Parameters
    ----------
    barycentrics : array_like, shape (..., 2)

    Returns
    -------
    ndarray, shape (...)
        Of a triangle in space, the density per area is one over its area instead.

    Raises
    ------
    TypeError, ValueError
        If `barycentrics` is not real or not of two components.

    Examples
    --------
    >>> square_to_triangle_pdf([[0.25, 0.25], [0.75, 0.75]])
    array([2., 0.])
    """
    return _arrays.elementwise(_kernels.square_to_triangle_pdf, {"barycentrics": (barycentrics, 2)}, [0])[0]


def square_to_cosine_hemisphere(u: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """Points of the unit square onto directions about z, in proportion to the cosine.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1].
    method : {"concentric", "polar"}
        The disk map underneath, see `square_to_disk`.

    Returns
    -------
    ndarray, shape (..., 3)
        Unit directions with z ≥ 0; z = 0 only from the square's border ("polar": from u = 1).

    Raises
    ------
    TypeError, ValueError
        If `u` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Within 3 rounding units of 1 ("polar": 4), and z to 2 rounding units of itself down to the
    horizon. About 10 ns a point and thread in float32, 20 in float64.

    References
    ----------
    Malley's method, in P. Shirley, R. L. Morley, *Realistic Ray Tracing*, 2003.

    Examples
    --------
    >>> square_to_cosine_hemisphere([0.5, 0.5])
    array([0., 0., 1.])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _arrays.elementwise(_kernels.square_to_cosine_hemisphere, {"u": (u, 2)}, [3], method)[0]


def cosine_hemisphere_to_square(directions: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """The inverse of `square_to_cosine_hemisphere`.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions with z ≥ 0.
    method : {"concentric", "polar"}
        That of the map which is inverted.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1).

    Raises
    ------
    TypeError, ValueError
        If `directions` is not real or not of three components, or the method is unknown.

    Notes
    -----
    Back on the square within 4 rounding units of 1. About 20 ns a direction and thread in float32, 35 in float64.

    Examples
    --------
    >>> cosine_hemisphere_to_square([0.0, 0.0, 1.0])
    array([0.5, 0.5])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _arrays.elementwise(_kernels.cosine_hemisphere_to_square, {"directions": (directions, 3)}, [2], method)[0]


def square_to_cosine_hemisphere_pdf(directions: ArrayLike) -> Floats:
    """The density of `square_to_cosine_hemisphere`'s directions per solid angle: cos θ / π, 0 below the horizon.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions.

    Returns
    -------
    ndarray, shape (...)

    Raises
    ------
    TypeError, ValueError
        If `directions` is not real or not of three components.

    Examples
    --------
    >>> square_to_cosine_hemisphere_pdf([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    array([0.31830989, 0.        ])
    """
    return _arrays.elementwise(_kernels.square_to_cosine_hemisphere_pdf, {"directions": (directions, 3)}, [0])[0]


def square_to_hemisphere(u: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """Points of the unit square onto the hemisphere about z, areas in constant proportion.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1].
    method : {"concentric", "polar"}
        The disk map underneath, see `square_to_disk`.

    Returns
    -------
    ndarray, shape (..., 3)
        Unit directions with z ≥ 0; z = 0 only from the square's border ("polar": from u = 1).

    Raises
    ------
    TypeError, ValueError
        If `u` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Within 4 rounding units of 1 (5 for "polar"), and z to 2 rounding units of itself down to the horizon.

    References
    ----------
    P. Shirley, K. Chiu, *A low distortion map between disk and square*, 1997.

    Examples
    --------
    >>> square_to_hemisphere([[0.5, 0.5], [1.0, 0.5]])
    array([[0., 0., 1.],
           [1., 0., 0.]])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _arrays.elementwise(_kernels.square_to_hemisphere, {"u": (u, 2)}, [3], method)[0]


def hemisphere_to_square(directions: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """The inverse of `square_to_hemisphere`.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit, above the horizon.
    method : {"concentric", "polar"}
        That of the map which is inverted.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1).

    Raises
    ------
    TypeError, ValueError
        If `directions` is not real or not of three components, or the method is unknown.

    Notes
    -----
    Back on the square within 6 rounding units of 1 (the angle of "polar": over the distance from the pole).

    Examples
    --------
    >>> hemisphere_to_square([0.0, 0.0, 1.0])
    array([0.5, 0.5])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _arrays.elementwise(_kernels.hemisphere_to_square, {"directions": (directions, 3)}, [2], method)[0]


def square_to_hemisphere_pdf(directions: ArrayLike) -> Floats:
    """The density of `square_to_hemisphere`'s directions per solid angle: 1/2π above the horizon, 0 below.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions.

    Returns
    -------
    ndarray, shape (...)

    Raises
    ------
    TypeError, ValueError
        If `directions` is not real or not of three components.

    Examples
    --------
    >>> square_to_hemisphere_pdf([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    array([0.15915494, 0.        ])
    """
    return _arrays.elementwise(_kernels.square_to_hemisphere_pdf, {"directions": (directions, 3)}, [0])[0]
