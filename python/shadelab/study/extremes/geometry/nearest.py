"""Extremes of lines, segments and nearest points of triangles, against rational arithmetic."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .... import geometry
from ...stability import Measurement, extreme
from ._rational import cross, dot, root, squared_to_segment, sub, vector

Array = NDArray[Any]


def _lines(dtype: Any, seed: int, angle: float, length: float = 1.0) -> Measurement:
    """The largest error of both points in eps of the origins' distance over the angle's sine."""
    rng = np.random.default_rng(seed)
    o1, d1, o2, d2 = rng.normal(size=(4, 60, 3))
    lines = [x.astype(dtype) for x in (o1, length * d1, o2, d1 + angle * d2)]
    pair = geometry.line_line(*lines)
    eps, error, strays = float(np.finfo(dtype).eps), 0.0, 0
    for i in range(60):
        a, u, b, v = (vector(x[i]) for x in lines)
        n, w = cross(u, v), sub(b, a)
        square = dot(n, n)
        sine = float(root(square / (dot(u, u) * dot(v, v))))
        unit = Fraction(eps * float(root(dot(w, w))) / sine)
        wants = (dot(cross(w, v), n) / square, dot(cross(w, u), n) / square)
        for got, want, d in zip((pair.s[i], pair.t[i]), wants, (u, v), strict=True):
            if not np.isfinite(got):
                strays += 1
                continue
            error = max(error, float(abs(Fraction(float(got)) - want) * root(dot(d, d)) / unit))
    return Measurement(error, 60, strays + int(pair.parallel.sum()))


@extreme("geometry.line_line", "at an angle of 1e-6", domain="unit lines", unit="eps w/sin", claim=10)
def _flat_lines(dtype: np.dtype[Any]) -> Measurement:
    return _lines(dtype, 1, 1e-6)


@extreme("geometry.line_line", "directions of 1e-20", domain="unit lines", unit="eps w/sin", claim=10)
def _short_lines(dtype: np.dtype[Any]) -> Measurement:
    return _lines(dtype, 2, 1.0, 1e-20)


def _least(a: Array, b: Array, c: Array, d: Array) -> Fraction:
    """The square of the distance between two segments."""
    p, q, r, s = (vector(x) for x in (a, b, c, d))
    found = [squared_to_segment(x, r, s) for x in (p, q)] + [squared_to_segment(x, p, q) for x in (r, s)]
    u, v, w = sub(q, p), sub(s, r), sub(r, p)
    n = cross(u, v)
    if any(n):
        x, y = dot(cross(w, v), n) / dot(n, n), dot(cross(w, u), n) / dot(n, n)
        if 0 <= x <= 1 and 0 <= y <= 1:
            found.append(dot(n, w) ** 2 / dot(n, n))
    return min(found)


def _segments(ends: list[Array]) -> Measurement:
    """The largest error of the distance in eps of the larger of lengths and distance."""
    distance = geometry.segment_segment(*ends).distance
    eps, error = float(np.finfo(ends[0].dtype).eps), 0.0
    for i in range(len(distance)):
        a, b, c, d = (x[i] for x in ends)
        want = root(_least(a, b, c, d))
        lengths = [root(dot(e, e)) for e in (sub(vector(b), vector(a)), sub(vector(d), vector(c)))]
        unit = Fraction(eps) * max(*lengths, want)
        if unit:
            error = max(error, float(abs(Fraction(float(distance[i])) - want) / unit))
    return Measurement(error, len(distance), int((~np.isfinite(distance)).sum()))


SEGMENTS = "geometry.segment_segment"


@extreme(SEGMENTS, "parallel, overlapping, points", domain="ends on a grid of thirds", unit="eps of size", claim=8)
def _grid(dtype: np.dtype[Any]) -> Measurement:
    ends = np.random.default_rng(3).integers(-2, 3, (4, 150, 3)).astype(dtype) / dtype.type(3)
    return _segments(list(ends))


@extreme(SEGMENTS, "at an angle of 1e-7", domain="unit segments", unit="eps of size", claim=8)
def _flat_segments(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(4)
    a, u, tilt, gap = rng.normal(size=(4, 100, 3))
    c = a + rng.uniform(-1, 1, (100, 1)) * u + 1e-3 * gap
    return _segments([x.astype(dtype) for x in (a, a + u, c, c + 1.3 * u + 1e-7 * tilt)])


@extreme(SEGMENTS, "crossing at an angle of 1e-7", domain="unit segments", unit="eps of size", claim=8)
def _crossing_segments(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(12)
    a, u, tilt = rng.normal(size=(3, 100, 3))
    x, y = a + rng.uniform(0, 1, (100, 1)) * u, u + 1e-7 * tilt
    back = rng.uniform(0, 1, (100, 1))
    return _segments([x.astype(dtype) for x in (a, a + u, x - back * y, x + (1 - back) * y)])


@extreme(SEGMENTS, "1e6 from the origin", domain="segments of size 100", unit="eps of size", claim=8)
def _far_segments(dtype: np.dtype[Any]) -> Measurement:
    ends = 100 * np.random.default_rng(5).normal(size=(4, 100, 3)) + 1e6
    return _segments(list(ends.astype(dtype)))


def _triangles(given: list[Array]) -> Measurement:
    """The largest error of the distance in eps of the farthest vertex's."""
    distance = geometry.closest_point_triangle(*given, full_output=True).distance
    eps, error = float(np.finfo(given[0].dtype).eps), 0.0
    for i in range(len(distance)):
        p, *corners = (vector(x[i]) for x in given)
        a, b, c = corners
        n = cross(sub(b, a), sub(c, a))
        areas = [dot(n, cross(sub(corners[k - 2], p), sub(corners[k - 1], p))) for k in range(3)]
        if any(n) and min(areas) > 0:
            want = root(dot(n, sub(p, a)) ** 2 / dot(n, n))
        else:
            want = root(min(squared_to_segment(p, *edge) for edge in ((a, b), (b, c), (c, a))))
        far = max(root(dot(sub(x, p), sub(x, p))) for x in corners)
        if far:
            error = max(error, float(abs(Fraction(float(distance[i])) - want) / (Fraction(eps) * far)))
    return Measurement(error, len(distance), int((~np.isfinite(distance)).sum()))


