"""Extremes of polygons, angular order and octahedral directions, against rational arithmetic."""

from __future__ import annotations

from fractions import Fraction
from functools import cmp_to_key
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .... import geometry
from ...stability import Measurement, extreme
from ._rational import vector

Array = NDArray[Any]


def _place(p: Array, polygon: Array) -> tuple[bool, int]:
    """On the border; the winding number."""
    x, y = vector(p)
    corners, winding = [vector(q) for q in polygon], 0
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        turn = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
        if turn == 0 and min(ax, bx) <= x <= max(ax, bx) and min(ay, by) <= y <= max(ay, by):
            return True, 0
        if (ay <= y < by and turn > 0) or (by <= y < ay and turn < 0):
            winding += 1 if by > ay else -1
    return False, winding


def _places(points: Array, polygon: Array) -> Measurement:
    """Wrong places."""
    got = geometry.point_in_polygon(points, polygon, rule="winding", border=False, full_output=True)
    wrong = 0
    for i, p in enumerate(points):
        border, winding = _place(p, polygon)
        wrong += bool(got.on_border[i] != border or got.winding[i] != winding or got.inside[i] != (winding != 0))
    return Measurement(float(wrong), len(points))


POINTS = "geometry.point_in_polygon"


def _near(dtype: Any, seed: int, shift: float) -> Measurement:
    rng = np.random.default_rng(seed)
    polygon = (rng.normal(size=(9, 2)) + shift).astype(dtype)
    s = rng.uniform(0, 1, (20, 9, 1))
    near = ((1 - s) * polygon.astype(float) + s * np.roll(polygon, -1, 0)).astype(dtype).reshape(-1, 2)
    return _places(np.concatenate([near, np.nextafter(near, near + 1).astype(dtype), polygon]), polygon)


@extreme(POINTS, "within a rounding of edges", domain="unit polygons", unit="count", claim=0)
def _edges(dtype: np.dtype[Any]) -> Measurement:
    return _near(dtype, 1, 0)


@extreme(POINTS, "1e6 from the origin", domain="within a rounding of edges", unit="count", claim=0)
def _far(dtype: np.dtype[Any]) -> Measurement:
    return _near(dtype, 2, 1e6)


