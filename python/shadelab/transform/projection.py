"""Projections: from the eye to clip space, and distances back from depths."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import transform as _kernels

__all__ = ["Depth", "DepthPrecision", "depth_precision", "linear_depth", "orthographic", "perspective"]


Depth = Literal["standard", "zero_to_one", "reversed"]
_DEPTHS = ("standard", "zero_to_one", "reversed")


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
    planes = _planes(named)
    if planes is not None:
        if fov_y is not None:
            _arrays.number("fov_y", fov_y, above=0, below=np.pi)
            _arrays.number("aspect", aspect, above=0)
        _arrays.number("near", near, above=0)
        if not planes["far"] > planes["near"]:
            raise ValueError(f"far: expected more than near ({planes['near']:g}), got {planes['far']:g}")
        _check_window(planes)
    kernel = _kernels.perspective if fov_y is None else _kernels.perspective_fov
    return _arrays.elementwise(kernel, {n: (v, 0) for n, v in named.items()}, [(4, 4)], depth)[0]


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
    planes = _planes(named)
    if planes is not None:
        for name, value in named.items():
            _arrays.number(name, value)
        _check_window(planes)
        if planes["near"] == planes["far"]:
            raise ValueError(f"far: expected other than near ({planes['near']:g})")
    return _arrays.elementwise(_kernels.orthographic, {n: (v, 0) for n, v in named.items()}, [(4, 4)], depth)[0]


def _planes(named: dict[str, Any]) -> dict[str, float] | None:
    """A single projection's numbers in the precision in which they are computed; None for a batch."""
    dtype = _arrays.result_dtype(**named)
    given = {name: _arrays.floats(name, value, dtype) for name, value in named.items()}
    return None if any(a.ndim for a in given.values()) else {name: float(a) for name, a in given.items()}


def _check_window(planes: dict[str, float]) -> None:
    if "left" in planes and planes["left"] == planes["right"]:
        raise ValueError(f"right: expected other than left ({planes['left']:g})")
    if "left" in planes and planes["bottom"] == planes["top"]:
        raise ValueError(f"top: expected other than bottom ({planes['bottom']:g})")


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
    _kernels.linear_depth(m[2:, 2:].tolist(), list(_arrays.apart(result, d)), [result])
    return result


class DepthPrecision(NamedTuple):
    """What a depth buffer tells apart."""

    step: Floats
    """The distance to the next stored depth away from the eye; infinite where there is none."""
    bits: Floats
    """log2 of one plus distance over step: the bits of the distance that are left, 0 where none is."""


def depth_precision(
    distance: ArrayLike,
    near: ArrayLike,
    far: ArrayLike = np.inf,
    *,
    depth: Depth = "standard",
    storage: Literal["float32", "unorm24", "unorm16"] = "float32",
) -> DepthPrecision:
    """What a depth buffer tells apart at a distance, under a perspective projection.

    Parameters
    ----------
    distance : array_like, shape (...)
        Along the line of sight, in [near, far].
    near, far : array_like, shape (...)
        As in `perspective`; leading axes of all three broadcast.
    depth : {"standard", "zero_to_one", "reversed"}
        The convention, as in `perspective`.
    storage : {"float32", "unorm24", "unorm16"}
        z/w in single precision, or its range in the convention in 2**24 or 2**16 equal steps.

    Returns
    -------
    DepthPrecision
        `step` and `bits`, of the batch's shape. Distances outside [near, far] give NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or arguments do not broadcast, if a convention or storage is unknown.

    Notes
    -----
    The step is about ``distance**2 / near`` times the step of the stored depth: with equal steps, and with single
    precision beside one, precision falls with the distance, and hangs on near; it hardly hangs on far. Reversed depth
    in single precision has steps that shrink with the depth, and keeps 23 to 24 bits of the distance while far is far
    away. This is what the storage holds; rounding in the projection before it can cost as much again.

    References
    ----------
    N. Reed, *Depth Precision Visualized*, 2015.

    Examples
    --------
    At a thousand units standard depth in single precision tells 3 units apart, reversed depth a tenth of a thousandth:

    >>> float(depth_precision(1000.0, 0.01).step.round(3))
    2.989
    >>> float(depth_precision(1000.0, 0.01, depth="reversed").step.round(6))
    9.1e-05
    """
    _arrays.choice("depth", depth, _DEPTHS)
    _arrays.choice("storage", storage, ("float32", "unorm24", "unorm16"))
    given = {"distance": (distance, 0), "near": (near, 0), "far": (far, 0)}
    return DepthPrecision(*_arrays.elementwise(_kernels.depth_precision, given, [0, 0], depth, storage))
