"""Quaternions (x, y, z, w), the real part last as in glTF, SciPy and glam."""

from __future__ import annotations

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels
from ._single import refuse
from .rotation import rotations

__all__ = [
    "quaternion_conjugate",
    "quaternion_from_axis",
    "quaternion_from_matrix",
    "quaternion_inverse",
    "quaternion_multiply",
    "quaternion_rotate",
    "quaternion_slerp",
    "quaternion_to_matrix",
]


def quaternion_from_axis(axis: ArrayLike, angle: ArrayLike) -> Floats:
    """The unit quaternion of a rotation about an axis through the origin.

    Parameters
    ----------
    axis : array_like, shape (..., 3)
        Of any length but zero.
    angle : array_like, shape (...)
        Radians, counter-clockwise as seen against the axis. Leading axes broadcast.

    Returns
    -------
    ndarray, shape (..., 4)
        (sin(angle/2) axis, cos(angle/2)): a full turn changes its sign.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or leading axes do not broadcast.

    Notes
    -----
    Components are right to 2 rounding units. A zero axis, and angles beyond 2e5 (float32) or 2e6 (float64), give NaN.

    References
    ----------
    W. R. Hamilton, *On Quaternions*, 1844.

    Examples
    --------
    >>> quaternion_from_axis([0, 0, 2.0], 0.0)
    array([0., 0., 0., 1.])
    """
    given = {"axis": (axis, 3), "angle": (angle, 0)}
    return _arrays.elementwise(_kernels.quaternion_from_axis, given, [4])[0]


def quaternion_multiply(a: ArrayLike, b: ArrayLike) -> Floats:
    """Hamilton's product: of rotations, `b` first and then `a`, as of matrices.

    Parameters
    ----------
    a, b : array_like, shape (..., 4)
        Leading axes broadcast.

    Returns
    -------
    ndarray, shape (..., 4)
        As long as the product of their lengths.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or leading axes do not broadcast.

    Notes
    -----
    Each component errs by at most 2 rounding units of the product of the lengths. Long chains drift from unit
    length by as much with each product.

    References
    ----------
    W. R. Hamilton, *On Quaternions*, 1844.

    Examples
    --------
    >>> quaternion_multiply([1.0, 0, 0, 0], [0, 1.0, 0, 0])  # i j = k
    array([0., 0., 1., 0.])
    """
    return _arrays.elementwise(_kernels.quaternion_multiply, {"a": (a, 4), "b": (b, 4)}, [4])[0]


def quaternion_conjugate(q: ArrayLike) -> Floats:
    """The conjugate: of unit quaternions, the opposite rotation.

    Parameters
    ----------
    q : array_like, shape (..., 4)

    Returns
    -------
    ndarray, shape (..., 4)
        (-x, -y, -z, w), exactly.

    Raises
    ------
    TypeError, ValueError
        If `q` is not real or not of four components.

    Examples
    --------
    >>> quaternion_conjugate([1.0, 2.0, 3.0, 4.0])
    array([-1., -2., -3.,  4.])
    """
    return _arrays.elementwise(_kernels.quaternion_conjugate, {"q": (q, 4)}, [4])[0]


def quaternion_inverse(q: ArrayLike) -> Floats:
    """The inverse: the conjugate over the squared length.

    Parameters
    ----------
    q : array_like, shape (..., 4)
        Of any length but zero.

    Returns
    -------
    ndarray, shape (..., 4)

    Raises
    ------
    TypeError, ValueError
        If `q` is not real or not of four components.

    Notes
    -----
    Components are right to 4 rounding units of the largest, at lengths whose inverse the precision can hold; beyond
    (subnormal ones) they are infinite or zero. Zero gives NaN.

    Examples
    --------
    >>> quaternion_inverse([0.0, 0.0, 0.0, 4.0])
    array([-0.  , -0.  , -0.  ,  0.25])
    """
    return _arrays.elementwise(_kernels.quaternion_inverse, {"q": (q, 4)}, [4])[0]


