"""Kernels on vectors and parameters of [0, 1], broadcast together."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats

__all__ = []


def lanewise(
    kernel: Callable[..., None],
    vectors: dict[str, tuple[ArrayLike, int]],
    scalars: dict[str, ArrayLike],
    *options: str,
    result: int = 3,
    lows: tuple[str, ...] = (),
) -> Floats:
    """Calls `kernel(*options, given, out)` on vectors and numbers in their common precision.

    Results are vectors of `result` components (0: numbers). `scalars` are parameters of [0, 1] (above 0 for those named
    in `lows`): a lone number outside is refused, an element of an array outside is left to the
    kernel, which answers NaN there.
    """
    arrays = {n: v for n, (v, _) in vectors.items()} | scalars
    batched = {n: v for n, v in arrays.items() if _arrays.array(n, v).ndim}
    for name, value in scalars.items():
        if name not in batched and not isinstance(value, np.ndarray):
            _arrays.number(name, value, 0.0, 1.0, above=0.0 if name in lows else None)
    dtype = _arrays.result_dtype(**batched)
    core = {n: (_arrays.vectors(n, v, k, dtype), 1) for n, (v, k) in vectors.items()}
    core |= {n: (_arrays.floats(n, v, dtype), 0) for n, v in scalars.items()}
    shape, flat = _arrays.broadcast(core, lone=True)
    out = np.empty((*shape, result) if result else shape, dtype)
    kernel(*options, flat, [out])
    return out
