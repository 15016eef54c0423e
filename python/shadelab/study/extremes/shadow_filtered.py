"""Extremes of `shadow`: moments of constant depth, two depths close together, 16 bits, tables of sums, any scale."""

from __future__ import annotations

from typing import Any

import numpy as np

from ... import shadow
from ..stability import Measurement, extreme

_DOWN = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
_FILTERS = ("none", "gaussian", "mip", "summed_area")


def _chart(depth: Any, dtype: np.dtype, height: float = 4.0) -> shadow.ShadowMap:
    """A map from above the ground, downwards, over the square [-height, height]²."""
    z = np.asarray(depth, dtype)
    low, high = float(z.min()), float(z.max())
    return shadow.ShadowMap(z, "perspective", [0, height, 0], _DOWN, [-1, 1, -1, 1], low, high)  # type: ignore[arg-type]


def _constant(dtype: np.dtype, kind: Any, knobs: dict[str, Any]) -> Measurement:
    """Receivers on the one surface that the map holds, at any height, darkened by a hundredth."""
    dark, cases = 0, 0
    for height in (1e-6, 1e-2, 4.0, 1e6):
        m = _chart(np.full((33, 33), height), dtype, height)
        x = np.linspace(-0.99, 0.99, 61) * height
        points = np.stack(np.broadcast_arrays(x[:, None], 0.0, x), -1)
        for filter in _FILTERS:
            if filter == "summed_area" and knobs:
                continue
            filtered = shadow.moment_map(m, kind, filter=filter, **knobs)  # type: ignore[call-overload]
            lit = getattr(shadow, kind)(filtered, points, [0.0, 1.0, 0.0])
            dark += int((~(lit > 0.99)).sum())
            cases += lit.size
    return Measurement(dark, cases)


@extreme("shadow.variance", "moments of constant depth", domain="heights 1e-6 to 1e6", unit="count", claim=0)
def _variance(dtype: np.dtype) -> Measurement:
    return _constant(dtype, "variance", {})


@extreme("shadow.exponential_variance", "moments of constant depth", domain="1e-6 to 1e6", unit="count", claim=0)
def _exponential(dtype: np.dtype) -> Measurement:
    return _constant(dtype, "exponential_variance", {})


@extreme("shadow.moment", "moments of constant depth", domain="heights 1e-6 to 1e6", unit="count", claim=0)
def _moment(dtype: np.dtype) -> Measurement:
    return _constant(dtype, "moment", {})


@extreme("shadow.moment", "16-bit moments of constant depth", domain="heights 1e-6 to 1e6", unit="count", claim=0)
def _moment_16(dtype: np.dtype) -> Measurement:
    return _constant(dtype, "moment", {"bits": 16})


@extreme(
    "shadow.moment_bound",
    "two depths close together",
    domain="gaps of 0.01 to 2, shares of 0.1 to 0.9",
    unit="absolute",
    claim={"float32": 2e-3, "float64": 1e-10},
)
def _two_depths(dtype: np.dtype) -> Measurement:
    """How far the share before the farther of two depths is off: the matrix of moments is all but singular."""
    rng = np.random.default_rng(1)
    n = 20_000
    gap = 10 ** rng.uniform(-2, np.log10(2), n)
    low = rng.uniform(-1, 1, n) * (1 - gap / 2) - gap / 2
    return _pairs(np.stack([low, low + gap], -1).astype(dtype), rng.uniform(0.1, 0.9, n))


def _pairs(z: np.ndarray, share: np.ndarray) -> Measurement:
    """How far the share before the farther of two depths is off."""
    w = np.stack([share, 1 - share], -1)
    moments = np.stack([(w * z.astype(np.float64) ** k).sum(-1) for k in (1, 2, 3, 4)], -1).astype(z.dtype)
    bound = shadow.moment_bound(moments, z[:, 1])
    return Measurement(float(np.abs(bound - share).max()), len(z), int((~np.isfinite(bound)).sum()))


@extreme(
    "shadow.moment_bound",
    "two depths, one by an end of the range or at it",
    domain="0 or 1e-16 to 1e-7 from -1 or 1, gaps of 0.02 to 2, shares of 0.1 to 0.9",
    unit="absolute",
    claim={"float32": 1e-3, "float64": 1e-10},
)
def _ends(dtype: np.dtype) -> Measurement:
    rng = np.random.default_rng(2)
    n = 20_000
    off = np.where(rng.random(n) < 0.2, 0.0, 10 ** rng.uniform(-16, -7, n))
    z = np.stack([-1 + off, rng.uniform(-0.98, 1, n)], -1)
    z[::2] = -z[::2, ::-1]
    return _pairs(z.astype(dtype), rng.uniform(0.1, 0.9, n))


@extreme("shadow.variance_soft", "tiny and huge scenes", domain="scales 1e-6 to 1e6", unit="absolute", claim=1e-4)
def _scales(dtype: np.dtype) -> Measurement:
    """The penumbra of a half-plane, in closed form."""
    worst, cases = 0.0, 0
    for scale in (1e-6, 1e-3, 1.0, 1e3, 1e6):
        m = _chart(np.where(np.arange(512) < 256, 2.0, 4.0)[None].repeat(512, 0) * scale, dtype, 4.0 * scale)
        x = np.linspace(-1, 1, 201)
        for kind in ("variance", "moment"):
            table = shadow.moment_map(m, kind, filter="summed_area")
            points = np.stack([x, 0 * x, 0 * x], -1) * scale
            lit = shadow.variance_soft(table, points, light_size=0.8 * scale)
            worst = max(worst, float(np.abs(lit - np.clip(0.5 + x / 0.8, 0, 1)).max()))
            cases += len(x)
    return Measurement(worst, cases)
