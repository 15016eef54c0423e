"""Vectors: frames about them, angles between them, one along another."""

from __future__ import annotations

from typing import Literal, NamedTuple, overload

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels

__all__ = ["Projection", "angle_between", "orthonormal_basis", "project_onto"]


def orthonormal_basis(normals: ArrayLike) -> Floats:
    """A right-handed frame whose z axis is a normal.

    Parameters
    ----------
    normals : array_like, shape (..., 3)
        Of any length but zero.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Columns: tangent, bitangent, unit normal. So `basis @ local` is in world space, and the transpose takes back.

    Raises
    ------
    TypeError, ValueError
        If the normals are not real or not of three components.

    Notes
    -----
    Orthonormal to 4 rounding units at every normal, with no branch; the tangents jump where z changes its sign, as any
    field of tangents must somewhere.

    References
    ----------
    T. Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.

    Examples
    --------
    >>> orthonormal_basis([0.0, 0.0, -2.0]) + 0.0
    array([[ 1.,  0.,  0.],
           [ 0., -1.,  0.],
           [ 0.,  0., -1.]])
    """
    return _arrays.elementwise(_kernels.orthonormal_basis, {"normals": (normals, 3)}, [(3, 3)])[0]


def angle_between(a: ArrayLike, b: ArrayLike) -> Floats:
    """The angle between two vectors.

    Parameters
    ----------
    a, b : array_like, shape (..., 3)
        Of any length but zero. Leading axes broadcast.

    Returns
    -------
    ndarray, shape (...)
        Radians, in [0, pi].

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Right to 4 rounding units of itself, however small: it is the arc tangent of sine and cosine, and the cross product
    carries its rounding errors along. The arc cosine of the dot product loses half of the digits beside 0 and pi, and
    is NaN where rounding makes it more than one. Vectors of zero, subnormal or infinite length give NaN.

    References
    ----------
    W. Kahan, *How Futile are Mindless Assessments of Roundoff in Floating-Point Computation?*, 2006.

    Examples
    --------
    >>> float(angle_between([1, 0, 0], [1, 1e-9, 0]))
    1e-09
    """
    return _arrays.elementwise(_kernels.angle_between, {"a": (a, 3), "b": (b, 3)}, [0])[0]


class Projection(NamedTuple):
    """A vector in parts along another and across it."""

    length: Floats
    """Signed, along the other's direction; shape (...)."""
    parallel: Floats
    """The part along it, shape (..., 3)."""
    perpendicular: Floats
    """The rest, shape (..., 3)."""


@overload
def project_onto(vectors: ArrayLike, onto: ArrayLike, *, full_output: Literal[False] = False) -> Floats: ...
@overload
def project_onto(vectors: ArrayLike, onto: ArrayLike, *, full_output: Literal[True]) -> Projection: ...
def project_onto(vectors: ArrayLike, onto: ArrayLike, *, full_output: bool = False) -> Floats | Projection:
    """The part of a vector along another.

    Parameters
    ----------
    vectors : array_like, shape (..., 3)
    onto : array_like, shape (..., 3)
        Of any length but zero, which does not count. Leading axes broadcast.
    full_output : bool
        Return also the signed length and the perpendicular part.

    Returns
    -------
    ndarray, shape (..., 3), or Projection

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Both parts err by at most 4 rounding units of the vector's length; so a perpendicular part far shorter than the
    vector has few digits.

    Examples
    --------
    >>> project_onto([3.0, 4.0, 0.0], [10.0, 0.0, 0.0])
    array([3., 0., 0.])
    """
    given = {"vectors": (vectors, 3), "onto": (onto, 3)}
    parts = Projection(*_arrays.elementwise(_kernels.project_onto, given, [0, 3, 3]))
    return parts if _arrays.flag("full_output", full_output) else parts.parallel
