"""Rotations: about axes, and by angles."""

from __future__ import annotations

from typing import Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels
from ._single import refuse

__all__ = [
    "EulerAngles",
    "cross_matrix",
    "euler",
    "euler_angles",
    "rotate_2d",
    "rotate_axis",
    "rotate_x",
    "rotate_y",
    "rotate_z",
]


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
    >>> np.round(rotate_axis([0, 0, 1.0], np.pi / 2) @ [1, 0, 0, 1], 12)
    array([0., 1., 0., 1.])
    """
    given = {"axis": (axis, 3), "angle": (angle, 0)}
    return _arrays.elementwise(_kernels.rotate_axis, given, [(4, 4)])[0]


def rotate_x(angle: ArrayLike) -> Floats:
    """The rotation about the x axis, which turns y towards z.

    Parameters
    ----------
    angle : array_like, shape (...)
        Radians.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If the angle is not real.

    Notes
    -----
    Entries are right to 2 ulps. Angles beyond 1e5 (float32) or 1e6 (float64) give NaN.

    Examples
    --------
    >>> np.round(rotate_x(np.pi / 2) @ [0, 1, 0, 1], 12) + 0.0
    array([0., 0., 1., 1.])
    """
    return _arrays.elementwise(_kernels.rotate_coordinate, {"angle": (angle, 0)}, [(4, 4)], 0)[0]


def rotate_y(angle: ArrayLike) -> Floats:
    """The rotation about the y axis, which turns z towards x.

    Parameters
    ----------
    angle : array_like, shape (...)
        Radians.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If the angle is not real.

    Notes
    -----
    Entries are right to 2 ulps. Angles beyond 1e5 (float32) or 1e6 (float64) give NaN.

    Examples
    --------
    >>> np.round(rotate_y(np.pi / 2) @ [0, 0, 1, 1], 12) + 0.0
    array([1., 0., 0., 1.])
    """
    return _arrays.elementwise(_kernels.rotate_coordinate, {"angle": (angle, 0)}, [(4, 4)], 1)[0]


def rotate_z(angle: ArrayLike) -> Floats:
    """The rotation about the z axis, which turns x towards y.

    Parameters
    ----------
    angle : array_like, shape (...)
        Radians.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If the angle is not real.

    Notes
    -----
    Entries are right to 2 ulps. Angles beyond 1e5 (float32) or 1e6 (float64) give NaN.

    Examples
    --------
    >>> np.round(rotate_z(np.pi / 2) @ [1, 0, 0, 1], 12) + 0.0
    array([0., 1., 0., 1.])
    """
    return _arrays.elementwise(_kernels.rotate_coordinate, {"angle": (angle, 0)}, [(4, 4)], 2)[0]


def rotate_2d(angle: ArrayLike) -> Floats:
    """The counter-clockwise rotation in the plane.

    Parameters
    ----------
    angle : array_like, shape (...)
        Radians.

    Returns
    -------
    ndarray, shape (..., 3, 3)

    Raises
    ------
    TypeError, ValueError
        If the angle is not real.

    Examples
    --------
    >>> np.round(rotate_2d(np.pi / 2) @ [1, 0, 1], 12)
    array([0., 1., 1.])
    """
    return _arrays.elementwise(_kernels.rotate_2d, {"angle": (angle, 0)}, [(3, 3)])[0]


def cross_matrix(vectors: ArrayLike) -> Floats:
    """The matrix that takes the cross product with a vector from the left.

    Parameters
    ----------
    vectors : array_like, shape (..., 3)

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Skew-symmetric: `cross_matrix(v) @ p` is `np.cross(v, p)`. For unit `v`, Rodrigues' formula is
        ``I + sin(angle) K + (1 - cos(angle)) K @ K``.

    Raises
    ------
    TypeError, ValueError
        If the vectors are not real or not of three components.

    Examples
    --------
    >>> cross_matrix([0.0, 0.0, 1.0]) @ [1, 0, 0]
    array([0., 1., 0.])
    """
    return _arrays.elementwise(_kernels.cross_matrix, {"vectors": (vectors, 3)}, [(3, 3)])[0]


def euler(angles: ArrayLike, order: str = "XYZ") -> Floats:
    """The rotation by three angles about coordinate axes, in any of the 24 orders.

    Parameters
    ----------
    angles : array_like, shape (..., 3)
        Radians, in the order of `order`.
    order : str
        Three axes, neighbours different. Capital letters name axes that move with the body: "XYZ" is
        ``rotate_x(a) @ rotate_y(b) @ rotate_z(c)``. Small letters name fixed axes: "xyz" turns about x first, and is
        ``rotate_z(c) @ rotate_y(b) @ rotate_x(a)``. The same letters as SciPy's.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If the angles are not real or not three, or there is no such order.

    Notes
    -----
    Entries are right to 3 rounding units. Angles beyond 1e5 (float32) or 1e6 (float64) give NaN.

    Examples
    --------
    Yaw, pitch and roll of a camera that looks down -z, y up:

    >>> np.allclose(euler([0.3, 0.2, 0.1], "YXZ"), rotate_y(0.3) @ rotate_x(0.2) @ rotate_z(0.1))
    True
    """
    return _arrays.elementwise(_kernels.euler, {"angles": (angles, 3)}, [(4, 4)], _order(order))[0]


def _order(order: str) -> str:
    if not isinstance(order, str):
        raise TypeError(f"order: expected a string, got {type(order).__name__}")
    return order


class EulerAngles(NamedTuple):
    """The angles of rotations, and where they are not determined."""

    angles: Floats
    """Radians, shape (..., 3)."""
    gimbal_lock: NDArray[np.bool_]
    """Where the outer axes coincide and only the sum or difference of their angles counts; shape (...)."""


@overload
def euler_angles(matrix: ArrayLike, order: str = "XYZ", *, full_output: Literal[False] = False) -> Floats: ...
@overload
def euler_angles(matrix: ArrayLike, order: str = "XYZ", *, full_output: Literal[True]) -> EulerAngles: ...
def euler_angles(matrix: ArrayLike, order: str = "XYZ", *, full_output: bool = False) -> Floats | EulerAngles:
    """The three angles of a rotation, the inverse of `euler`.

    Parameters
    ----------
    matrix : array_like, shape (..., 4, 4) or (..., 3, 3)
        Rotations; of 4 by 4 matrices the linear part counts.
    order : str
        As in `euler`.
    full_output : bool
        Return also where angles stand at gimbal lock.

    Returns
    -------
    ndarray, shape (..., 3), or EulerAngles
        The outer angles in [-pi, pi]; the middle one in [-pi/2, pi/2], or in [0, pi] where the first axis is also the
        last.

    Raises
    ------
    TypeError, ValueError
        If the matrix is not real or of the wrong shape, or there is no such order; if a single matrix is not a rotation
        (orthonormal to 1e-3, not mirrored). In a batch, such elements are NaN; `decompose` finds their rotation.

    Notes
    -----
    `euler` gives the rotation again to 12 rounding units, everywhere: near gimbal lock the last angle is found with the
    first one undone. The outer angles themselves err by a few rounding units over the sine that tells their axes
    apart. Where that sine is below 8 rounding units the angles stand at gimbal lock, and the last one in the order is
    zero.

    References
    ----------
    K. Shoemake, *Euler Angle Conversion*, Graphics Gems IV, 1994.

    Examples
    --------
    >>> euler_angles(euler([0.3, 0.2, 0.1], "ZXZ"), "ZXZ").round(12)
    array([0.3, 0.2, 0.1])
    >>> found = euler_angles(euler([0.3, np.pi / 2, 0.1], "XYZ"), "XYZ", full_output=True)
    >>> found.angles.round(12), bool(found.gimbal_lock)
    (array([0.4       , 1.57079633, 0.        ]), True)
    """
    m = rotations("matrix", matrix)
    given = {"matrix": (m, (3, 3))}
    found = EulerAngles(*_arrays.elementwise(_kernels.euler_angles, given, [3, (0, np.bool_)], _order(order)))
    refuse("matrix", m, found.angles, "a rotation: orthonormal to 1e-3, not mirrored")
    return found if _arrays.flag("full_output", full_output) else found.angles


def rotations(name: str, value: ArrayLike) -> Floats:
    """The linear part of 4 by 4 matrices, or 3 by 3 matrices as they are."""
    m = _arrays.floats(name, value)
    if m.shape[-2:] not in ((3, 3), (4, 4)):
        raise ValueError(f"{name}: expected shape (..., 4, 4) or (..., 3, 3), got {m.shape}")
    return m[..., :3, :3]
