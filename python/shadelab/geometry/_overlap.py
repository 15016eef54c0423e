"""What the overlap tests share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .frustum import nine

__all__ = ["BOOL", "Bools", "Given", "aabb", "obb", "one"]

Bools = NDArray[np.bool_]
Given = dict[str, tuple[ArrayLike, int]]
BOOL = (0, np.bool_)


def aabb(prefix: str, lower: ArrayLike, upper: ArrayLike) -> Given:
    return {f"{prefix}lower": (lower, 3), f"{prefix}upper": (upper, 3)}


def obb(prefix: str, center: ArrayLike, axes: ArrayLike, half: ArrayLike) -> Given:
    flat = nine(f"{prefix}axes", axes)
    return {f"{prefix}center": (center, 3), f"{prefix}axes": (flat, 9), f"{prefix}half_extents": (half, 3)}


def one(kernel: Callable[..., None], given: Given, kind: Any = BOOL) -> Any:
    return _arrays.elementwise(kernel, given, [kind])[0]
