"""Rays and boxes: hit if and only if exact arithmetic says so; within faces, along edges, through corners."""

from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

from .rational import vector

METHODS = ["exact", "conservative", "slabs"]
PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def exact(o, d, lower, upper):
    """The line's stay in the closed box; None if it misses."""
    enter, leave = None, None
    for x, v, a, b in zip(*(vector(w) for w in (o, d, lower, upper)), strict=True):
        if a > b:
            return None
        if v == 0:
            if not a <= x <= b:
                return None
            continue
        near, far = sorted([(a - x) / v, (b - x) / v])
        enter = near if enter is None else max(enter, near)
        leave = far if leave is None else min(leave, far)
    return (enter, leave) if enter <= leave else None


def check(o, d, lower, upper, hit, eps):
    want = exact(o, d, lower, upper)
    assert np.isfinite(hit.t_enter) == (want is not None)
    if want is not None:
        for got, t in zip((hit.t_enter, hit.t_exit), want, strict=True):
            assert abs(Fraction(float(got)) - t) <= 2 * Fraction(eps) * abs(t)
        assert (hit.t < np.inf) == (float(hit.t_exit) >= 0)


# Coordinates on a coarse grid, over divisors that are not exact: edges and corners are met all the time.
grid = st.tuples(*[st.integers(-4, 4)] * 3)


@settings(max_examples=300, deadline=None)
@given(o=grid, aim=grid, a=grid, b=grid, divisor=st.sampled_from([1, 3, 7, 10]))
def test_hits_are_the_exact_ones(o, aim, a, b, divisor):
    for dtype in (np.float32, np.float64):
        o_, aim_, a_, b_ = (np.array(x, dtype) / dtype(divisor) for x in (o, aim, a, b))
        d = aim_ - o_
        if not d.any():
            continue
        lower, upper = np.minimum(a_, b_), np.maximum(a_, b_)
        hit = sl.geometry.ray_aabb(o_, d, lower, upper)
        check(o_, d, lower, upper, hit, float(np.finfo(dtype).eps))


@PRECISIONS
def test_lines_through_edges_and_corners_are_decided_exactly(dtype):
    rng = np.random.default_rng(1)
    lower = rng.normal(size=(400, 3)).astype(dtype)
    upper = lower + rng.uniform(0.1, 2, (400, 3)).astype(dtype)
    corner = np.where(rng.integers(0, 2, (400, 3)), lower, upper)
    o = rng.normal(size=(400, 3)).astype(dtype) * 4
    d = corner - o
    hit = sl.geometry.ray_aabb(o, d, lower, upper)
    textbook = sl.geometry.ray_aabb(o, d, lower, upper, method="slabs")
    for i in range(400):
        check(o[i], d[i], lower[i], upper[i], type(hit)(*(x[i] for x in hit)), float(np.finfo(dtype).eps))
    # The textbook's products decide otherwise here and there.
    assert (np.isfinite(hit.t_enter) != np.isfinite(textbook.t_enter)).any()


@PRECISIONS
@pytest.mark.parametrize("shift", [0, 1e6])
def test_conservative_loses_no_box(dtype, shift):
    rng = np.random.default_rng(2)
    lower = (rng.normal(size=(5000, 3)) + shift).astype(dtype)
    upper = np.maximum(lower, (lower + rng.uniform(0, 2, (5000, 3))).astype(dtype))
    corner = np.where(rng.integers(0, 2, (5000, 3)), lower, upper)
    o = (rng.normal(size=(5000, 3)) * 4 + shift).astype(dtype)
    d = corner - o
    met = np.isfinite(sl.geometry.ray_aabb(o, d, lower, upper).t_enter)
    kept = np.isfinite(sl.geometry.ray_aabb(o, d, lower, upper, method="conservative").t_enter)
    # Far away the coordinates are so coarse that differences are exact, and so are lines through corners.
    assert kept[met].all() and ((kept != met).any() or shift)


@pytest.mark.parametrize("d", [[1.0, 0, 0], [1.0, -0.0, 0.0], [1.0, -0.0, -0.0]])
@pytest.mark.parametrize("method", ["exact", "conservative"])
def test_rays_within_faces_and_along_edges_hit(d, method):
    o = np.array([[-1, 0, 0.5], [-1, 1, 0.5], [-1, 0, 0], [-1, 1, 1], [-1, 0.5, 0.5]], float)
    assert (sl.geometry.ray_aabb(o, d, [0, 0, 0], [1, 1, 1], method=method).t == 1).all()
    outside = o + np.array([0, 1.5, 0])
    assert np.isinf(sl.geometry.ray_aabb(outside, d, [0, 0, 0], [1, 1, 1], method=method).t).all()


def test_the_textbook_loses_rays_within_a_face():
    assert np.isinf(sl.geometry.ray_aabb([-1, 0, 0.5], [1.0, 0, 0], [0, 0, 0], [1, 1, 1], method="slabs").t)


@pytest.mark.parametrize("method", ["exact", "conservative"])
def test_boxes_of_zero_thickness(method):
    flat = ([0, 0, 0.25], [1, 1, 0.25])
    assert sl.geometry.ray_aabb([0.5, 0.5, 1], [0, 0, -3.0], *flat, method=method).t == 0.25
    assert sl.geometry.ray_aabb([-1, 0.5, 0.25], [1.0, 0, 0], *flat, method=method).t == 1
    point = ([0.1, 0.2, 0.3], [0.1, 0.2, 0.3])
    assert sl.geometry.ray_aabb([0.1, 0.2, 5], [0, 0, -1.0], *point, method=method).t == 4.7
    assert np.isinf(sl.geometry.ray_aabb([0.1, 0.2, 5], [0, 1e-9, -1.0], *point, method=method).t)


