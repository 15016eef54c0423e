"""Affine matrices: what moves, sizes and slants."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels

__all__ = ["scale", "translate"]


def translate(offset: ArrayLike) -> Floats:
    """The translation by an offset.

    Parameters
    ----------
    offset : array_like, shape (..., 3)

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If the offset is not real or not of three components.

    Examples
    --------
    >>> translate([1.0, 2.0, 3.0]) @ [0, 0, 0, 1]
    array([1., 2., 3., 1.])
    """
    return _arrays.elementwise(_kernels.translate, {"offset": (offset, 3)}, [(4, 4)])[0]


def scale(factors: ArrayLike) -> Floats:
    """The scaling by a factor along each axis.

    Parameters
    ----------
    factors : float or array_like, shape (..., 3)
        One number scales all axes alike.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If the factors are not real or not of three components.

    Examples
    --------
    >>> scale(2.0) @ [1, 2, 3, 1]
    array([2., 4., 6., 1.])
    """
    if np.ndim(factors) == 0:
        factors = np.repeat(_arrays.floats("factors", factors).reshape(1), 3)
    return _arrays.elementwise(_kernels.scale, {"factors": (factors, 3)}, [(4, 4)])[0]