def quaternion_rotate(q: ArrayLike, vectors: ArrayLike) -> Floats:
    """Vectors turned by quaternions.

    Parameters
    ----------
    q : array_like, shape (..., 4)
        Of any length but zero, which does not count.
    vectors : array_like, shape (..., 3)
        Leading axes broadcast.

    Returns
    -------
    ndarray, shape (..., 3)

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or leading axes do not broadcast.

    Notes
    -----
    Each component errs by at most 5 rounding units of the vector's length. Many vectors under one rotation go faster
    through `quaternion_to_matrix` and `transform_vectors`.

    Examples
    --------
    >>> quaternion_rotate([0, 0, 1.0, 1.0], [1.0, 0, 0]).round(12)  # a quarter turn about z
    array([0., 1., 0.])
    """
    return _arrays.elementwise(_kernels.quaternion_rotate, {"q": (q, 4), "vectors": (vectors, 3)}, [3])[0]


def quaternion_slerp(a: ArrayLike, b: ArrayLike, t: ArrayLike, *, shortest: bool = True) -> Floats:
    """Rotations between two: at constant speed along the great arc.

    Parameters
    ----------
    a, b : array_like, shape (..., 4)
        Unit quaternions.
    t : array_like, shape (...)
        0 gives `a` and 1 gives `b` (or `-b`, which rotates alike); beyond, the arc goes on. Leading axes broadcast.
    shortest : bool
        Go to the nearer of `b` and `-b`. Else the arc to `b` itself, up to a half turn on the sphere of quaternions and
        a full turn in space.

    Returns
    -------
    ndarray, shape (..., 4)
        Unit quaternions.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or leading axes do not broadcast.

    Notes
    -----
    Components are right to 4 rounding units, however near `a` and `b` are. Zero gives NaN. With `shortest=False`, and
    `b` equal to `-a` up to rounding, the arc's direction is open: some arc is taken, on the sphere.

    References
    ----------
    K. Shoemake, *Animating Rotation with Quaternion Curves*, SIGGRAPH 1985.

    Examples
    --------
    >>> quaternion_slerp([0, 0, 0, 1.0], quaternion_from_axis([0, 0, 1], 1.0), 0.25).round(6)
    array([0.      , 0.      , 0.124675, 0.992198])
    """
    given = {"a": (a, 4), "b": (b, 4), "t": (t, 0)}
    return _arrays.elementwise(_kernels.quaternion_slerp, given, [4], _arrays.flag("shortest", shortest))[0]


def quaternion_to_matrix(q: ArrayLike) -> Floats:
    """The matrix of a rotation.

    Parameters
    ----------
    q : array_like, shape (..., 4)
        Of any length but zero, which does not count.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If `q` is not real or not of four components.

    Notes
    -----
    Entries are right to 6 rounding units. Zero gives NaN.

    Examples
    --------
    >>> quaternion_to_matrix([0, 0, 1.0, 1.0]).round(12)[:2, :2]
    array([[ 0., -1.],
           [ 1.,  0.]])
    """
    return _arrays.elementwise(_kernels.quaternion_to_matrix, {"q": (q, 4)}, [(4, 4)])[0]


def quaternion_from_matrix(matrix: ArrayLike) -> Floats:
    """The unit quaternion of a rotation matrix.

    Parameters
    ----------
    matrix : array_like, shape (..., 4, 4) or (..., 3, 3)
        Rotations; of 4 by 4 matrices the linear part counts.

    Returns
    -------
    ndarray, shape (..., 4)
        With w not negative.

    Raises
    ------
    TypeError, ValueError
        If the matrix is not real or of the wrong shape; if a single matrix is not a rotation (orthonormal to 1e-3, not
        mirrored). In a batch, such elements are NaN; `decompose` finds their rotation.

    Notes
    -----
    Components are right to 4 rounding units at every angle, 0 and pi among them: the largest is found first, and the
    others from sums and differences that do not cancel beside it.

    References
    ----------
    S. W. Shepperd, *Quaternion from Rotation Matrix*, Journal of Guidance and Control 1(3), 1978.

    Examples
    --------
    >>> quaternion_from_matrix([[-1.0, 0, 0], [0, -1, 0], [0, 0, 1]])  # a half turn about z
    array([0., 0., 1., 0.])
    """
    m = rotations("matrix", matrix)
    q = _arrays.elementwise(_kernels.quaternion_from_matrix, {"matrix": (m, (3, 3))}, [4])[0]
    refuse("matrix", m, q, "a rotation: orthonormal to 1e-3, not mirrored")
    return q