@PRECISIONS
@pytest.mark.parametrize("length", [1e-20, 1e20])
@pytest.mark.parametrize("method", METHODS)
def test_length_of_direction_scales_t_alone(dtype, length, method):
    rng = np.random.default_rng(3)
    o, d, lower = rng.normal(size=(3, 500, 3)).astype(dtype)
    factor = dtype(2.0 ** np.round(np.log2(length)))
    one, many = (sl.geometry.ray_aabb(o, x, lower, lower + 2, method=method) for x in (d, d * factor))
    assert all(np.array_equal(x / factor, y) for x, y in zip(one, many, strict=True))


def test_slabs_and_faces():
    hit = sl.geometry.ray_aabb([2, 0.5, 3], [-1, 0, -2.0], [0, 0, 0], [1, 1, 1], full_output=True)
    assert np.array_equal(hit.slab_enter, [1, -np.inf, 1]) and np.array_equal(hit.slab_exit, [2, np.inf, 1.5])
    assert (hit.t, hit.t_exit, hit.face_enter, hit.face_exit) == (1, 1.5, 0, 5)
    miss = sl.geometry.ray_aabb([2, 5, 3], [-1, 0, -2.0], [0, 0, 0], [1, 1, 1], full_output=True)
    assert (miss.t, miss.t_enter, miss.t_exit, miss.face_enter) == (np.inf, np.inf, -np.inf, -1)


@PRECISIONS
def test_faces_hold_the_points_of_entry_and_exit(dtype):
    rng = np.random.default_rng(4)
    o, d, lower = rng.normal(size=(3, 2000, 3)).astype(dtype)
    upper = lower + 2
    hit = sl.geometry.ray_aabb(o, d, lower, upper, full_output=True)
    met = np.isfinite(hit.t_enter)
    for t, face in ((hit.t_enter, hit.face_enter), (hit.t_exit, hit.face_exit)):
        point = o[met] + t[met, None].astype(float) * d[met]
        axis, upper_face = face[met] // 2, face[met] % 2 == 0
        row = np.arange(met.sum())
        wall = np.where(upper_face, upper[met][row, axis], lower[met][row, axis])
        # t is right to an eps of itself.
        bound = 10 * np.finfo(dtype).eps * (1 + np.abs(t[met] * d[met][row, axis]))
        assert (np.abs(point[row, axis] - wall) <= bound).all()
    assert (hit.face_enter[~met] == -1).all()


def test_interior_interval_infinite_and_empty_boxes():
    box = ([0, 0, 0], [1, 1, 1])
    inside = sl.geometry.ray_aabb([0.5, 0.5, 0.5], [1.0, 0, 0], *box)
    assert [float(x) for x in inside] == [0, -0.5, 0.5]
    assert sl.geometry.ray_aabb([0.5, 0.5, 0.5], [1.0, 0, 0], *box, t_min=0.5).t == 0.5
    assert np.isinf(sl.geometry.ray_aabb([0.5, 0.5, 0.5], [1.0, 0, 0], *box, t_min=0.51).t)
    assert np.isinf(sl.geometry.ray_aabb([-2, 0.5, 0.5], [1.0, 0, 0], *box, t_max=1.9).t)
    half = sl.geometry.ray_aabb([0, 5, 0], [0, -1.0, 0], [-np.inf] * 3, [np.inf, 1, np.inf], full_output=True)
    assert (half.t, half.t_exit, half.face_enter, half.face_exit) == (4, np.inf, 2, -1)
    assert np.isinf(sl.geometry.ray_aabb([0, 5, 0], [0, -1.0, 0], [1, 1, 1], [0, 0, 0]).t)


@pytest.mark.parametrize("method", METHODS)
def test_nan_stays_in_its_element(method):
    o, d = np.full((6, 3), 0.5) - [3, 0, 0], np.tile([1.0, 0.01, 0.01], (6, 1))
    lower, upper, t_min = np.zeros((6, 3)), np.ones((6, 3)), np.zeros(6)
    clean = sl.geometry.ray_aabb(o, d, lower, upper, method=method)
    o[0, 1], d[1], lower[2, 2], o[3, 0], t_min[4] = np.nan, 0, np.nan, np.inf, np.nan
    hit = sl.geometry.ray_aabb(o, d, lower, upper, method=method, t_min=t_min)
    assert all(np.isnan(x[:5]).all() and x[5] == y[5] for x, y in zip(hit, clean, strict=True))


def test_broadcasts_rays_over_boxes():
    rng = np.random.default_rng(5)
    o, d, lower = rng.normal(size=(3, 5, 3)).astype(np.float32)
    all_pairs = sl.geometry.ray_aabb(o[:, None], d[:, None], lower, lower + 1)
    assert all_pairs.t.shape == (5, 5) and all_pairs.t.dtype == np.float32
    with pytest.raises(ValueError, match="method: expected one of"):
        sl.geometry.ray_aabb(o, d, lower, lower, method="fast")
