"""Segments: the least distance of exact arithmetic, parallel, overlapping, crossing and vanishing ones too."""

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

from .rational import add, cross, dot, nearest_on_segment, root, sub, times, vector

PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def exact(a, b, c, d):
    """The least distance, at an end of a segment or inside of both; whether the rounded differences are parallel."""
    parallel = not any(cross(vector(b - a), vector(d - c)))
    a, b, c, d = (vector(v) for v in (a, b, c, d))
    u, v, w = sub(b, a), sub(d, c), sub(c, a)
    pairs = [(0, nearest_on_segment(a, c, d)), (1, nearest_on_segment(b, c, d))]
    pairs += [(nearest_on_segment(c, a, b), 0), (nearest_on_segment(d, a, b), 1)]
    n = cross(u, v)
    if any(n):
        s, t = dot(cross(w, v), n) / dot(n, n), dot(cross(w, u), n) / dot(n, n)
        if 0 <= s <= 1 and 0 <= t <= 1:
            pairs.append((s, t))
    between = [sub(add(w, times(v, t)), times(u, s)) for s, t in pairs]
    return root(min(dot(x, x) for x in between)), parallel


def check(segments, pair, dtype):
    distance, parallel = exact(*segments)
    a, b, c, d = (x.astype(float) for x in segments)
    size = max(np.linalg.norm(b - a), np.linalg.norm(d - c), float(distance))
    bound = 8 * np.finfo(dtype).eps * size
    assert abs(float(pair.distance) - float(distance)) <= bound
    assert pair.parallel == parallel
    assert 0 <= pair.s <= 1 and 0 <= pair.t <= 1
    between = c + float(pair.t) * (d - c) - a - float(pair.s) * (b - a)
    scale = size + np.abs(np.stack([a, b, c, d])).max()
    assert abs(np.linalg.norm(between) - float(distance)) <= bound + 1e-15 * scale


@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(*[st.integers(-3, 3)] * 3), min_size=4, max_size=4), st.sampled_from([1, 3, 10]))
def test_least_distance_on_a_grid(ends, divisor):
    for dtype in (np.float32, np.float64):
        segments = [np.array(x, dtype) / dtype(divisor) for x in ends]
        check(segments, sl.geometry.segment_segment(*segments), dtype)


@PRECISIONS
@pytest.mark.parametrize("tilt", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("shift", [0, 1e6])
def test_least_distance_of_near_parallel_segments(dtype, tilt, shift):
    rng = np.random.default_rng(1)
    a, u, tiny, gap = rng.normal(size=(4, 80, 3))
    b, c = a + u, a + rng.uniform(-1, 1, (80, 1)) * u + 1e-3 * gap
    d = c + rng.uniform(-2, 2, (80, 1)) * u + tilt * tiny
    segments = [(x + shift).astype(dtype) for x in (a, b, c, d)]
    pair = sl.geometry.segment_segment(*segments)
    for i in range(80):
        check([x[i] for x in segments], type(pair)(*(x[i] for x in pair)), dtype)


@PRECISIONS
@pytest.mark.parametrize("tilt", [1e-3, 1e-7, 1e-10])
def test_least_distance_of_segments_that_cross_almost_parallel(dtype, tilt):
    rng = np.random.default_rng(6)
    a, u, tiny = rng.normal(size=(3, 80, 3))
    x, y, back = a + rng.uniform(0, 1, (80, 1)) * u, u + tilt * tiny, rng.uniform(0, 1, (80, 1))
    segments = [x.astype(dtype) for x in (a, a + u, x - back * y, x + (1 - back) * y)]
    pair = sl.geometry.segment_segment(*segments)
    for i in range(80):
        check([x[i] for x in segments], type(pair)(*(x[i] for x in pair)), dtype)


@PRECISIONS
@pytest.mark.parametrize("size", [1e-25, 1e-15, 1e15])
def test_least_distance_at_any_size(dtype, size):
    segments = (size * np.random.default_rng(2).normal(size=(4, 60, 3))).astype(dtype)
    pair = sl.geometry.segment_segment(*segments)
    for i in range(60):
        check(segments[:, i], type(pair)(*(x[i] for x in pair)), dtype)


def test_no_sample_is_nearer():
    segments = np.random.default_rng(3).normal(size=(4, 50, 1, 1, 3))
    a, b, c, d = segments
    s, t = np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 41))
    brute = np.linalg.norm(c + t[..., None] * (d - c) - a - s[..., None] * (b - a), axis=-1).min((1, 2))
    got = sl.geometry.segment_segment(*segments[:, :, 0, 0]).distance
    assert (got <= brute + 1e-12).all() and (brute - got < 0.1).all()


def test_ends_are_exact_and_points_are_segments():
    a, b, c, d = np.random.default_rng(4).normal(size=(4, 3))
    far = sl.geometry.segment_segment(a, b, b, b + (b - a))
    assert far.distance == 0 and np.array_equal(far.first, b) and np.array_equal(far.second, b)
    point = sl.geometry.segment_segment(a, a, c, c)
    assert point.distance == pytest.approx(np.linalg.norm(a - c)) and point.parallel
    swapped = sl.geometry.segment_segment(c, d, a, b)
    assert swapped.distance == pytest.approx(sl.geometry.segment_segment(a, b, c, d).distance, rel=1e-14)


def test_nan_stays_in_its_element():
    segments = np.random.default_rng(5).normal(size=(4, 3, 3))
    clean = sl.geometry.segment_segment(*segments)
    segments[0, 0, 0], segments[3, 1, 1] = np.nan, np.inf
    pair = sl.geometry.segment_segment(*segments)
    assert np.isnan(pair.distance[:2]).all() and pair.distance[2] == clean.distance[2]
    with pytest.raises(ValueError, match="cannot broadcast"):
        sl.geometry.segment_segment(np.zeros((2, 3)), np.zeros((3, 3)), [0, 0, 0], [1, 0, 0])
