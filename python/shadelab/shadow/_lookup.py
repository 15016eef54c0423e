"""What every lookup coerces alike: the map, the receivers, the bias, the taps."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from ._sets import MapSet
from .maps import ShadowMap, _sides

Kernel: TypeAlias = Literal["vogel", "box", "grid", "tent", "poisson"]
_KERNELS = ("vogel", "box", "grid", "tent", "poisson")
_MAX_SAMPLES = 4096


def _maps(value: Any) -> ShadowMap | MapSet:
    if not isinstance(value, ShadowMap | MapSet):
        raise TypeError(f"shadow_map: expected a ShadowMap or a set of them, got {type(value).__name__}")
    return value


def _granted(
    normals: ArrayLike | None, bias: float, slope_bias: float, normal_offset: float, receiver_plane: bool
) -> tuple[float, float, float, bool]:
    return (
        _arrays.number("bias", bias, 0.0),
        _arrays.number("slope_bias", slope_bias, 0.0),
        _arrays.number("normal_offset", normal_offset, 0.0),
        _arrays.flag("receiver_plane", receiver_plane) and normals is not None,
    )


def _light_sides(maps: ShadowMap | MapSet, light_size: float | tuple[float, float] | None) -> tuple[float, float]:
    """The light's width along the map's right and up; for an orthographic map at a distance of 1."""
    sides = maps.light_size if light_size is None else _sides("light_size", light_size)
    if light_size is None and max(sides) == 0.0:
        raise ValueError("light_size: the map's light has no extent, so its width must be given")
    if isinstance(maps, ShadowMap) and (sides[0] > maps.widest[0] or sides[1] > maps.widest[1]):
        fitted = f"the map was fitted to receivers under a light of at most {maps.widest}"
        raise ValueError(f"light_size: {fitted}, got {sides}; draw it with this light_size")
    if maps.projection != "orthographic":
        return sides
    if max(sides) >= math.pi:
        raise ValueError(f"light_size: expected an angle below pi, got {max(sides):g}")
    return 2.0 * math.tan(sides[0] / 2.0), 2.0 * math.tan(sides[1] / 2.0)


def _receivers(
    shadow_map: ShadowMap | MapSet, receivers: ArrayLike, normals: ArrayLike | None
) -> tuple[tuple[int, ...], Floats, Floats | None]:
    """The batch's shape, points and normals as (n, 3) in the map's precision."""
    return _points(shadow_map.dtype, receivers, normals)


def _points(
    dtype: Any, receivers: ArrayLike, normals: ArrayLike | None
) -> tuple[tuple[int, ...], Floats, Floats | None]:
    """The batch's shape, points and normals as (n, 3)."""
    named = {"receivers": (_arrays.vectors("receivers", receivers, 3, dtype), 1)}
    if normals is not None:
        named["normals"] = (_arrays.vectors("normals", normals, 3, dtype), 1)
    shape, flat = _arrays.broadcast(named)
    return shape, flat[0], flat[1] if normals is not None else None


Look: TypeAlias = "Callable[[Any, tuple[Any, ...], Any, Sequence[Floats]], None]"


def _looked_up(
    maps: ShadowMap | MapSet,
    points: Floats,
    normals: Floats | None,
    granted: tuple[float, float, float, bool],
    results: Sequence[Floats],
    blanks: Sequence[float],
    look: Look,
) -> tuple[NDArray[np.uint8], Floats | None] | None:
    """Calls ``look(map, chart, granted, results)`` for each map; the first of `results` is the lit fraction.

    `blanks` are what receivers get that no map holds. Returns which map each receiver looked into, and the share of the
    one after it; None for a single map.
    """

    def one(m: Any, chosen: Any, to: Sequence[Floats]) -> None:
        look(m, m._chart(chosen), (granted[0] + m.granted, *granted[1:]), to)

    if isinstance(maps, ShadowMap):
        one(maps, None, results)
        return None
    first, after, share = maps._chosen(points)
    for result, blank in zip(results, blanks, strict=True):
        result.fill(blank)
    found = np.bincount(first, minlength=256)
    for i, m in enumerate(maps.maps):
        if found[i]:
            one(m, (first, i), results)
    if found[255]:
        lost = points if normals is None else points + normals
        for result in results:
            result[(first == 255) & np.isnan(lost).any(-1)] = np.nan
    if after is None or share is None:
        return first, None
    both = np.flatnonzero(after != 255)
    if len(both):
        other = np.ones_like(results[0])
        for i in np.unique(after[both]):
            one(maps.maps[i], (after, int(i)), [other])
        results[0][both] += share[both] * (other[both] - results[0][both])
    return first, share


def _result(out: Floats | None, shape: tuple[int, ...], dtype: Any) -> tuple[Floats, Floats]:
    result = _arrays.output("out", out, shape, dtype)
    return result, result.reshape(-1)


def _taps(name: str, kernel: str, samples: int, seed: int | None) -> tuple[str, int, int | None]:
    _arrays.choice("kernel", kernel, _KERNELS)
    n = _arrays.count(name, samples, 1, _MAX_SAMPLES)
    if kernel == "grid" and math.isqrt(n) ** 2 != n:
        raise ValueError(f"{name}: expected a square number for kernel 'grid', got {n}")
    return kernel, n, None if seed is None else _arrays.count("seed", seed, 0, 2**64 - 1)
