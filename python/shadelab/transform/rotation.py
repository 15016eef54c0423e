"""Rotations: about axes, and by angles."""

from __future__ import annotations

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels

__all__ = ["rotate_axis"]


def rotate_axis(axis: ArrayLike, angle: ArrayLike) -> Floats:
    """The rotation about an axis through the origin, by Rodrigues' formula.

    Parameters
    ----------
    axis : array_like, shape (..., 3)
        Of any length but zero.
    angle : array_like, shape (...)
        Radians, counter-clockwise as seen against the axis. Leading axes broadcast.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape.

    Notes
    -----
    Entries are right to 4 rounding units; small angles lose nothing, since ``1 - cos`` goes through the half angle.
    A zero axis, and angles beyond 1e5 (float32) or 1e6 (float64), give NaN.

    References
    ----------
    O. Rodrigues, *Des lois géométriques qui régissent les déplacements d'un système solide*, 1840.

    Examples
    --------
    >>> import numpy as np
    >>> np.round(rotate_axis([0, 0, 1.0], np.pi / 2) @ [1, 0, 0, 1], 12)
    array([0., 1., 0., 1.])
    """
    given = {"axis": (axis, 3), "angle": (angle, 0)}
    return _arrays.elementwise(_kernels.rotate_axis, given, [(4, 4)])[0]
