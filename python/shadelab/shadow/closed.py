"""Shadows in closed form: what maps, fields and rays are held against."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ..light import DiskLight, PolygonLight, RectLight
from ._fit import _frame_along, _unit
from ._lookup import _points, _result

__all__ = ["half_plane"]

# Corners of the polygon that stands for a disk, of the same area.
_RIM = 512


def half_plane(
    receivers: ArrayLike,
    normals: ArrayLike | None,
    light: RectLight | DiskLight | PolygonLight,
    occluders: ArrayLike,
    *,
    out: Floats | None = None,
) -> Floats:
    """The exact share of a light that is seen past half-planes: no map, no rays, no noise.

    Parameters
    ----------
    receivers : array_like, shape (..., 3)
        Points in the world; their precision is that of the result.
    normals : array_like, shape (..., 3), or None
        Unit normals of the receivers. With them, parts of the light count by the irradiance that they would send, and
        none below the horizon; without, by area.
    light : RectLight, DiskLight or PolygonLight
        Where it is and its outline; whether it shines on both sides does not matter.
    occluders : array_like, shape (k, 3, 3) or (3, 3)
        For each half-plane a point of its edge, the edge's direction, and a direction from the edge into it; they need
        neither be unit nor square to each other.
    out : ndarray, shape (...), optional
        The array to write into.

    Returns
    -------
    ndarray, shape (...)
        The lit fraction in [0, 1]; 1 where nothing would arrive anyway; NaN where a receiver or normal is not finite.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or shape, or the directions of an occluder are parallel.

    Notes
    -----
    The light's polygon is cut by the plane of each half-plane and by the plane through the receiver and its edge; what
    is left is measured, by area or by Lambert's formula. In double, whatever the precision: to 1e-13 for a rectangle.
    A disk is a polygon of 512 corners of its area: to 2e-5. A receiver in an occluder's plane is not hidden by it.
    Cost: clipping the light some four times for each half-plane; what is left falls into more and more pieces.

    References
    ----------
    J. H. Lambert, *Photometria*, 1760. I. Sutherland, G. Hodgman, *Reentrant Polygon Clipping*, 1974.

    Examples
    --------
    A half-plane x < 0 half way up to a light of side 1: a penumbra as wide as the light.

    >>> from shadelab.light import RectLight
    >>> light = RectLight(center=(0, 2, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 1), radiance=(1, 1, 1))
    >>> roof = [[0.0, 1, 0], [0, 0, 1], [-1, 0, 0]]
    >>> half_plane([[-0.5, 0, 0], [-0.25, 0, 0], [0, 0, 0], [0.5, 0, 0]], None, light, roof)
    array([0.  , 0.25, 0.5 , 1.  ])
    """
    corners = _outline(light)
    edges = _arrays.vectors("occluders", occluders, 3, np.float64)
    if edges.shape[-2:] != (3, 3) or edges.ndim > 3:
        raise ValueError(f"occluders: expected shape (k, 3, 3), got {edges.shape}")
    edges = edges.reshape(-1, 3, 3).copy()
    if not np.isfinite(edges).all():
        raise ValueError("occluders: expected finite numbers")
    # Directions of any length: squares of the largest and least are out of range.
    longest = np.abs(edges[:, 1:]).max(-1, keepdims=True)
    edges[:, 1:] /= np.where(longest > 0.0, longest, 1.0)
    lengths = np.linalg.norm(edges[:, 1:], axis=-1).prod(-1)
    flat = ~(np.linalg.norm(np.cross(edges[:, 1], edges[:, 2]), axis=-1) > 1e-9 * lengths)
    if flat.any():
        raise ValueError(f"occluders: the directions of occluder {int(flat.argmax())} are parallel or zero")
    given = {"receivers": receivers} | ({} if normals is None else {"normals": normals})
    shape, points, n = _points(_arrays.result_dtype(**given), receivers, normals)
    result, written = _result(out, shape, points.dtype)
    _kernels.half_plane(corners.tolist(), edges.tolist(), points, n, written)
    return result


def _outline(light: object) -> NDArray[np.float64]:
    """The corners of a flat light."""
    if isinstance(light, RectLight):
        center, u, v = (np.asarray(a, np.float64) for a in (light.center, light.edge_u, light.edge_v))
        return np.array([center + 0.5 * (a * u + b * v) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    if isinstance(light, PolygonLight):
        return np.asarray(light.corners, np.float64)
    if isinstance(light, DiskLight):
        right, up, _ = _frame_along(_unit("light", np.asarray(light.normal, np.float64)))
        turn = 2.0 * np.pi * np.arange(_RIM)[:, None] / _RIM
        # A polygon of n corners at distance r has the area n r² sin(2π / n) / 2.
        radius = light.radius * np.sqrt(2.0 * np.pi / (_RIM * np.sin(2.0 * np.pi / _RIM)))
        return np.asarray(light.center, np.float64) + radius * (np.cos(turn) * right + np.sin(turn) * up)
    raise TypeError(f"light: expected a RectLight, a DiskLight or a PolygonLight, got {type(light).__name__}")
