"""Extremes of the elementary functions that every chapter's kernels are built on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..._kernels import math as _kernels
from ..stability import Measurement, extreme

_ANY = np.dtype[Any]


def _apply(name: str, *arguments: NDArray[Any]) -> NDArray[Any]:
    out = np.empty_like(arguments[0])
    (_kernels.apply if len(arguments) == 1 else _kernels.apply2)(name, *arguments, out)
    return out


def _measure(name: str, *arguments: NDArray[Any]) -> Measurement:
    """The largest error in ulps against mpmath; a NaN or infinity that mpmath's rounded result is not is a stray."""
    import mpmath

    oracle: Any = {
        "acos": mpmath.acos,
        "asin": mpmath.asin,
        "atan2": mpmath.atan2,
        "cos": mpmath.cos,
        "exp": mpmath.exp,
        "ln": mpmath.log,
        "pow": mpmath.power,
        "sin": mpmath.sin,
        "tan": mpmath.tan,
    }[name]
    got = _apply(name, *arguments)
    dtype, error, strays = got.dtype, 0.0, 0
    largest = float(np.finfo(dtype).max)
    with mpmath.workprec(200), np.errstate(over="ignore", invalid="ignore"):
        for value, *given in zip(got.tolist(), *(a.tolist() for a in arguments), strict=True):
            exact = oracle(*(mpmath.mpf(v) for v in given))
            if not np.isfinite(value):
                strays += not abs(exact) > largest
                continue
            place = np.spacing(min(abs(dtype.type(float(exact))), dtype.type(largest)))
            error = max(error, float(abs(mpmath.mpf(value) - exact) / mpmath.mpf(float(place))))
    return Measurement(error, len(got), strays)


def _near(values: Any, dtype: _ANY, steps: int = 2) -> NDArray[Any]:
    """The numbers nearest to each value, and their neighbours."""
    centre = np.asarray(values, dtype)
    around = [centre]
    below, above = centre, centre
    for _ in range(steps):
        below = np.nextafter(below, dtype.type(-np.inf))
        above = np.nextafter(above, dtype.type(np.inf))
        around += [below, above]
    return np.concatenate(around)


def _multiples_of_half_pi(dtype: _ANY) -> NDArray[Any]:
    limit = 1e5 if dtype == np.float32 else 1e6
    k = np.unique(np.geomspace(1, limit / (np.pi / 2) - 1, 300).astype(np.int64))
    return _near(k * (np.pi / 2), dtype)


def _binades(low: float, high: float, count: int, dtype: _ANY) -> NDArray[Any]:
    return np.exp2(np.random.default_rng(7).uniform(low, high, count)).astype(dtype)


@extreme("math.sin", "beside multiples of pi/2", domain="|x| <= 1e5 (f32), 1e6 (f64)", unit="ulp", claim=2)
def _(dtype: _ANY) -> Measurement:
    return _measure("sin", _multiples_of_half_pi(dtype))


@extreme("math.cos", "beside multiples of pi/2", domain="|x| <= 1e5 (f32), 1e6 (f64)", unit="ulp", claim=2)
def _(dtype: _ANY) -> Measurement:
    return _measure("cos", _multiples_of_half_pi(dtype))


@extreme("math.tan", "beside multiples of pi/2", domain="|x| <= 1e5 (f32), 1e6 (f64)", unit="ulp", claim=4)
def _(dtype: _ANY) -> Measurement:
    return _measure("tan", _multiples_of_half_pi(dtype))


@extreme("math.sin", "subnormal and tiny angles", domain="|x| < 1e-3", unit="ulp", claim=1)
def _(dtype: _ANY) -> Measurement:
    info = np.finfo(dtype)
    return _measure("sin", np.concatenate([_binades(info.minexp - 20, -10, 1000, dtype), [info.smallest_subnormal]]))


@extreme("math.sin", "beyond the domain: NaN", domain="|x| > 1e5 (f32), 1e6 (f64)", unit="count", claim=0)
def _(dtype: _ANY) -> Measurement:
    info = np.finfo(dtype)
    x = np.array([1.01e6, 1e10, info.max, -info.max, np.inf, -np.inf, np.nan], dtype)
    return Measurement(float((~np.isnan(_apply("sin", x))).sum()), x.size)


