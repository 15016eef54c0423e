"""Affine matrices: what moves, sizes and slants; from parts, and into parts."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels
from ._single import refuse

__all__ = ["Parts", "compose", "decompose", "scale", "shear", "shear_2d", "translate"]


def translate(offset: ArrayLike) -> Floats:
    """The translation by an offset.

    Parameters
    ----------
    offset : array_like, shape (..., 3) or (..., 2)

    Returns
    -------
    ndarray, shape (..., 4, 4), or (..., 3, 3) in the plane

    Raises
    ------
    TypeError, ValueError
        If the offset is not real or not of two or three components.

    Examples
    --------
    >>> translate([1.0, 2.0, 3.0]) @ [0, 0, 0, 1]
    array([1., 2., 3., 1.])
    """
    return _vectors("offset", offset, _kernels.translate, _kernels.translate_2d)


def scale(factors: ArrayLike) -> Floats:
    """The scaling by a factor along each axis.

    Parameters
    ----------
    factors : float or array_like, shape (..., 3) or (..., 2)
        One number scales all axes of space alike.

    Returns
    -------
    ndarray, shape (..., 4, 4), or (..., 3, 3) in the plane

    Raises
    ------
    TypeError, ValueError
        If the factors are not real or not of two or three components.

    Examples
    --------
    >>> scale(2.0) @ [1, 2, 3, 1]
    array([2., 4., 6., 1.])
    """
    given = _arrays.floats("factors", factors)
    if given.ndim == 0:
        factors = np.repeat(given.reshape(1), 3)
    return _vectors("factors", factors, _kernels.scale, _kernels.scale_2d)


def _vectors(name: str, value: ArrayLike, space: Callable[..., None], plane: Callable[..., None]) -> Floats:
    if _arrays.array(name, value).shape[-1:] == (2,):
        return _arrays.elementwise(plane, {name: (value, 2)}, [(3, 3)])[0]
    return _arrays.elementwise(space, {name: (value, 3)}, [(4, 4)])[0]


def shear(
    xy: ArrayLike = 0.0,
    xz: ArrayLike = 0.0,
    yx: ArrayLike = 0.0,
    yz: ArrayLike = 0.0,
    zx: ArrayLike = 0.0,
    zy: ArrayLike = 0.0,
) -> Floats:
    """The shear that adds to each coordinate a part of the others.

    Parameters
    ----------
    xy, xz, yx, yz, zx, zy : array_like, shape (...)
        `xy` times y is added to x, and so on; so `xy` is the tangent of the angle that the y axis leans towards x by.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or leading axes do not broadcast.

    Notes
    -----
    One factor keeps volumes; two or more need not: `xy` with `yx` have the determinant ``1 - xy yx``.

    Examples
    --------
    >>> shear(xy=0.5) @ [0, 2, 0, 1]
    array([1., 2., 0., 1.])
    """
    named = {"xy": xy, "xz": xz, "yx": yx, "yz": yz, "zx": zx, "zy": zy}
    return _arrays.elementwise(_kernels.shear, {n: (v, 0) for n, v in named.items()}, [(4, 4)])[0]


def shear_2d(xy: ArrayLike = 0.0, yx: ArrayLike = 0.0) -> Floats:
    """The shear in the plane.

    Parameters
    ----------
    xy, yx : array_like, shape (...)
        `xy` times y is added to x, `yx` times x to y.

    Returns
    -------
    ndarray, shape (..., 3, 3)

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or leading axes do not broadcast.

    Examples
    --------
    >>> shear_2d(xy=0.5) @ [0, 2, 1]
    array([1., 2., 1.])
    """
    return _arrays.elementwise(_kernels.shear_2d, {"xy": (xy, 0), "yx": (yx, 0)}, [(3, 3)])[0]


class Parts(NamedTuple):
    """What an affine matrix does: shears, then scales, then rotates, then moves."""

    translation: Floats
    """Shape (..., 3)."""
    rotation: Floats
    """A unit quaternion (x, y, z, w), w not negative; shape (..., 4)."""
    scale: Floats
    """Along the axes; shape (..., 3). Negative along x where the matrix mirrors, else not negative."""
    shear: Floats
    """xy, xz, yz as in `shear`; shape (..., 3)."""
    mirrored: NDArray[np.bool_]
    """Whether the matrix turns right hands into left ones; shape (...)."""


def compose(
    translation: ArrayLike = (0.0, 0.0, 0.0),
    rotation: ArrayLike = (0.0, 0.0, 0.0, 1.0),
    scale: ArrayLike = (1.0, 1.0, 1.0),
    shear: ArrayLike = (0.0, 0.0, 0.0),
) -> Floats:
    """The matrix that shears, then scales, then rotates, then moves: a node's transform in glTF, and a shear.

    Parameters
    ----------
    translation : array_like, shape (..., 3)
    rotation : array_like, shape (..., 4)
        A quaternion (x, y, z, w) of any length but zero.
    scale : array_like, shape (..., 3)
        Factors along the axes.
    shear : array_like, shape (..., 3)
        xy, xz, yz as in the function `shear`. Leading axes of all four broadcast.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or leading axes do not broadcast.

    Notes
    -----
    Entries are right to 4 rounding units of the scale, without shear.

    Examples
    --------
    >>> compose([1, 2, 3], scale=[2.0, 2.0, 2.0]) @ [1, 0, 0, 1]
    array([3., 2., 3., 1.])
    """
    given = {"translation": (translation, 3), "rotation": (rotation, 4), "scale": (scale, 3), "shear": (shear, 3)}
    return _arrays.elementwise(_kernels.compose, given, [(4, 4)])[0]


def decompose(matrix: ArrayLike) -> Parts:
    """An affine matrix in parts, the inverse of `compose`.

    Parameters
    ----------
    matrix : array_like, shape (..., 4, 4)
        Affine: its last row is 0, 0, 0, 1.

    Returns
    -------
    Parts
        `compose(*parts[:4])` gives the matrix again.

    Raises
    ------
    TypeError, ValueError
        If the matrix is not real or not 4 by 4; if a single matrix is not affine. In a batch, such elements are NaN.

    Notes
    -----
    Every affine matrix has these parts, mirrored and singular ones too: the columns are made orthonormal one after the
    other (QR), and a column that depends on those before it, up to 4 rounding units of its length, has scale zero;
    axes that are then open are taken near the coordinate axes. Mirroring goes to x by convention, since a matrix does
    not tell which axis was negative. The composed matrix is that given to 8 rounding units of each column's length;
    the parts themselves are as uncertain as that allows: nearly dependent columns have uncertain axes.

    References
    ----------
    S. Thomas, *Decomposing a Matrix into Simple Transformations*, Graphics Gems II, 1991.

    Examples
    --------
    >>> parts = decompose(translate([1, 2, 3]) @ scale([2.0, -3.0, 4.0]))
    >>> parts.translation, parts.scale, bool(parts.mirrored)
    (array([1., 2., 3.]), array([-2.,  3.,  4.]), True)
    """
    m = _arrays.matrices("matrix", matrix)
    parts = Parts(*_arrays.elementwise(_kernels.decompose, {"matrix": (m, (4, 4))}, [3, 4, 3, 3, (0, np.bool_)]))
    refuse("matrix", m, parts.scale, "an affine matrix, whose last row is 0, 0, 0, 1")
    return parts
