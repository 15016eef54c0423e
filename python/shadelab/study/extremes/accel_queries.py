"""Extremes of `accel`'s queries about points: against brute force to the bit, and against exact rationals."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import accel, mesh
from ..stability import Measurement, extreme

Array = NDArray[Any]


def _soup(triangles: Array) -> tuple[Array, Array]:
    return triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def _nearest_against_brute_force(triangles: Array, points: Array, dtype: np.dtype[Any]) -> Measurement:
    """Points whose nearest point differs from brute force's in any bit."""
    p, f = _soup(triangles.astype(dtype))
    bvh, q = accel.BVH(p, f), points.astype(dtype)
    found = bvh.closest_point(q, full_output=True)
    expected = bvh.closest_point(q, method="brute_force", full_output=True)
    pairs = zip(found, expected, strict=True)
    differs = np.zeros(len(q), bool)
    for a, b in pairs:
        same = np.asarray(a).view(np.uint8).reshape(len(q), -1) == np.asarray(b).view(np.uint8).reshape(len(q), -1)
        differs |= ~same.all(-1)
    return Measurement(float(differs.sum()), len(q), int((~np.isfinite(found.distance)).sum()))


@extreme("accel.BVH.closest_point", "nested scales", domain="triangles of 1e-5 to 1e4", unit="count", claim=0)
def _scales(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(1)
    t = rng.normal(size=(800, 3, 3)) * 10 ** rng.uniform(-5, 4, (800, 1, 1))
    q = rng.normal(size=(2000, 3)) * 10 ** rng.uniform(-5, 4, (2000, 1))
    return _nearest_against_brute_force(t, q, dtype)


@extreme("accel.BVH.closest_point", "equal centroids", domain="300 triangles about one point", unit="count", claim=0)
def _one_centroid(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(2)
    t = rng.integers(-4, 5, (300, 3, 3)).astype(float)
    t[:, 2] = -t[:, 0] - t[:, 1]
    return _nearest_against_brute_force(t, rng.integers(-8, 9, (1000, 3)) / 2, dtype)


@extreme("accel.BVH.closest_point", "far from the origin", domain="at 1e6, points on the mesh", unit="count", claim=0)
def _far(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(3)
    t = 30 * rng.normal(size=(500, 3, 3)) + 1e6
    w = rng.dirichlet([1, 1, 1], 500)
    return _nearest_against_brute_force(t, (w[..., None] * t).sum(1), dtype)


@extreme(
    "accel.BVH.closest_point",
    "slivers",
    domain="height 1e-4 (f64: 1e-10) of length",
    unit="eps",
    claim=4,
)
def _slivers(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(4)
    thin = 1e-4 if dtype == np.float32 else 1e-10
    t = rng.normal(size=(200, 3, 3))
    t[:, 2] = t[:, 0] + rng.uniform(size=(200, 1)) * (t[:, 1] - t[:, 0]) + thin * rng.normal(size=(200, 3))
    q = (rng.dirichlet([0.5] * 3, 200)[..., None] * t).sum(1) + 10 ** rng.uniform(-16, 0, (200, 1))
    t, q = t.astype(dtype), q.astype(dtype)
    worst = 0.0
    for corners, point in zip(t, q, strict=True):
        distance = float(accel.BVH(corners, [[0, 1, 2]]).closest_point(point).distance)
        reach = float(np.linalg.norm(corners.astype(float) - point, axis=-1).max())
        worst = max(worst, abs(distance - math.sqrt(_exact_square(point, corners))) / reach)
    return Measurement(worst / float(np.finfo(dtype).eps), len(q))


def _exact_square(point: Array, corners: Array) -> Fraction:
    """The squared distance from a triangle in rational arithmetic."""
    p, a, b, c = ([Fraction(float(x)) for x in v] for v in (point, *corners))

    def sub(x: list[Fraction], y: list[Fraction]) -> list[Fraction]:
        return [i - j for i, j in zip(x, y, strict=True)]

    def dot(x: list[Fraction], y: list[Fraction]) -> Fraction:
        return sum((i * j for i, j in zip(x, y, strict=True)), Fraction(0))

    def segment(a: list[Fraction], b: list[Fraction]) -> Fraction:
        e, w = sub(b, a), sub(p, a)
        s = max(Fraction(0), min(Fraction(1), dot(w, e) / dot(e, e))) if any(e) else Fraction(0)
        left = [x - s * y for x, y in zip(w, e, strict=True)]
        return dot(left, left)

    best = min(segment(a, b), segment(b, c), segment(c, a))
    e, f, w = sub(b, a), sub(c, a), sub(p, a)
    ee, ef, ff = dot(e, e), dot(e, f), dot(f, f)
    det = ee * ff - ef * ef
    if det:
        u, v = (ff * dot(w, e) - ef * dot(w, f)) / det, (ee * dot(w, f) - ef * dot(w, e)) / det
        if u >= 0 and v >= 0 and u + v <= 1:
            left = [x - u * y - v * z for x, y, z in zip(w, e, f, strict=True)]
            best = min(best, dot(left, left))
    return best


@extreme(
    "accel.BVH.winding_number", "next to the surface", domain="closed, 1e-12 to 1e-1 away", unit="absolute", claim=1e-9
)
def _next_to_the_surface(dtype: np.dtype[Any]) -> Measurement:
    box = mesh.icosphere(2)
    p, f = np.asarray(box.positions, dtype), box.faces
    rng = np.random.default_rng(5)
    on = (rng.dirichlet([1, 1, 1], 4000)[..., None] * p[f[rng.integers(len(f), size=4000)]]).sum(1)
    q = (on * (1 + 10 ** rng.uniform(-12, -1, (4000, 1)) * rng.choice([-1, 1], (4000, 1)))).astype(dtype)
    w = accel.BVH(p, f).winding_number(q, max_error=0)
    # Points that rounding put onto the surface have a half.
    off = np.abs(w - 0.5) > 1e-6
    return Measurement(float(np.abs(w - np.round(w))[off].max()), int(off.sum()), int(np.isnan(w).sum()))


@extreme("accel.BVH.contains", "far from the origin", domain="sphere of 1 at 1e3 (f64: 1e9)", unit="count", claim=0)
def _contains_far(dtype: np.dtype[Any]) -> Measurement:
    ball = mesh.icosphere(2)
    shift = 1e3 if dtype == np.float32 else 1e9
    p = (np.asarray(ball.positions) + shift).astype(dtype)
    rng = np.random.default_rng(6)
    d = rng.normal(size=(3000, 3))
    r = rng.choice([0.9, 1.1], (3000, 1))
    q = (r * d / np.linalg.norm(d, axis=-1, keepdims=True) + shift).astype(dtype)
    wrong = accel.BVH(p, ball.faces).contains(q) != (r[:, 0] < 1)
    return Measurement(float(wrong.sum()), len(q))
