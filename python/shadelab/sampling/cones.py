"""Directions of the whole sphere and of a cone: warps, inverses, densities."""

from __future__ import annotations

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import sampling as _kernels
from .warps import DiskMethod

__all__ = [
    "cone_to_square",
    "sphere_to_square",
    "square_to_cone",
    "square_to_cone_pdf",
    "square_to_sphere",
    "square_to_sphere_pdf",
]


def square_to_sphere(u: ArrayLike) -> Floats:
    """Points of the unit square onto the unit sphere, areas in constant proportion.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1]: height 1 - 2u, azimuth 2πv.

    Returns
    -------
    ndarray, shape (..., 3)
        Unit vectors.

    Raises
    ------
    TypeError, ValueError
        If `u` is not real or not of two components.

    Notes
    -----
    Within 3 rounding units of 1 of the exact point; near the poles x and y keep their digits.

    References
    ----------
    P. Shirley, *Nonuniform random point sets via warping*, 1992.

    Examples
    --------
    >>> square_to_sphere([[0.0, 0.0], [0.5, 0.0]])
    array([[0., 0., 1.],
           [1., 0., 0.]])
    """
    return _arrays.elementwise(_kernels.square_to_sphere, {"u": (u, 2)}, [3])[0]


def sphere_to_square(directions: ArrayLike) -> Floats:
    """The inverse of `square_to_sphere`.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit vectors.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1).

    Raises
    ------
    TypeError, ValueError
        If `directions` is not real or not of three components.

    Notes
    -----
    Back on the square within 4 rounding units of 1 (v: over the sine of the angle from the pole, where all v meet).

    Examples
    --------
    >>> sphere_to_square([0.0, 1.0, 0.0])
    array([0.5 , 0.25])
    """
    return _arrays.elementwise(_kernels.sphere_to_square, {"directions": (directions, 3)}, [2])[0]


def square_to_sphere_pdf(directions: ArrayLike) -> Floats:
    """The density of `square_to_sphere`'s directions per solid angle, 1/4π everywhere.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit vectors.

    Returns
    -------
    ndarray, shape (...)

    Raises
    ------
    TypeError, ValueError
        If `directions` is not real or not of three components.

    Examples
    --------
    >>> square_to_sphere_pdf([0.0, 0.0, -1.0])
    array(0.07957747)
    """
    return _arrays.elementwise(_kernels.square_to_sphere_pdf, {"directions": (directions, 3)}, [0])[0]


def square_to_cone(u: ArrayLike, angle: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """Points of the unit square onto the directions within an angle of z, areas in constant proportion.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1].
    angle : array_like, shape (...)
        From the axis to the rim, in (0, π]: π/2 is the hemisphere, π the sphere. Others give NaN.
    method : {"concentric", "polar"}
        The disk map underneath, see `square_to_disk`.

    Returns
    -------
    ndarray, shape (..., 3)
        Unit directions.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape, or the method is unknown.

    Notes
    -----
    Within 4 rounding units of 1 of the exact direction, and x and y to a few rounding units of the cone's width: a cone
    of 1e-15 is as even as the hemisphere, in float32 too.

    References
    ----------
    P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996.

    Examples
    --------
    >>> square_to_cone([[0.5, 0.5], [0.75, 0.5]], 0.02).round(6)
    array([[0.     , 0.     , 1.     ],
           [0.01   , 0.     , 0.99995]])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _arrays.elementwise(_kernels.square_to_cone, {"u": (u, 2)}, [3], method, knobs={"angle": angle})[0]


def cone_to_square(directions: ArrayLike, angle: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """The inverse of `square_to_cone`.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions in the cone.
    angle : array_like, shape (...)
        From the axis to the rim, in (0, π].
    method : {"concentric", "polar"}
        That of the map which is inverted.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1).

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape, or the method is unknown.

    Notes
    -----
    Back on the square within 8 rounding units of 1 for cones up to the hemisphere. Towards the whole sphere the rim
    shrinks to the lower pole, where all directions are one.

    Examples
    --------
    >>> cone_to_square([0.0, 0.0, 1.0], 0.5)
    array([0.5, 0.5])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    given = {"directions": (directions, 3)}
    return _arrays.elementwise(_kernels.cone_to_square, given, [2], method, knobs={"angle": angle})[0]


def square_to_cone_pdf(directions: ArrayLike, angle: ArrayLike) -> Floats:
    """The density of `square_to_cone`'s directions per solid angle: constant in the cone, 0 outside.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions.
    angle : array_like, shape (...)
        From the axis to the rim, in (0, π].

    Returns
    -------
    ndarray, shape (...)
        1 / (4π sin²(angle / 2)) within the cone.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of other shape.

    Notes
    -----
    Cones up to the hemisphere are told from outside to 16 machine epsilons of their depth, whatever their size.

    Examples
    --------
    >>> square_to_cone_pdf([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], 0.5)
    array([1.30010026, 0.        ])
    """
    given = {"directions": (directions, 3)}
    return _arrays.elementwise(_kernels.square_to_cone_pdf, given, [0], knobs={"angle": angle})[0]
