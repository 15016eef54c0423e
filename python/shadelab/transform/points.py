"""Points, vectors and normals through matrices, to pixels and back."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels
from .view import picture_size

__all__ = ["normal_matrix", "project", "transform_normals", "transform_points", "transform_vectors", "unproject"]


def normal_matrix(matrix: ArrayLike) -> Floats:
    """The matrix that carries normals, up to a positive factor: the cofactors of the linear part.

    Parameters
    ----------
    matrix : array_like, shape (..., 4, 4)

    Returns
    -------
    ndarray, shape (..., 3, 3)
        The inverse transpose times the magnitude of the determinant, after scaling the largest entry to one.

    Raises
    ------
    TypeError, ValueError
        If the matrix is not real or not 4 by 4.

    Notes
    -----
    It exists where the inverse does not: a scene flattened onto a plane keeps its normals. Mirrored normals point to
    the side that was outside (whose faces then turn clockwise). An all-zero linear part gives NaN.

    References
    ----------
    E. Lengyel, *Foundations of Game Engine Development, volume 1: Mathematics*, 2016, section 1.7.

    Examples
    --------
    >>> from shadelab.transform import scale
    >>> normal_matrix(scale([1.0, 0.0, 1.0]))  # flattened: only the normal along y is left
    array([[0., 0., 0.],
           [0., 1., 0.],
           [0., 0., 0.]])
    """
    return _arrays.elementwise(_kernels.normal_matrix, {"matrix": (matrix, (4, 4))}, [(3, 3)])[0]


def transform_points(
    points: ArrayLike, matrix: ArrayLike, *, homogeneous: bool = False, out: NDArray[Any] | None = None
) -> Floats:
    """Points through a matrix.

    Parameters
    ----------
    points : array_like, shape (..., 3), or (..., 2) in the plane
        Their precision governs.
    matrix : array_like, shape (..., 4, 4), or (..., 3, 3) in the plane
        One for all, or leading axes that broadcast with those of the points.
    homogeneous : bool
        Return all coordinates undivided (clip space, if the matrix projects).
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, of the points' shape, or one coordinate more
        Divided by w unless `homogeneous`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape.

    Notes
    -----
    About 1 ns a point and thread under one matrix. Each coordinate errs by at most 4 rounding units of the sum of
    the magnitudes of its terms.

    Examples
    --------
    >>> from shadelab.transform import translate
    >>> transform_points([1.0, 0, 0], translate([0, 5, 0]))
    array([1., 5., 0.])
    """
    kind = "homogeneous" if _arrays.flag("homogeneous", homogeneous) else "point"
    return _transform("points", points, matrix, kind, out)


def transform_vectors(vectors: ArrayLike, matrix: ArrayLike, *, out: NDArray[Any] | None = None) -> Floats:
    """Directions and differences of points through a matrix: its linear part alone.

    Parameters
    ----------
    vectors : array_like, shape (..., 3), or (..., 2) in the plane
        Their precision governs.
    matrix : array_like, shape (..., 4, 4), or (..., 3, 3) in the plane
        One for all, or leading axes that broadcast with those of the vectors.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, of the vectors' shape
        Lengths are not kept unless the matrix keeps them.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape.

    Examples
    --------
    >>> from shadelab.transform import translate
    >>> transform_vectors([1.0, 0, 0], translate([0, 5, 0]))
    array([1., 0., 0.])
    """
    return _transform("vectors", vectors, matrix, "vector", out)


def transform_normals(normals: ArrayLike, matrix: ArrayLike, *, out: NDArray[Any] | None = None) -> Floats:
    """Normals through a matrix: by `normal_matrix`, then to unit length.

    Parameters
    ----------
    normals : array_like, shape (..., 3)
        Their precision governs.
    matrix : array_like, shape (..., 4, 4)
        The matrix that the surface's points go through.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (..., 3)
        Unit length; NaN where the surface is flattened edge-on.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape.

    Examples
    --------
    >>> from shadelab.transform import scale
    >>> transform_normals([0.6, 0.8, 0.0], scale([2.0, 1.0, 1.0])).round(4)
    array([0.3511, 0.9363, 0.    ])
    """
    return _transform("normals", normals, matrix, "normal", out)


def _pair(
    name: str, given: ArrayLike, matrix: ArrayLike, n: int, dtype: DTypeLike | None = None
) -> tuple[tuple[int, ...], Floats, Floats]:
    """The batch shape, items (count, n) and their matrices (1 or count, n + 1, n + 1)."""
    items = _arrays.vectors(name, given, n)
    m = _arrays.floats("matrix", matrix, items.dtype if dtype is None else dtype)
    if m.shape[-2:] != (n + 1, n + 1):
        raise ValueError(f"matrix: expected shape (..., {n + 1}, {n + 1}) for {name} of {n} components, got {m.shape}")
    if m.ndim == 2:
        return items.shape[:-1], items.reshape(-1, n), m[None]
    shape, (flat, many) = _arrays.broadcast({name: (items, 1), "matrix": (m, 2)})
    return shape, flat, many


def _transform(name: str, given: ArrayLike, matrix: ArrayLike, kind: str, out: NDArray[Any] | None) -> Floats:
    n = 2 if kind != "normal" and _arrays.array(name, given).shape[-1:] == (2,) else 3
    shape, flat, m = _pair(name, given, matrix, n)
    result = _arrays.output("out", out, (*shape, n + (kind == "homogeneous")), flat.dtype)
    flat, m = _arrays.apart(result, flat, m)
    (_kernels.transform if n == 3 else _kernels.transform_2d)(kind, flat, m, result)
    return result


def project(points: ArrayLike, matrix: ArrayLike, size: tuple[int, int], *, out: NDArray[Any] | None = None) -> Floats:
    """Points to the pixels that they appear at.

    Parameters
    ----------
    points : array_like, shape (..., 3)
        Their precision governs.
    matrix : array_like, shape (..., 4, 4)
        Projection times view (times model).
    size : (width, height)
        Of the picture, in pixels.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (..., 3)
        x to the right and y down in pixels, and the depth z/w in the projection's convention.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape.

    Notes
    -----
    Points behind the eye or in its plane (w <= 0) have no pixel and give NaN; points outside the picture are kept.

    Examples
    --------
    >>> from shadelab.transform import look_at, perspective
    >>> camera = perspective(np.pi / 2, near=1.0, far=10.0) @ look_at([0, 0, 5.0], [0, 0, 0])
    >>> project([0.0, 0.0, 4.0], camera, (640, 480))
    array([320., 240.,  -1.])
    """
    shape, flat, m = _pair("points", points, matrix, 3)
    result = _arrays.output("out", out, (*shape, 3), flat.dtype)
    flat, m = _arrays.apart(result, flat, m)
    _kernels.project(flat, m, picture_size(size), result)
    return result


def unproject(
    pixels: ArrayLike, matrix: ArrayLike, size: tuple[int, int], *, out: NDArray[Any] | None = None
) -> Floats:
    """Pixels with their depths back to points: the inverse of `project`.

    Parameters
    ----------
    pixels : array_like, shape (..., 3)
        x, y in pixels and depth z/w. Their precision governs.
    matrix : array_like, shape (..., 4, 4)
        The matrix that projected them; its inverse is taken in double precision.
    size : (width, height)
        Of the picture, in pixels.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (..., 3)

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or the matrix is singular.

    Notes
    -----
    The distance is as accurate as the depth: an error e in z/w becomes about ``e * distance**2 / near`` in the standard
    and the zero-to-one convention.

    Examples
    --------
    >>> from shadelab.transform import look_at, perspective
    >>> camera = perspective(np.pi / 2, near=1.0, far=10.0) @ look_at([0, 0, 5.0], [0, 0, 0])
    >>> np.round(unproject([320.0, 240.0, -1.0], camera, (640, 480)), 9) + 0.0
    array([0., 0., 4.])
    """
    shape, flat, m = _pair("pixels", pixels, matrix, 3, np.float64)
    result = _arrays.output("out", out, (*shape, 3), flat.dtype)
    flat, m = _arrays.apart(result, flat, m)
    _kernels.unproject(flat, m, picture_size(size), result)
    return result
