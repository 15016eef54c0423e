"""Model, view, projection, viewport: matrices that act on column vectors, and their work on points.

Right-handed, y up; cameras look down -z. Functions that make matrices broadcast their arguments and give
`(..., 4, 4)`; compose with `@`. Matrices made from Python numbers are double; applied to float32 points they are
rounded once, and the points' precision governs.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._arrays import Floats
from ._kernels import transform as _kernels

__all__ = [
    "Depth",
    "linear_depth",
    "look_at",
    "normal_matrix",
    "orthographic",
    "perspective",
    "project",
    "rotate_axis",
    "scale",
    "transform_normals",
    "transform_points",
    "transform_vectors",
    "translate",
    "unproject",
    "viewport",
]

Depth = Literal["standard", "zero_to_one", "reversed"]
_DEPTHS = ("standard", "zero_to_one", "reversed")


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
    return _from_vectors("offset", offset, _kernels.translate)


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
    return _from_vectors("factors", factors, _kernels.scale)


def _from_vectors(name: str, value: ArrayLike, kernel: Any) -> Floats:
    vectors = _arrays.vectors(name, value, 3)
    out = np.empty((*vectors.shape[:-1], 4, 4), vectors.dtype)
    kernel(vectors, out)
    return out


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
    dtype = _arrays.result_dtype(axis=axis, angle=angle)
    core = {"axis": (_arrays.vectors("axis", axis, 3, dtype), 1), "angle": (_arrays.floats("angle", angle, dtype), 0)}
    shape, flat = _arrays.broadcast(core)
    out = np.empty((*shape, 4, 4), dtype)
    _kernels.rotate_axis(*flat, out)
    return out


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
    named = {"eye": eye, "target": target, "up": up}
    # The default and lists of directions have no say.
    dtype = _arrays.result_dtype(**named)
    shape, flat = _arrays.broadcast({n: (_arrays.vectors(n, v, 3, dtype), 1) for n, v in named.items()})
    out = np.empty((*shape, 4, 4), dtype)
    _kernels.look_at(*flat, out)
    if shape == () and np.isfinite(flat).all() and np.isnan(out).any():
        if np.array_equal(flat[0], flat[1]):
            raise ValueError("target: expected a point other than the eye")
        raise ValueError("up: expected a direction not parallel to the line of sight")
    return out


def perspective(
    fov_y: ArrayLike | None = None,
    aspect: ArrayLike = 1.0,
    near: ArrayLike = 0.1,
    far: ArrayLike = np.inf,
    *,
    left: ArrayLike | None = None,
    right: ArrayLike | None = None,
    bottom: ArrayLike | None = None,
    top: ArrayLike | None = None,
    depth: Depth = "standard",
) -> Floats:
    """The perspective projection, from eye space to clip space.

    Parameters
    ----------
    fov_y : array_like, shape (...)
        Vertical field of view in radians, within (0, pi). Or give all of `left`, `right`, `bottom`, `top`.
    aspect : array_like, shape (...)
        Width over height.
    near, far : array_like, shape (...)
        Distances along the line of sight, 0 < near < far; `far` may be infinite.
    left, right, bottom, top : array_like, shape (...)
        The window on the near plane, which need not be centred.
    depth : {"standard", "zero_to_one", "reversed"}
        z/w from -1 at near to 1 at far (OpenGL), from 0 to 1, or from 1 to 0.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or arguments do not broadcast, if neither or both of field and window are given; if a
        single projection's numbers are out of their domain. In a batch, such elements are NaN.

    Notes
    -----
    Entries are right to 4 rounding units, but those of depth lose digits as ``far / (far - near)`` grows. Depth
    precision at a distance hangs on far over near in the standard convention; reversed depth in floating point keeps
    a relative error of the rounding unit at every distance.

    References
    ----------
    N. Reed, *Depth precision visualized*, 2015.

    Examples
    --------
    >>> clip = perspective(np.pi / 2, near=1.0, far=10.0) @ [0, 0, -10, 1]
    >>> float(clip[2] / clip[3])
    1.0
    """
    _arrays.choice("depth", depth, _DEPTHS)
    window = {"left": left, "right": right, "bottom": bottom, "top": top}
    given = [n for n, v in window.items() if v is not None]
    if (fov_y is None) == (not given) or (given and len(given) < 4):
        raise ValueError("fov_y: expected either a field of view, or all of left, right, bottom, top")
    named: dict[str, Any] = {"fov_y": fov_y, "aspect": aspect} if fov_y is not None else window
    named |= {"near": near, "far": far}
    planes, shape = _stack(named)
    if shape == ():
        if fov_y is not None:
            _arrays.number("fov_y", fov_y, above=0, below=np.pi)
            _arrays.number("aspect", aspect, above=0)
        _arrays.number("near", near, above=0)
        if not float(planes[-1]) > float(planes[-2]):
            raise ValueError(f"far: expected more than near ({float(planes[-2]):g}), got {float(planes[-1]):g}")
        _check_window(planes[:4] if fov_y is None else None)
    out = np.empty((*shape, 4, 4), planes.dtype)
    _kernels.perspective(planes, depth, out)
    return out


def orthographic(
    left: ArrayLike,
    right: ArrayLike,
    bottom: ArrayLike,
    top: ArrayLike,
    near: ArrayLike,
    far: ArrayLike,
    *,
    depth: Depth = "standard",
) -> Floats:
    """The orthographic projection, from eye space to clip space.

    Parameters
    ----------
    left, right, bottom, top, near, far : array_like, shape (...)
        The box that fills the picture; `near` and `far` are distances along -z, and may be negative.
    depth : {"standard", "zero_to_one", "reversed"}
        As in `perspective`.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or arguments do not broadcast; if a single box is empty. In a batch, such elements
        are NaN.

    Examples
    --------
    >>> orthographic(-2.0, 2.0, -1.0, 1.0, 0.0, 10.0) @ [2, 1, -10, 1]
    array([1., 1., 1., 1.])
    """
    _arrays.choice("depth", depth, _DEPTHS)
    named = {"left": left, "right": right, "bottom": bottom, "top": top, "near": near, "far": far}
    planes, shape = _stack(named)
    if shape == ():
        for name, value in named.items():
            _arrays.number(name, value)
        _check_window(planes[:4])
        if planes[4] == planes[5]:
            raise ValueError(f"far: expected other than near ({float(planes[4]):g})")
    out = np.empty((*shape, 4, 4), planes.dtype)
    _kernels.orthographic(planes, depth, out)
    return out


def _stack(named: dict[str, Any]) -> tuple[Floats, tuple[int, ...]]:
    """Parameters broadcast and stacked last."""
    dtype = _arrays.result_dtype(**named)
    shape, flat = _arrays.broadcast({n: (_arrays.floats(n, v, dtype), 0) for n, v in named.items()})
    return np.stack(flat, axis=-1).reshape(*shape, len(named)), shape


def _check_window(window: Floats | None) -> None:
    if window is not None:
        if window[0] == window[1]:
            raise ValueError(f"right: expected other than left ({float(window[0]):g})")
        if window[2] == window[3]:
            raise ValueError(f"top: expected other than bottom ({float(window[2]):g})")


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
    out = np.empty((4, 4))
    _kernels.viewport(_size(size), [_arrays.number("origin", x) for x in origin], out)
    return out


def _size(size: tuple[int, int]) -> list[float]:
    try:
        width, height = size
    except (TypeError, ValueError):
        raise TypeError(f"size: expected (width, height), got {size!r}") from None
    return [float(_arrays.count("size", n, 1)) for n in (width, height)]


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
    >>> normal_matrix(scale([1.0, 0.0, 1.0]))  # flattened: only the normal along y is left
    array([[0., 0., 0.],
           [0., 1., 0.],
           [0., 0., 0.]])
    """
    m = _arrays.matrices("matrix", matrix)
    out = np.empty((*m.shape[:-2], 3, 3), m.dtype)
    _kernels.normal_matrix(m, out)
    return out


