"""Lines: the common normal of exact arithmetic, parallel lines, lines that meet."""

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

from .rational import add, cross, dot, root, sub, times, vector

PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def exact(o1, d1, o2, d2):
    """`s`, `t` (None if parallel) and the distance."""
    o1, d1, o2, d2 = (vector(v) for v in (o1, d1, o2, d2))
    n, w = cross(d1, d2), sub(o2, o1)
    if not any(n):
        t = -dot(w, d2) / dot(d2, d2)
        foot = add(w, times(d2, t))
        return None, t, root(dot(foot, foot))
    squared = dot(n, n)
    return dot(cross(w, d2), n) / squared, dot(cross(w, d1), n) / squared, abs(dot(n, w)) / root(squared)


@PRECISIONS
@pytest.mark.parametrize("angle", [1, 1e-3, 1e-6])
@pytest.mark.parametrize("length", [1, 1e-20, 1e15])
def test_nearest_points_are_the_exact_ones(dtype, angle, length):
    rng = np.random.default_rng(1)
    o1, d1, o2, d2 = rng.normal(size=(4, 60, 3))
    d2 = d1 + angle * d2
    o1, d1, o2, d2 = (x.astype(dtype) for x in (o1, d1 * length, o2, d2))
    pair = sl.geometry.line_line(o1, d1, o2, d2)
    eps = float(np.finfo(dtype).eps)
    for i in range(60):
        s, t, distance = exact(o1[i], d1[i], o2[i], d2[i])
        a, b = d1[i].astype(float) / length, d2[i].astype(float)
        w = np.linalg.norm(o2[i].astype(float) - o1[i])
        sine = np.linalg.norm(np.cross(a, b)) / (np.linalg.norm(a) * np.linalg.norm(b))
        bound = 10 * eps * w / sine
        assert abs(float(pair.s[i]) - float(s)) * np.linalg.norm(a) * length <= bound
        assert abs(float(pair.t[i]) - float(t)) * np.linalg.norm(b) <= bound
        assert abs(float(pair.distance[i]) - float(distance)) <= 10 * eps * w
    assert not pair.parallel.any()


@settings(max_examples=150, deadline=None)
@given(*[st.tuples(*[st.integers(-9, 9)] * 3) for _ in range(4)])
def test_parallel_only_if_they_are(o1, d1, o2, d2):
    for dtype in (np.float32, np.float64):
        lines = [np.array(x, dtype) / dtype(10) for x in (o1, d1, o2, d2)]
        pair = sl.geometry.line_line(*lines)
        if not any(d1) or not any(d2):
            assert np.isnan(pair.s) and np.isnan(pair.distance)
            continue
        s, t, distance = exact(*lines)
        assert pair.parallel == (s is None)
        w = max(np.linalg.norm(lines[2].astype(float) - lines[0]), 1e-30)
        assert abs(float(pair.distance) - float(distance)) <= 10 * np.finfo(dtype).eps * w
        if s is None:
            assert pair.s == 0 and abs(float(pair.t) - t) * np.linalg.norm(lines[3]) <= 10 * np.finfo(dtype).eps * w


@PRECISIONS
def test_points_lie_on_their_lines_at_the_distance(dtype):
    o1, d1, o2, d2 = np.random.default_rng(2).normal(size=(4, 500, 3)).astype(dtype)
    pair = sl.geometry.line_line(o1, d1, o2, d2)
    assert np.allclose(pair.first, o1 + pair.s[:, None] * d1, rtol=1e-6)
    assert np.allclose(pair.second, o2 + pair.t[:, None] * d2, rtol=1e-6)
    between = pair.second.astype(float) - pair.first
    scale = 1 + np.abs(pair.first).max(-1) + np.abs(pair.second).max(-1)
    assert (np.abs(np.linalg.norm(between, axis=-1) - pair.distance) < 20 * np.finfo(dtype).eps * scale).all()


def test_meeting_and_identical_lines():
    meet = sl.geometry.line_line([0, 0, 0], [1.0, 0, 0], [3, -2, 0], [0, 2.0, 0])
    assert (meet.s, meet.t, meet.distance) == (3, 1, 0) and np.array_equal(meet.first, [3, 0, 0])
    same = sl.geometry.line_line([0, 0, 0], [1.0, 2, 3], [2, 4, 6], [-2.0, -4, -6])
    assert same.parallel and (same.s, same.t, same.distance) == (0, 1, 0)


def test_nan_stays_in_its_element():
    lines = np.random.default_rng(3).normal(size=(4, 4, 3))
    clean = sl.geometry.line_line(*lines)
    lines[0, 0, 0], lines[1, 1], lines[3, 2, 1] = np.nan, 0, np.inf
    pair = sl.geometry.line_line(*lines)
    assert np.isnan(pair.s[:3]).all() and np.isnan(pair.second[:3]).all() and not pair.parallel[:3].any()
    assert all(np.array_equal(x[3], y[3]) for x, y in zip(pair, clean, strict=True))
    with pytest.raises(ValueError, match=r"origins_2: expected shape"):
        sl.geometry.line_line([0, 0, 0], [1, 0, 0], [0, 0], [1, 0, 0])
