"""Angular order: that of exact angles, ties by distance, whatever the shape of the input."""

from functools import cmp_to_key

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

from .rational import sub, vector


def exact_order(points, center):
    vectors = [sub(vector(p), vector(center)) for p in points]

    def compare(i, j):
        (ax, ay), (bx, by) = vectors[i], vectors[j]
        halves = [0 if not (x or y) else 1 if y > 0 or (y == 0 and x > 0) else 2 for x, y in (vectors[i], vectors[j])]
        turn = ax * by - ay * bx if halves[0] == halves[1] else 0
        return halves[0] - halves[1] or -turn or (ax * ax + ay * ay) - (bx * bx + by * by) or i - j

    return sorted(range(len(points)), key=cmp_to_key(lambda i, j: (c := compare(i, j)) and (1 if c > 0 else -1)))


grid = st.tuples(st.integers(-4, 4), st.integers(-4, 4))


@settings(max_examples=150, deadline=None)
@given(st.lists(grid, max_size=20), grid, st.sampled_from([1, 3, 10]))
def test_order_is_the_exact_one(points, center, divisor):
    for dtype in (np.float32, np.float64):
        p = np.array(points, dtype).reshape(-1, 2) / dtype(divisor)
        c = np.array(center, dtype) / dtype(divisor)
        assert sl.geometry.sort_by_angle(p, c).tolist() == exact_order(p, c)


@pytest.mark.parametrize("shift", [0, 1e6])
def test_order_within_roundings_of_one_direction(shift):
    rng = np.random.default_rng(1)
    ray = rng.uniform(1, 100, (200, 1)) * [0.3, 0.7] * rng.choice([-1, 1], (200, 1)) + shift
    center = np.array([shift, shift])
    assert sl.geometry.sort_by_angle(ray, center).tolist() == exact_order(ray, center)


def test_angles_ascend():
    p = np.random.default_rng(2).normal(size=(3, 500, 2))
    order = sl.geometry.sort_by_angle(p)
    sorted_ = np.take_along_axis(p, order[..., None], -2)
    angle = np.arctan2(sorted_[..., 1], sorted_[..., 0]) % (2 * np.pi)
    assert (np.diff(angle, axis=-1) >= 0).all()


def test_star_shaped_polygons_come_back():
    rng = np.random.default_rng(3)
    angle = np.sort(rng.uniform(0, 2 * np.pi, 40))
    polygon = rng.uniform(0.5, 1, (40, 1)) * np.stack([np.cos(angle), np.sin(angle)], -1)
    mixed = rng.permutation(polygon)
    assert np.array_equal(mixed[sl.geometry.sort_by_angle(mixed)], polygon)


def test_nan_center_and_broadcast():
    points = np.array([[0, -1], [np.nan, 0], [1, 0], [0, 0], [0, np.inf], [2, 0.0]])
    assert sl.geometry.sort_by_angle(points).tolist() == [3, 2, 5, 0, 1, 4]
    assert sl.geometry.sort_by_angle(points, [np.nan, 0]).tolist() == list(range(6))
    assert sl.geometry.sort_by_angle(points, np.zeros((7, 2))).shape == (7, 6)
    with pytest.raises(ValueError, match=r"points: expected shape"):
        sl.geometry.sort_by_angle([1.0, 2.0])