@extreme("math.exp", "to overflow and into subnormals", domain="all x", unit="ulp", claim=1)
def _(dtype: _ANY) -> Measurement:
    low, high = (-104.0, 89.0) if dtype == np.float32 else (-745.5, 710.0)
    x = np.linspace(low, high, 1500).astype(dtype)
    edges = _near([np.log(float(np.finfo(dtype).max)), np.log(float(np.finfo(dtype).tiny)), low, 0.0], dtype, 4)
    return _measure("exp", np.concatenate([x, edges]))


@extreme("math.ln", "beside one, subnormal, largest", domain="x > 0", unit="ulp", claim=1)
def _(dtype: _ANY) -> Measurement:
    info = np.finfo(dtype)
    near = 1 + np.geomspace(info.eps, 0.5, 300) * np.resize([1, -1], 300)
    ends = [info.smallest_subnormal, info.tiny, info.max, np.sqrt(0.5), np.sqrt(2.0)]
    return _measure(
        "ln", np.concatenate([near, _binades(info.minexp - 20, info.maxexp - 1, 800, dtype), ends]).astype(dtype)
    )


@extreme("math.acos", "beside -1, 0, 1/2, 1", domain="[-1, 1]", unit="ulp", claim=2)
def _(dtype: _ANY) -> Measurement:
    x = 1 - np.geomspace(np.finfo(dtype).eps / 2, 1, 500)
    return _measure("acos", np.concatenate([x, -x, [0.5, -0.5, 1, -1, 0]]).astype(dtype))


@extreme("math.asin", "beside -1, 0, 1/2, 1", domain="[-1, 1]", unit="ulp", claim=2)
def _(dtype: _ANY) -> Measurement:
    x = 1 - np.geomspace(np.finfo(dtype).eps / 2, 1, 500)
    return _measure("asin", np.concatenate([x, -x, np.geomspace(1e-30, 1, 200), [0.5, -0.5, 1, -1]]).astype(dtype))


@extreme("math.atan2", "every magnitude and octant", domain="all", unit="ulp", claim=2)
def _(dtype: _ANY) -> Measurement:
    info = np.finfo(dtype)
    rng = np.random.default_rng(8)
    y, x = (_binades(info.minexp, info.maxexp - 1, 600, dtype)[rng.permutation(600)] for _ in range(2))
    near = (y * rng.uniform(0.3, 0.9, 600)).astype(dtype)
    sign = rng.choice([-1, 1], (2, 1200)).astype(dtype)
    ends = np.array([info.max, info.tiny, info.max], dtype), np.array([info.max, info.tiny, info.tiny], dtype)
    ys = np.concatenate([np.concatenate([y, y]) * sign[0], ends[0]])
    xs = np.concatenate([np.concatenate([x, near]) * sign[1], ends[1]])
    finite = np.isfinite(xs)
    return _measure("atan2", ys[finite], xs[finite])


@extreme("math.pow", "results over the whole range", domain="x > 0, all y", unit="ulp", claim=2)
def _(dtype: _ANY) -> Measurement:
    info = np.finfo(dtype)
    rng = np.random.default_rng(9)
    x = np.concatenate([_binades(info.minexp, info.maxexp - 1, 600, dtype), rng.uniform(0.5, 2, 900).astype(dtype)])
    target = rng.uniform(info.minexp, info.maxexp, x.size)
    with np.errstate(divide="ignore"):
        y = (target / np.log2(x.astype(np.float64))).astype(dtype)
    keep = np.isfinite(y)
    return _measure("pow", x[keep], y[keep])


@extreme("math.pow", "base beside one, huge exponents", domain="|x - 1| < 1e-3", unit="ulp", claim=2)
def _(dtype: _ANY) -> Measurement:
    info = np.finfo(dtype)
    rng = np.random.default_rng(10)
    x = (1 + np.geomspace(2 * info.eps, 1e-3, 800) * rng.choice([-1, 1], 800)).astype(dtype)
    y = (rng.uniform(0.9 * info.minexp, 0.9 * info.maxexp, 800) / np.log2(x.astype(np.float64))).astype(dtype)
    return _measure("pow", x, y)


@extreme("math.pow", "negative bases: sign by parity, else NaN", domain="x < 0", unit="count", claim=0)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(11)
    x = -rng.uniform(0.1, 3, 600).astype(dtype)
    y = rng.integers(-40, 41, 600).astype(dtype)
    y[::3] += dtype.type(0.5)
    got, positive = _apply("pow", x, y), _apply("pow", -x, y)
    expected = np.where(y % 1 != 0, np.nan, np.where(y % 2 != 0, -positive, positive))
    return Measurement(float((~((got == expected) | (np.isnan(got) & np.isnan(expected)))).sum()), x.size)
