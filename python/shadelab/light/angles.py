"""Solid angles in closed form."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import light as _kernels

__all__ = ["solid_angle"]

Shape: TypeAlias = Literal["triangle", "polygon", "rectangle", "sphere", "box"]

_PARAMETERS = {
    "triangle": {"a": 3, "b": 3, "c": 3},
    "rectangle": {"center": 3, "edge_u": 3, "edge_v": 3},
    "sphere": {"center": 3, "radius": 0},
    "box": {"low": 3, "high": 3},
    "polygon": {"corners": 3},
}


def solid_angle(shape: Shape, points: ArrayLike, *parameters: ArrayLike) -> Floats:
    """The solid angle in which a shape is seen.

    Parameters
    ----------
    shape : {"triangle", "polygon", "rectangle", "sphere", "box"}
    points : array_like, shape (..., 3)
        Where from.
    *parameters : array_like
        Of a triangle its corners `a`, `b`, `c`; of a rectangle (or parallelogram) its `center` and full edges; of a
        sphere `center` and `radius`; of a box along the axes its lowest and highest corner: all of shape (..., 3) and
        the radius (...), which broadcast with `points`. Of a polygon one array of corners (n, 3), for all points.

    Returns
    -------
    ndarray, shape (...)
        In steradian. In the plane of a flat shape 0 beside it and 2π within it; 4π within a sphere
        or box, and of a box half of it on a face, a quarter on an edge, an eighth on a corner.

    Raises
    ------
    TypeError, ValueError
        If the shape is unknown, its parameters are not those above, or leading axes do not broadcast.

    Notes
    -----
    Computed in double whatever the precision; relative accuracy does not fall with size or distance where differences
    of coordinates are exact. A polygon must be planar and not cross itself; it may be concave. A sphere of negative
    radius, or a box whose lowest corner is not the lowest, gives NaN.

    References
    ----------
    A. van Oosterom, J. Strackee, *The solid angle of a plane triangle*, 1983.

    Examples
    --------
    >>> float(solid_angle("triangle", [0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]) / np.pi)
    0.5
    >>> float(solid_angle("box", [0, 0, 0], [-1, -1, 1], [1, 1, 3]).round(6))
    2.094395
    """
    kind = _arrays.choice("shape", shape, tuple(_PARAMETERS))
    wanted = _PARAMETERS[kind]
    if len(parameters) != len(wanted):
        raise ValueError(f"parameters: expected {', '.join(wanted)} of a {kind}, got {len(parameters)} arrays")
    if kind == "polygon":
        corners = _arrays.vectors("corners", parameters[0], 3, np.float64)
        if corners.ndim != 2 or len(corners) < 3:
            raise ValueError(f"corners: expected shape (n, 3) with n of at least 3, got {corners.shape}")
        from_ = _arrays.vectors("points", points, 3)
        out = np.empty(from_.shape[:-1], from_.dtype)
        _kernels.polygon_solid_angle(corners, from_.reshape(-1, 3), out.reshape(-1))
        return np.abs(out)
    given: dict[str, tuple[ArrayLike, _arrays.Core]] = {"points": (points, 3)}
    given |= {name: (value, n) for (name, n), value in zip(wanted.items(), parameters, strict=True)}
    return _arrays.elementwise(_kernels.solid_angle, given, [0], kind)[0]
