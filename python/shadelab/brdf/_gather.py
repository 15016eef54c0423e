"""Vectors and parameters of [0, 1], broadcast together."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats

__all__ = []


def _gather(
    vectors: dict[str, tuple[ArrayLike, int]], scalars: dict[str, ArrayLike], lows: tuple[str, ...] = ()
) -> tuple[tuple[int, ...], list[Floats], np.dtype[Any]]:
    """Vectors and numbers of one element each, broadcast together in their common precision.

    `scalars` are parameters of [0, 1] (above 0 for those named in `lows`): a lone number outside is refused, an
    element of an array outside is left to the kernel, which answers NaN there.
    """
    for name, value in scalars.items():
        if np.ndim(value) == 0 and not isinstance(value, np.ndarray):
            _arrays.number(name, value, 0.0, 1.0, above=0.0 if name in lows else None)
    arrays = {n: v for n, (v, _) in vectors.items()} | scalars
    dtype = _arrays.result_dtype(**{n: v for n, v in arrays.items() if np.ndim(v)})
    core = {n: (_arrays.vectors(n, v, k, dtype), 1) for n, (v, k) in vectors.items()}
    core |= {n: (_arrays.floats(n, v, dtype), 0) for n, v in scalars.items()}
    shape, flat = _arrays.broadcast(core)
    return shape, flat, dtype
