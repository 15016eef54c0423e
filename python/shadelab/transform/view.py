"""Views: from the world to the eye, and to the pixels of a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels

__all__ = ["look_at", "viewport"]


def look_at(eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 1.0, 0.0)) -> Floats:
    """The view matrix of an eye that looks at a target: from world to eye space, where it looks down -z.

    Parameters
    ----------
    eye, target : array_like, shape (..., 3)
        World positions. Leading axes broadcast.
    up : array_like, shape (..., 3)
        What should appear upwards; it may slant, and be of any length.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    ValueError
        If a single view does not exist: `eye` equals `target`, or `up` is parallel to the line of sight (the sine of
        their angle is below 8 rounding units). In a batch, such elements are NaN.
    TypeError, ValueError
        If an argument is not real or not of three components.

    Notes
    -----
    The rotation is orthonormal to 4 rounding units. Near parallel, its roll has an error of a rounding unit over the
    sine of the angle. The translation's error is that of the eye's coordinates: far from the origin, subtract first.

    Examples
    --------
    >>> look_at([0, 0, 5.0], [0, 0, 0]) @ [0, 0, 0, 1]
    array([ 0.,  0., -5.,  1.])
    """
    given = {"eye": (eye, 3), "target": (target, 3), "up": (up, 3)}
    m = _arrays.elementwise(_kernels.look_at, given, [(4, 4)])[0]
    if (
        m.ndim == 2
        and np.isnan(m).any()
        and all(np.isfinite(_arrays.floats(n, v)).all() for n, (v, _) in given.items())
    ):
        if np.array_equal(_arrays.floats("eye", eye, m.dtype), _arrays.floats("target", target, m.dtype)):
            raise ValueError("target: expected a point other than the eye")
        raise ValueError("up: expected a direction not parallel to the line of sight")
    return m


def viewport(size: tuple[int, int], origin: tuple[float, float] = (0.0, 0.0)) -> NDArray[np.float64]:
    """The matrix from normalised device coordinates to pixels: x to the right, y down, z unchanged.

    Parameters
    ----------
    size : (width, height)
        In pixels. Pixel (i, j), row i from the top, has its centre at (j + 0.5, i + 0.5).
    origin : (float, float)
        The pixel coordinates of the top left corner.

    Returns
    -------
    ndarray of float64, shape (4, 4)

    Raises
    ------
    TypeError, ValueError
        If the size is not of two positive integers.

    Examples
    --------
    >>> viewport((640, 480)) @ [-1, 1, 0.25, 1]
    array([0.  , 0.  , 0.25, 1.  ])
    """
    return np.array(_kernels.viewport(picture_size(size), [_arrays.number("origin", x) for x in origin]))


def picture_size(size: tuple[int, int]) -> list[float]:
    """Width and height as the kernels take them."""
    try:
        width, height = size
    except (TypeError, ValueError):
        raise TypeError(f"size: expected (width, height), got {size!r}") from None
    return [float(_arrays.count("size", n, 1)) for n in (width, height)]
