"""What the functions of this chapter take."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats

MAX_SIZE = 16384
"""The largest width and height of a picture, in pixels."""

Cull: TypeAlias = Literal["none", "back", "front"]
Depth: TypeAlias = Literal["standard", "zero_to_one", "reversed"]


def size(size: tuple[int, int]) -> tuple[int, int]:
    try:
        width, height = size
    except (TypeError, ValueError):
        raise ValueError(f"size: expected (width, height), got {size!r}") from None
    return _arrays.count("size", width, 0, MAX_SIZE), _arrays.count("size", height, 0, MAX_SIZE)


def samples(samples: int) -> int:
    if not isinstance(samples, int | np.integer) or samples not in (1, 2, 4, 8):
        raise ValueError(f"samples: expected 1, 2, 4 or 8, got {samples!r}")
    return int(samples)


def clip(clip: ArrayLike) -> Floats:
    array = _arrays.vectors("clip", clip, 4)
    if array.ndim != 2:
        raise ValueError(f"clip: expected shape (n, 4), got {array.shape}")
    return array


def faces(faces: ArrayLike) -> NDArray[np.int32]:
    """Faces as int32; the kernel compares them with the number of vertices."""
    array = _arrays.array("faces", faces)
    if array.dtype != np.int32:
        return _arrays.indices("faces", array.reshape(0, 3) if array.size == 0 else array, 3)
    if array.ndim != 2 or array.shape[-1] != 3:
        raise ValueError(f"faces: expected shape (m, 3), got {array.shape}")
    return np.require(array, requirements=["C", "A"])


def seen_faces(face: ArrayLike) -> NDArray[np.int32]:
    array = np.asarray(face)
    if array.dtype.kind not in "iu":
        raise TypeError(f"raster.face: expected integers, got dtype {array.dtype}")
    return np.require(array, dtype=np.int32, requirements=["C", "A"])


def modes(cull: str, depth: str) -> tuple[str, str]:
    return (
        _arrays.choice("cull", cull, ("none", "back", "front")),
        _arrays.choice("depth", depth, ("standard", "zero_to_one", "reversed")),
    )


def triple(name: str, value: ArrayLike) -> Floats:
    """Three finite doubles."""
    array = _arrays.vectors(name, value, 3, np.float64)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name}: expected three finite numbers, got {value!r}")
    return array
