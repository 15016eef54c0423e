"""What every lookup coerces alike: the map, the receivers, the bias, the taps."""

from __future__ import annotations

import math
from typing import Any, Literal, TypeAlias

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .maps import ShadowMap

Kernel: TypeAlias = Literal["vogel", "box", "grid", "tent", "poisson"]
_KERNELS = ("vogel", "box", "grid", "tent", "poisson")
_MAX_SAMPLES = 4096


def _granted(
    shadow_map: ShadowMap,
    normals: ArrayLike | None,
    bias: float,
    slope_bias: float,
    normal_offset: float,
    receiver_plane: bool,
) -> tuple[float, float, float, bool]:
    if not isinstance(shadow_map, ShadowMap):
        raise TypeError(f"shadow_map: expected a ShadowMap, got {type(shadow_map).__name__}")
    return (
        _arrays.number("bias", bias),
        _arrays.number("slope_bias", slope_bias, 0.0),
        _arrays.number("normal_offset", normal_offset, 0.0),
        bool(receiver_plane) and normals is not None,
    )


def _receivers(
    shadow_map: ShadowMap, receivers: ArrayLike, normals: ArrayLike | None
) -> tuple[tuple[int, ...], Floats, Floats | None]:
    """The batch's shape, points and normals as (n, 3) in the map's precision."""
    return _points(shadow_map.depth.dtype, receivers, normals)


def _points(
    dtype: Any, receivers: ArrayLike, normals: ArrayLike | None
) -> tuple[tuple[int, ...], Floats, Floats | None]:
    """The batch's shape, points and normals as (n, 3)."""
    named = {"receivers": (_arrays.vectors("receivers", receivers, 3, dtype), 1)}
    if normals is not None:
        named["normals"] = (_arrays.vectors("normals", normals, 3, dtype), 1)
    shape, flat = _arrays.broadcast(named)
    return shape, flat[0], flat[1] if normals is not None else None


def _result(out: Floats | None, shape: tuple[int, ...], dtype: Any) -> tuple[Floats, Floats]:
    result = _arrays.output("out", out, shape, dtype)
    return result, result.reshape(-1)


def _taps(name: str, kernel: str, samples: int, seed: int | None) -> tuple[str, int, int | None]:
    _arrays.choice("kernel", kernel, _KERNELS)
    n = _arrays.count(name, samples, 1, _MAX_SAMPLES)
    if kernel == "grid" and math.isqrt(n) ** 2 != n:
        raise ValueError(f"{name}: expected a square number for kernel 'grid', got {n}")
    return kernel, n, None if seed is None else _arrays.count("seed", seed, 0, 2**64 - 1)
