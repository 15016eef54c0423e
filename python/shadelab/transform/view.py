"""Views: from the world to the eye, and to the pixels of a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels
from ._single import refuse

__all__ = ["change_of_basis", "look_at", "rigid_inverse", "viewport"]


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


def rigid_inverse(matrix: ArrayLike) -> Floats:
    """The inverse of a rigid motion: the rotation transposed, the translation turned back.

    Parameters
    ----------
    matrix : array_like, shape (..., 4, 4)
        A rotation (or a mirror) and a translation, as `look_at` gives.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If the matrix is not real or not 4 by 4; if a single one does not keep lengths and angles to 1e-3. In a batch,
        such elements are NaN.

    Notes
    -----
    The rotation is the transpose to the bit; the translation errs by 2 rounding units of its length, and by as much as
    the rotation departs from orthonormality.

    Examples
    --------
    >>> rigid_inverse(look_at([0, 0, 5.0], [0, 0, 0])) @ [0, 0, 0, 1]  # where the eye is
    array([0., 0., 5., 1.])
    """
    m = _arrays.matrices("matrix", matrix)
    inverse = _arrays.elementwise(_kernels.rigid_inverse, {"matrix": (m, (4, 4))}, [(4, 4)])[0]
    refuse("matrix", m, inverse, "a rigid motion: orthonormal axes to 1e-3, and a last row of 0, 0, 0, 1")
    return inverse


def change_of_basis(x: ArrayLike, y: ArrayLike, z: ArrayLike, origin: ArrayLike = (0.0, 0.0, 0.0)) -> Floats:
    """From world coordinates to those of a frame.

    Parameters
    ----------
    x, y, z : array_like, shape (..., 3)
        The frame's axes in world coordinates: independent, else of any lengths and angles.
    origin : array_like, shape (..., 3)
        The frame's origin. Leading axes broadcast.

    Returns
    -------
    ndarray, shape (..., 4, 4)
        The inverse of the matrix with the columns `x`, `y`, `z`, `origin`, which takes frame coordinates to the world.

    Raises
    ------
    ValueError
        If a single frame's axes lie in a plane: the volume of their unit vectors is below 8 rounding units. In a batch,
        such elements are NaN.
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or leading axes do not broadcast.

    Notes
    -----
    The axes' lengths cost no accuracy, 1e-15 beside 1e15; the error grows as 4 rounding units over the volume of their
    unit vectors.

    Examples
    --------
    >>> change_of_basis([2.0, 0, 0], [0, 1, 0], [0, 0, 1], origin=[1, 0, 0]) @ [5, 3, 0, 1]
    array([2., 3., 0., 1.])
    """
    given = {"x": (x, 3), "y": (y, 3), "z": (z, 3), "origin": (origin, 3)}
    m = _arrays.elementwise(_kernels.change_of_basis, given, [(4, 4)])[0]
    if m.ndim == 2:
        refuse("x, y, z", np.stack([_arrays.floats(n, v) for n, (v, _) in given.items()]), m, "independent axes")
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
        If the size is not of two positive integers, or the origin not of two finite numbers.

    Examples
    --------
    >>> viewport((640, 480)) @ [-1, 1, 0.25, 1]
    array([0.  , 0.  , 0.25, 1.  ])
    """
    corner = _arrays.vectors("origin", origin, 2, np.float64)
    if corner.shape != (2,) or not np.isfinite(corner).all():
        raise ValueError(f"origin: expected two finite numbers, got {origin!r}")
    return np.array(_kernels.viewport(picture_size(size), corner.tolist()))


def picture_size(size: tuple[int, int]) -> list[float]:
    """Width and height as the kernels take them."""
    try:
        width, height = size
    except (TypeError, ValueError):
        raise TypeError(f"size: expected (width, height), got {size!r}") from None
    return [float(_arrays.count("size", n, 1)) for n in (width, height)]