def transform_points(
    points: ArrayLike, matrix: ArrayLike, *, homogeneous: bool = False, out: NDArray[Any] | None = None
) -> Floats:
    """Points through a matrix.

    Parameters
    ----------
    points : array_like, shape (..., 3)
        Their precision governs.
    matrix : array_like, shape (..., 4, 4)
        One for all, or leading axes that broadcast with those of the points.
    homogeneous : bool
        Return all four coordinates undivided (clip space, if the matrix projects).
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (..., 3) or (..., 4)
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
    >>> transform_points([1.0, 0, 0], translate([0, 5, 0]))
    array([1., 5., 0.])
    """
    kind = "homogeneous" if homogeneous else "point"
    return _transform("points", points, matrix, kind, 4 if homogeneous else 3, out)


def transform_vectors(vectors: ArrayLike, matrix: ArrayLike, *, out: NDArray[Any] | None = None) -> Floats:
    """Directions and differences of points through a matrix: its linear part alone.

    Parameters
    ----------
    vectors : array_like, shape (..., 3)
        Their precision governs.
    matrix : array_like, shape (..., 4, 4)
        One for all, or leading axes that broadcast with those of the vectors.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (..., 3)
        Lengths are not kept unless the matrix keeps them.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape.

    Examples
    --------
    >>> transform_vectors([1.0, 0, 0], translate([0, 5, 0]))
    array([1., 0., 0.])
    """
    return _transform("vectors", vectors, matrix, "vector", 3, out)


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
    >>> transform_normals([0.6, 0.8, 0.0], scale([2.0, 1.0, 1.0])).round(4)
    array([0.3511, 0.9363, 0.    ])
    """
    return _transform("normals", normals, matrix, "normal", 3, out)


def _pair(name: str, given: ArrayLike, matrix: ArrayLike, matrix_dtype: Any) -> tuple[tuple[int, ...], Floats, Floats]:
    """The batch shape, items (n, 3) and their matrices (1 or n, 4, 4)."""
    items = _arrays.vectors(name, given, 3)
    m = _arrays.matrices("matrix", matrix, 4, items.dtype if matrix_dtype is None else matrix_dtype)
    if m.ndim == 2:
        return items.shape[:-1], items.reshape(-1, 3), m[None]
    shape, (flat, many) = _arrays.broadcast({name: (items, 1), "matrix": (m, 2)})
    return shape, flat, many


def _transform(
    name: str, given: ArrayLike, matrix: ArrayLike, kind: str, width: int, out: NDArray[Any] | None
) -> Floats:
    shape, flat, m = _pair(name, given, matrix, None)
    result = _arrays.output("out", out, (*shape, width), flat.dtype)
    _kernels.transform(kind, flat, m, result)
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
    >>> camera = perspective(np.pi / 2, near=1.0, far=10.0) @ look_at([0, 0, 5.0], [0, 0, 0])
    >>> project([0.0, 0.0, 4.0], camera, (640, 480))
    array([320., 240.,  -1.])
    """
    shape, flat, m = _pair("points", points, matrix, None)
    result = _arrays.output("out", out, (*shape, 3), flat.dtype)
    _kernels.project(flat, m, _size(size), result)
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
    >>> camera = perspective(np.pi / 2, near=1.0, far=10.0) @ look_at([0, 0, 5.0], [0, 0, 0])
    >>> np.round(unproject([320.0, 240.0, -1.0], camera, (640, 480)), 9) + 0.0
    array([0., 0., 4.])
    """
    shape, flat, m = _pair("pixels", pixels, matrix, np.float64)
    result = _arrays.output("out", out, (*shape, 3), flat.dtype)
    _kernels.unproject(flat, m, _size(size), result)
    return result


def linear_depth(depth: ArrayLike, projection: ArrayLike, *, out: NDArray[Any] | None = None) -> Floats:
    """The distance along the line of sight that a projection maps to a depth.

    Parameters
    ----------
    depth : array_like, any shape
        z/w as the projection makes it, in its convention. Its precision governs.
    projection : array_like, shape (4, 4)
        From `perspective` or `orthographic`; which convention it is of stands in the matrix itself.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray
        Distances along -z in eye space, not along rays; infinite where an infinite projection's far depth is.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or the matrix is not 4 by 4.

    Notes
    -----
    The relative error is a few rounding units times distance over near in the standard and the zero-to-one convention,
    and a few rounding units at every distance in the reversed one with far infinite.

    Examples
    --------
    >>> linear_depth([-1.0, 1.0], perspective(1.0, near=0.5, far=100.0))
    array([  0.5, 100. ])
    """
    d = _arrays.floats("depth", depth)
    m = _arrays.matrices("projection", projection, 4, d.dtype)
    if m.ndim != 2:
        raise ValueError(f"projection: expected shape (4, 4), got {m.shape}")
    result = _arrays.output("out", out, d.shape, d.dtype)
    _kernels.linear_depth(d, m, result)
    return result