@extreme(POINTS, "repeated and collinear vertices", domain="random walks on a grid of tenths", unit="count", claim=0)
def _repeated(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(3)
    grid = np.stack(np.meshgrid(np.arange(-3, 4), np.arange(-3, 4)), -1).reshape(-1, 2).astype(dtype) / dtype.type(10)
    wrong = [_places(grid, rng.integers(-2, 3, (12, 2)).astype(dtype) / dtype.type(10)) for _ in range(8)]
    return Measurement(sum(w.error for w in wrong), sum(w.cases for w in wrong))


def _leaks(dtype: Any, shift: float, length: float) -> Measurement:
    """Rays from within a closed prism with a star for its base, at its edges and vertices, that hit nothing."""
    rng = np.random.default_rng(4)
    n = 10
    angle = 2 * np.pi * np.arange(n) / n
    rim = np.stack([np.cos(angle), np.sin(angle)], -1) * np.where(np.arange(n) % 2, 1, 0.4)[:, None]
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    low, high = ((3 * np.c_[rim, np.full(n, z)] @ turn + shift).astype(dtype) for z in (-1.0, 1.0))
    sides = np.stack([low, np.roll(low, -1, 0), np.roll(high, -1, 0), high], 1)
    starts, ends = np.concatenate([low, high, low]), np.concatenate([np.roll(low, -1, 0), np.roll(high, -1, 0), high])
    pick, s = rng.integers(0, 3 * n, 1000), rng.choice([0, 0.3, 0.5, 1], (1000, 1))
    o = (0.3 * rng.uniform(-1, 1, (1000, 3)) + shift).astype(dtype)
    d = ((1 - s) * starts[pick].astype(float) + s * ends[pick]).astype(dtype) - o
    d = (d * dtype.type(length)).astype(dtype)
    nearest = geometry.ray_polygon(o[:, None], d[:, None], sides).min(-1)
    for base in (low, high):
        nearest = np.minimum(nearest, geometry.ray_polygon(o, d, base))
    return Measurement(float((~np.isfinite(nearest)).sum()), 1000)


RAYS = "geometry.ray_polygon"


@extreme(RAYS, "at shared edges and vertices", domain="a prism over a star", unit="count", claim=0)
def _shared(dtype: np.dtype[Any]) -> Measurement:
    return _leaks(dtype, 0, 1)


@extreme(RAYS, "shared edges, 1e6 from the origin", domain="a prism over a star", unit="count", claim=0)
def _shared_far(dtype: np.dtype[Any]) -> Measurement:
    return _leaks(dtype, 1e6, 1)


@extreme(RAYS, "shared edges, directions of 1e-20", domain="a prism over a star", unit="count", claim=0)
def _shared_short(dtype: np.dtype[Any]) -> Measurement:
    return _leaks(dtype, 0, 1e-20)


@extreme("geometry.signed_area", "1e6 from the origin", domain="polygons of size 100", unit="eps", claim=2)
def _area(dtype: np.dtype[Any]) -> Measurement:
    polygons = (100 * np.random.default_rng(5).normal(size=(100, 20, 2)) + 1e6).astype(dtype)
    area, eps, error = geometry.signed_area(polygons), float(np.finfo(dtype).eps), 0.0
    for polygon, got in zip(polygons, area, strict=True):
        corners = [vector(p) for p in polygon]
        pairs = list(zip(corners, corners[1:] + corners[:1], strict=True))
        want = sum((a[0] * b[1] - a[1] * b[0] for a, b in pairs), Fraction()) / 2
        # The docstring's second term.
        rest = len(corners) * eps**2 * float(sum(abs(a[0] * b[1]) for a, b in pairs))
        error = max(error, (float(abs(Fraction(float(got)) - want)) - rest) / (eps * float(abs(want))))
    return Measurement(error, 100, int(np.isnan(area).sum()))


@extreme("geometry.sort_by_angle", "within roundings of one line", domain="1e6 from the origin", unit="count", claim=0)
def _order(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(6)
    points = (100 * rng.normal(size=(120, 1)) * [0.3, 0.7] + 1e6).astype(dtype)
    center = np.full(2, 1e6, dtype)
    vectors = [[x - y for x, y in zip(vector(p), vector(center), strict=True)] for p in points]
    half = [0 if not any(v) else 1 if v[1] > 0 or (v[1] == 0 and v[0] > 0) else 2 for v in vectors]

    def compare(i: int, j: int) -> int:
        (ax, ay), (bx, by) = vectors[i], vectors[j]
        turn = ax * by - ay * bx if half[i] == half[j] else Fraction()
        order = [Fraction(half[i] - half[j]), -turn, ax * ax + ay * ay - bx * bx - by * by, Fraction(i - j)]
        first = next((x for x in order if x), Fraction())
        return int(first > 0) - int(first < 0)

    want = sorted(range(120), key=cmp_to_key(compare))
    return Measurement(float((geometry.sort_by_angle(points, center) != want).sum()), 120)


@extreme("geometry.octahedral_decode", "there and back", domain="seams, axes, every length", unit="eps", claim=3)
def _octahedral(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(7)
    v = rng.normal(size=(20000, 3)) * rng.choice([0, 1e-9, 1e-4, 1], (20000, 3))
    v = v[v.any(-1)]
    v = (v * 10 ** rng.uniform(-25, 25, (len(v), 1))).astype(dtype)
    unit = v.astype(np.longdouble)
    unit /= np.abs(unit).max(-1, keepdims=True)
    unit /= np.sqrt((unit * unit).sum(-1, keepdims=True))
    back = geometry.octahedral_decode(geometry.octahedral_encode(v))
    error = np.sqrt(((back - unit) ** 2).sum(-1)).max() / np.finfo(dtype).eps
    return Measurement(float(error), len(v), int(np.isnan(back).any(-1).sum()))


@extreme("geometry.ray_implicit", "torus, all roots", domain="from 1000 units", unit="relative", claim=1e-11)
def _torus(dtype: np.dtype[Any]) -> Measurement:
    # A ray across the equator meets four circles, at known distances.
    radius, tube = dtype.type(1.0), dtype.type(0.25)
    surface = geometry.torus_polynomial(float(radius), float(tube))
    rng = np.random.default_rng(8)
    offset = rng.uniform(-0.7, 0.7, 200).astype(dtype)
    o = np.stack([np.full(200, -1000), np.zeros(200), offset], -1).astype(dtype)
    d = np.tile(np.array([1, 0, 0], dtype), (200, 1))
    hit = geometry.ray_implicit(o, d, surface, full_output=True)
    wide = offset.astype(np.longdouble)
    want = 1000 - np.sqrt((1.25 - wide) * (1.25 + wide))
    rounding = np.finfo(dtype).eps * 1000
    error = np.maximum(np.abs(hit.t - want) - rounding, 0).max() / 1000
    return Measurement(float(error), 200, int((hit.crossings != 4).sum()))
