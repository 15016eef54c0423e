"""Points: where they lie in triangles."""

from __future__ import annotations

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = ["barycentric"]


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
    the triangle's longest edge over its height. A triangle of zero area gives NaN. About 2 ns a point and thread.

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
