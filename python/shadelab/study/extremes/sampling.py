"""Extremes of `sampling`: both ends of the unit interval in every warp, the last points of a sequence."""

from __future__ import annotations

from collections.abc import Callable

import mpmath
import numpy as np

from ... import sampling
from ..._arrays import Floats
from ..stability import Measurement, extreme


def _corners(dtype: np.dtype) -> Floats:
    """Every pair of the numbers at which a warp might slip: the ends, the middle and its neighbours."""
    one, half = dtype.type(1), dtype.type(0.5)
    tiny = np.finfo(dtype).smallest_subnormal
    ends = [0, tiny, np.finfo(dtype).tiny, np.nextafter(half, 0), half, np.nextafter(half, one), np.nextafter(one, 0)]
    edge = np.array([*ends, 2.0**-24, 0.25, 0.75], dtype)
    return np.stack(np.meshgrid(edge, edge), -1).reshape(-1, 2)


def _exact_disk(u: Floats, method: str) -> list[list[mpmath.mpf]]:
    out = []
    for a, b in ((mpmath.mpf(float(x)), mpmath.mpf(float(y))) for x, y in u):
        if method == "polar":
            r, angle = mpmath.sqrt(a), 2 * mpmath.pi * b
        else:
            a, b = 2 * a - 1, 2 * b - 1
            if abs(a) > abs(b):
                r, angle = a, mpmath.pi / 4 * b / a
            else:
                r, angle = b, mpmath.pi / 2 - (mpmath.pi / 4 * a / b if b else 0)
        out.append([r * mpmath.cos(angle), r * mpmath.sin(angle), mpmath.sqrt(1 - r * r)])
    return out


def _largest(got: Floats, exact: list[list[mpmath.mpf]], dtype: np.dtype) -> Measurement:
    """The largest absolute error in rounding units of 1; strays are values that are not finite."""
    unit = float(np.finfo(dtype).eps) / 2
    error = max(
        float(abs(mpmath.mpf(float(g)) - e)) / unit
        for row, es in zip(got, exact, strict=True)
        for g, e in zip(row, es, strict=True)
    )
    return Measurement(error, len(got), int((~np.isfinite(got)).sum()))


def _disk(method: sampling.DiskMethod, warp: Callable[..., Floats], size: int) -> Callable[[np.dtype], Measurement]:
    def measure(dtype: np.dtype) -> Measurement:
        u = _corners(dtype)
        with mpmath.workdps(50):
            return _largest(warp(u, method), [e[:size] for e in _exact_disk(u, method)], dtype)

    return measure


_DOMAIN = "pairs of 0, subnormal, 2^-24, 1/4, 1/2 ± ulp, 3/4, 1 - ulp"
_CLAIMS: dict[sampling.DiskMethod, float] = {"concentric": 1.5, "polar": 3}
for _method, _claim in _CLAIMS.items():
    extreme("sampling.square_to_disk", f"ends of the square, {_method}", domain=_DOMAIN, unit="absolute", claim=_claim)(
        _disk(_method, sampling.square_to_disk, 2)
    )
    extreme(
        "sampling.square_to_cosine_hemisphere",
        f"ends of the square, {_method}",
        domain=_DOMAIN,
        unit="absolute",
        claim=_claim,
    )(_disk(_method, sampling.square_to_cosine_hemisphere, 3))


def _triangle(method: sampling.TriangleMethod) -> Callable[[np.dtype], Measurement]:
    def measure(dtype: np.dtype) -> Measurement:
        u = _corners(dtype)
        exact = []
        with mpmath.workdps(50):
            for s, t in ((mpmath.mpf(float(x)), mpmath.mpf(float(y))) for x, y in u):
                if method == "root":
                    exact.append([1 - mpmath.sqrt(s), t * mpmath.sqrt(s)])
                else:
                    exact.append([s / 2, t - s / 2] if t > s else [s - t / 2, t / 2])
            result = _largest(sampling.square_to_triangle(u, method), exact, dtype)
        outside = int((sampling.square_to_triangle_pdf(sampling.square_to_triangle(u, method)) != 2).sum())
        return Measurement(result.error, result.cases, result.strays + outside)

    return measure


for _fold in ("fold", "root"):
    extreme("sampling.square_to_triangle", f"ends of the square, {_fold}", domain=_DOMAIN, unit="absolute", claim=1)(
        _triangle(_fold)
    )


@extreme(
    "sampling.square_to_cosine_hemisphere",
    "height just above the horizon",
    domain="u = k ulp from either border of the square, k = 1 … 64",
    unit="relative",
    claim={"float32": 1.2e-7, "float64": 2.3e-16},
)
def _grazing(dtype: np.dtype) -> Measurement:
    step = np.arange(1, 65, dtype=dtype) * np.finfo(dtype).eps / 2
    edge = np.concatenate([1 - step, step, step * np.finfo(dtype).eps])
    u = np.stack([edge, np.full_like(edge, 0.3)], -1)
    z = sampling.square_to_cosine_hemisphere(u)[:, 2]
    with mpmath.workdps(50):
        exact = [mpmath.sqrt(1 - (2 * mpmath.mpf(float(e)) - 1) ** 2) for e in edge]
        error = max(float(abs(float(g) / e - 1)) for g, e in zip(z, exact, strict=True))
    return Measurement(error, len(z), int((~np.isfinite(z)).sum()))


@extreme(
    "sampling.Generator",
    "the ends of every counter",
    domain="pixel to 2^64 - 1, sample and dimension to 2^32 - 1, seeds 0 and 2^64 - 1",
    unit="count",
    claim=0,
)
def _counters(dtype: np.dtype) -> Measurement:
    pixel = np.array([0, 1, 2**32 - 1, 2**32, 2**63, 2**64 - 1], np.uint64)
    other = np.array([0, 1, 2**31, 2**32 - 1], np.uint64)
    u = np.stack(
        [
            sampling.Generator(seed).uniform(pixel[:, None, None], other[:, None], other, dtype=dtype)
            for seed in (0, 2**64 - 1)
        ]
    )
    # All differ: a coincidence among 192 numbers of 24 bits has chance 1e-3, and the seeds are fixed.
    wrong = u.size - len(np.unique(u)) + int(((u < 0) | (u >= 1)).sum())
    return Measurement(wrong, u.size)
