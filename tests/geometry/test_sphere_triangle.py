"""Balls and triangles: the distance of rational arithmetic, at touching and one ulp beside it."""

from fractions import Fraction

import numpy as np
import pytest
from shadelab import geometry


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def sub(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def squared_distance(p, a, b, c):
    """To a triangle, in rationals: of the nearest points of the plane (if inside), the edges, the vertices."""
    p, a, b, c = ([Fraction(float(x)) for x in v] for v in (p, a, b, c))
    best = []
    for s, t in ((a, b), (b, c), (c, a)):
        e = sub(t, s)
        k = max(Fraction(0), min(Fraction(1), dot(sub(p, s), e) / dot(e, e))) if any(e) else Fraction(0)
        d = [x - y - k * z for x, y, z in zip(p, s, e, strict=True)]
        best.append(dot(d, d))
    u, v, w = sub(b, a), sub(c, a), sub(p, a)
    uu, uv, vv, wu, wv = dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)
    det = uu * vv - uv * uv
    if det:
        s, t = (vv * wu - uv * wv) / det, (uu * wv - uv * wu) / det
        if s >= 0 and t >= 0 and s + t <= 1:
            d = [x - s * y - t * z for x, y, z in zip(w, u, v, strict=True)]
            best.append(dot(d, d))
    return min(best)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_answers_are_those_of_rational_arithmetic(dtype, shift):
    rng = np.random.default_rng(1)
    n = 300
    # Small grids: right angles, lines and points come up often.
    a, b, c = (rng.integers(-2, 3, (3, n, 3)) + shift).astype(dtype)
    p = (rng.integers(-4, 5, (n, 3)) + shift).astype(dtype)
    squared = [squared_distance(*x) for x in zip(p, a, b, c, strict=True)]
    r = np.sqrt(np.array([float(s) for s in squared])).astype(dtype)
    r += rng.integers(-1, 2, n).astype(dtype) * np.spacing(r)
    expected = [x >= 0 and Fraction(float(x)) ** 2 >= s for x, s in zip(r, squared, strict=True)]
    got = geometry.sphere_triangle(p, r, a, b, c)
    assert np.array_equal(got, expected) and 50 < got.sum() < 250


def test_slivers_and_points_are_as_good_as_others():
    tiny = 1e-30
    a, b, c = [0, 0, 0], [1, 0, 0], [[0.5, tiny, 0], [0.5, 0, 0], [0, 0, 0]]
    assert geometry.sphere_triangle([0.5, 1, 0], [1 - 1e-12, 1.0, 1.0], a, b, c).tolist() == [False, True, True]
    assert geometry.sphere_triangle([0, 1, 0], [1 - 1e-12, 1.0], [0, 0, 0], [0, 0, 0], [0, 0, 0.0]).tolist() == [
        False,
        True,
    ]


def test_nan_touches_no_other():
    a = [[0, 0, 0], [np.nan, 0, 0], [0, 0, 0]]
    got = geometry.sphere_triangle([0, 0, 1.0], [1, 1, np.inf], a, [1, 0, 0], [0, 1, 0])
    assert got.tolist() == [True, False, True]


def test_the_nearest_point():
    got = geometry.sphere_triangle([0.25, 0.25, 2.0], [1.9, 2.0], [0, 0, 0], [1, 0, 0], [0, 1, 0], full_output=True)
    assert got.overlap.tolist() == [False, True]
    assert np.allclose(got.point, [0.25, 0.25, 0]) and np.allclose(got.distance, 2)
