"""Rays against primitives, and barycentric coordinates."""

from __future__ import annotations

from numpy.typing import ArrayLike

from . import _arrays
from ._arrays import Floats
from ._kernels import geometry as _kernels

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
    dtype = _arrays.result_dtype(points=points, a=a, b=b, c=c)
    named = {"points": points, "a": a, "b": b, "c": c}
    shape, flat = _arrays.broadcast({n: (_arrays.vectors(n, v, 3, dtype), 1) for n, v in named.items()})
    out = _arrays.output("out", None, flat[0].shape, dtype)
    _kernels.barycentric(*flat, out)
    return out.reshape(*shape, 3)