def _thin(dtype: Any, seed: int, thin: float, size: float = 1.0, shift: float = 0.0) -> Measurement:
    rng = np.random.default_rng(seed)
    a, u, v, p = rng.normal(size=(4, 100, 3))
    p = a + rng.uniform(-1, 2, (100, 1)) * u + p * rng.choice([1, thin], (100, 1))
    return _triangles([(size * x + shift).astype(dtype) for x in (p, a, a + u, a + 0.4 * u + thin * v)])


NEAREST = "geometry.closest_point_triangle"


@extreme(NEAREST, "slivers", domain="height 1e-8 of the length", unit="eps of far", claim=8)
def _slivers(dtype: np.dtype[Any]) -> Measurement:
    return _thin(dtype, 6, 1e-8)


@extreme(NEAREST, "area of 1e-30", domain="of size 1e-15; height 1e-30", unit="eps of far", claim=8)
def _tiny(dtype: np.dtype[Any]) -> Measurement:
    one, other = _thin(dtype, 7, 1.0, size=1e-15), _thin(dtype, 8, 1e-30)
    return Measurement(max(one.error, other.error), one.cases + other.cases, one.strays + other.strays)


@extreme(NEAREST, "1e6 from the origin", domain="triangles of size 1e4", unit="eps of far", claim=8)
def _far_triangles(dtype: np.dtype[Any]) -> Measurement:
    return _thin(dtype, 9, 1.0, size=1e4, shift=1e6)


@extreme(NEAREST, "lines and points", domain="vertices on a grid of thirds", unit="eps of far", claim=8)
def _without_area(dtype: np.dtype[Any]) -> Measurement:
    given = np.random.default_rng(10).integers(-1, 2, (4, 150, 3)).astype(dtype) / dtype.type(3)
    given[3] = given[1] + dtype.type(2) * (given[2] - given[1])
    return _triangles(list(given))


@extreme("geometry.perspective_barycentric", "w from 1e-30 to 1e30", domain="in front of the eye", unit="eps", claim=5)
def _perspective(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(11)
    weights = rng.dirichlet([1, 1, 1], 200).astype(dtype)
    w = (10 ** rng.uniform(-30, 30, (200, 1)) * 10 ** rng.uniform(-5, 5, (200, 3))).astype(dtype)
    w = np.clip(w, 1e-37, 1e37).astype(dtype)
    got = geometry.perspective_barycentric(weights, w)
    eps, error = Fraction(float(np.finfo(dtype).eps)), 0.0
    for i in range(200):
        raw = [x / y for x, y in zip(vector(weights[i]), vector(w[i]), strict=True)]
        for k in range(3):
            # A share below the normal numbers is as good as none.
            want = raw[k] / sum(raw)
            if want > Fraction(float(np.finfo(dtype).tiny)) / eps:
                error = max(error, float(abs(Fraction(float(got[i, k])) - want) / (eps * want)))
    return Measurement(error, 200, int(np.isnan(got).sum()))
