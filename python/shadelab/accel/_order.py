"""Faces by their distance from an eye: what trees over space know."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import accel as _kernels

__all__ = ["Order", "order"]


class Order(NamedTuple):
    """Faces, or fragments of faces, in the order of their distance from an eye."""

    face: NDArray[np.int32]
    """The face of each, (n,)."""
    triangles: Floats
    """Their corners, (n, 3, 3), wound like their faces."""


def order(tree: Any, dtype: np.dtype[Any], eye: ArrayLike, front_to_back: bool) -> Order:
    e = _arrays.vectors("eye", eye, 3, dtype)
    if e.shape != (3,) or not np.isfinite(e).all():
        raise ValueError(f"eye: expected a finite point, got {e.tolist()}")
    step = 1 if _arrays.flag("front_to_back", front_to_back) else -1
    face, corners = _kernels.order(tree, e)
    return Order(np.ascontiguousarray(face[::step]), np.ascontiguousarray(corners.reshape(-1, 3, 3)[::step]))
