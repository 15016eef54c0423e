"""Extremes of `color`: the ends of the curves, negative light, infinity."""

from __future__ import annotations

import numpy as np

from ... import color
from ..stability import Measurement, extreme, ulps


def _signal(dtype: np.dtype) -> np.ndarray:
    """Tiny to large values, and both sides of each join."""
    joins = np.array([0.0031308, 0.04045])
    near = (joins[:, None] * (1 + np.linspace(-1e-3, 1e-3, 501))).ravel()
    wide = np.concatenate([[0.0], np.logspace(-37, 6, 4000), near, np.linspace(0, 1, 4001)])
    return np.concatenate([wide, -wide]).astype(dtype)


def _exact_encode(x: np.ndarray) -> np.ndarray:
    a = np.abs(x.astype(np.longdouble))
    line = a <= x.dtype.type(0.0031308)
    curve = np.longdouble("1.055") * a ** (1 / np.longdouble("2.4")) - np.longdouble("0.055")
    return np.copysign(np.where(line, np.longdouble("12.92") * a, curve), x)


def _exact_decode(x: np.ndarray) -> np.ndarray:
    a = np.abs(x.astype(np.longdouble))
    line = a <= x.dtype.type(0.04045)
    curve = ((a + np.longdouble("0.055")) / np.longdouble("1.055")) ** np.longdouble("2.4")
    return np.copysign(np.where(line, a / np.longdouble("12.92"), curve), x)


@extreme("color.encode_transfer", "negative, tiny, beyond one, at the join", domain="|x| ≤ 1e6", unit="ulp", claim=5)
def encode(dtype: np.dtype) -> Measurement:
    """Measure the sRGB encoding against long double."""
    x = _signal(dtype)
    y = color.encode_transfer(x)
    return Measurement(float(ulps(y, _exact_encode(x), dtype).max()), x.size, int((~np.isfinite(y)).sum()))


@extreme("color.decode_transfer", "negative, tiny, beyond one, at the join", domain="|x| ≤ 1e6", unit="ulp", claim=8)
def decode(dtype: np.dtype) -> Measurement:
    """Measure the sRGB decoding against long double."""
    x = _signal(dtype)
    y = color.decode_transfer(x)
    return Measurement(float(ulps(y, _exact_decode(x), dtype).max()), x.size, int((~np.isfinite(y)).sum()))


@extreme("color.tone_map", "Reinhard, ACES from 1e-37 to inf", domain="x ≥ 0", unit="ulp", claim=4)
def tone(dtype: np.dtype) -> Measurement:
    """Measure both curves against long double; the limits at infinity."""
    x = np.logspace(-37, 15, 4001).astype(dtype)
    w = x.astype(np.longdouble)
    aces = w * (np.longdouble("2.51") * w + np.longdouble("0.03"))
    aces = aces / (w * (np.longdouble("2.43") * w + np.longdouble("0.59")) + np.longdouble("0.14"))
    exact = {"reinhard": w / (1 + w), "aces": np.minimum(aces, 1)}
    worst, strays = 0.0, 0
    for method, e in exact.items():
        y = color.tone_map(x, method)  # type: ignore[arg-type]
        worst = max(worst, float(ulps(y, e, dtype).max()))
        ends = color.tone_map(np.array([np.finfo(dtype).max, np.inf], dtype), method)  # type: ignore[arg-type]
        strays += int((~np.isfinite(y)).sum()) + int((ends != 1).sum())
    return Measurement(worst, 2 * x.size + 4, strays)
