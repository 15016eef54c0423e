"""What the files of this chapter ask of their arguments."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .. import _arrays

# More numbers than any memory holds; sizes of arrays below do not overflow.
MOST = 2**40


def many(name: str, value: Any, low: int = 0) -> int:
    """How many points or rounds, in [low, 2**40]."""
    return _arrays.count(name, value, low, MOST)


def function(name: str, value: Any) -> None:
    if not callable(value):
        raise TypeError(f"{name}: expected a callable, got {type(value).__name__}")


def unsigned(name: str, value: ArrayLike, dtype: DTypeLike) -> NDArray[Any]:
    """`value` as unsigned integers of `dtype`, refused rather than wrapped where they do not fit."""
    array = _arrays.array(name, value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: expected integers, got dtype {array.dtype}")
    limit = np.iinfo(np.dtype(dtype)).max
    if array.size and (int(array.min()) < 0 or int(array.max()) > limit):
        raise ValueError(f"{name}: expected integers from 0 to {limit}, got {array.min()} … {array.max()}")
    return array.astype(dtype)
