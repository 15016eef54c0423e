"""Segments in rectangles and boxes: what rational arithmetic leaves, by both methods."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shadelab import geometry

METHODS = ("liang_barsky", "cohen_sutherland")


def left(p, q, low, high):
    """The interval of parameters within the box, in rationals; None if empty."""
    first, last = Fraction(0), Fraction(1)
    for a, b, lo, hi in zip(*([Fraction(float(x)) for x in v] for v in (p, q, low, high)), strict=True):
        if a == b:
            if not lo <= a <= hi:
                return None
            continue
        s, t = sorted([(lo - a) / (b - a), (hi - a) / (b - a)])
        first, last = max(first, s), min(last, t)
    return (first, last) if first <= last else None


def at(p, q, t):
    return np.array(
        [float(Fraction(float(a)) + t * (Fraction(float(b)) - Fraction(float(a)))) for a, b in zip(p, q, strict=True)]
    )


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("n", [2, 3])
def test_grids_where_corners_are_touched(method, n):
    point = st.tuples(*[st.integers(-4, 4)] * n)

    @settings(max_examples=200, deadline=None)
    @given(point, point, point, point)
    def check(p, q, one, other):
        low, high = np.minimum(one, other).astype(float), np.maximum(one, other).astype(float)
        expected = left(p, q, low, high)
        for dtype in (np.float32, np.float64):
            got = geometry.clip_segment(
                *(np.array(x, dtype) for x in (p, q, low, high)), method=method, full_output=True
            )
            assert bool(got.hit) == (expected is not None)
            if expected is None:
                assert np.isnan(got.start).all() and np.isnan(got.t).all()
                continue
            # A few units of rounding of coordinates of at most 4.
            for end, t in zip((got.start, got.end), expected, strict=True):
                assert np.abs(end - at(p, q, t)).max() <= 12 * np.finfo(dtype).eps
                assert (end >= low).all() and (end <= high).all()

    check()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_lines_through_corners_within_rounding(dtype, method, shift):
    rng = np.random.default_rng(1)
    count = 300
    low = np.full((count, 3), shift, dtype)
    high = low + dtype(64)
    # Through a point of an edge of the box, outside on both sides but for rounding.
    edge = rng.integers(0, 2, (count, 3)) * 64.0
    k = rng.integers(0, 3, count)
    edge[np.arange(count), k] = rng.uniform(0, 64, count)
    out = (edge - 32) * [[1, -1, 1]] * rng.uniform(0.5, 2, (count, 3))
    p, q = ((edge + s * out + shift).astype(dtype) for s in (1.0, -0.7))
    got = geometry.clip_segment(p, q, low, high, method=method, full_output=True)
    exact = [left(*x) for x in zip(p, q, low, high, strict=True)]
    assert got.hit.tolist() == [x is not None for x in exact] and 30 < got.hit.sum() < 290
    hit = got.hit
    assert ((got.start >= low) & (got.start <= high) & (got.end >= low) & (got.end <= high))[hit].all()
    # As documented: three units of the largest coordinate.
    tolerance = 3 * float(np.finfo(dtype).eps) * float(np.abs([p, q]).max())
    for i in np.flatnonzero(hit):
        for end, t in zip((got.start[i], got.end[i]), exact[i], strict=True):
            # Where the line grazes an edge, its parameter is loose, but not its distance from the segment.
            d = (q[i].astype(float) - p[i]) / np.linalg.norm(q[i].astype(float) - p[i])
            off = end - at(p[i], q[i], t)
            assert np.linalg.norm(off - (off @ d) * d) <= tolerance


def test_methods_agree():
    rng = np.random.default_rng(2)
    p, q = rng.normal(size=(2, 2000, 3)) * 2
    a, b = (geometry.clip_segment(p, q, [-1, -1, -1], [1, 1, 1], method=m, full_output=True) for m in METHODS)
    assert np.array_equal(a.hit, b.hit) and np.array_equal(a.codes, b.codes) and 200 < a.hit.sum() < 1800
    assert np.allclose(a.start, b.start, atol=1e-14, equal_nan=True) and np.allclose(
        a.t, b.t, atol=1e-14, equal_nan=True
    )


def test_codes_name_the_regions():
    got = geometry.clip_segment([-1, 2, 0.5], [0.5, 0.5, 9], [0, 0, 0], [1, 1, 1], full_output=True)
    assert got.codes.tolist() == [1 + 8, 32] and not got.hit


def test_nan_and_empty_windows_leave_nothing_and_touch_no_other():
    p = [[0, 0], [np.nan, 0], [0, 0], [0, np.inf]]
    got = geometry.clip_segment(p, [2.0, 0], [[-1, -1], [-1, -1], [1, 1], [-1, -1]], [[1, 1], [1, 1], [0, 0], [1, 1]])
    assert got.hit.tolist() == [True, False, False, False]
    assert np.array_equal(got.end[0], [1, 0]) and np.isnan(got.start[1:]).all()
    with pytest.raises(ValueError, match="start: expected shape"):
        geometry.clip_segment([0.0], [1.0], [0.0], [1.0])
