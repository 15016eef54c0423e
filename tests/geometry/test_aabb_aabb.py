"""Boxes along the axes: the overlap of intervals, touching included."""

import numpy as np
import pytest
from shadelab import geometry


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_boxes_overlap_where_they_share_a_grid_point(dtype):
    rng = np.random.default_rng(1)
    al, bl = rng.integers(0, 5, (2, 500, 3))
    ah, bh = al + rng.integers(0, 3, (500, 3)), bl + rng.integers(0, 3, (500, 3))
    # On a grid, boxes that meet have a grid point in common.
    grid = np.stack(np.meshgrid(*3 * [np.arange(8)], indexing="ij"), -1).reshape(-1, 1, 3)
    both = ((grid >= al) & (grid <= ah) & (grid >= bl) & (grid <= bh)).all(-1).any(0)
    got = geometry.aabb_aabb(*(x.astype(dtype) for x in (al, ah, bl, bh)), full_output=True)
    assert np.array_equal(got.overlap, both) and 50 < both.sum() < 450
    assert np.array_equal(got.overlap, (got.gaps <= 0).all(-1)) and got.gaps.dtype == dtype


def test_one_ulp_parts_them():
    one = np.nextafter(np.float32(1), np.float32(2))
    low, high = np.zeros((2, 3), np.float32), np.ones((2, 3), np.float32)
    other = np.array([[1, 0, 0], [one, 0, 0]], np.float32)
    assert geometry.aabb_aabb(low, high, other, other + 1).tolist() == [True, False]


def test_empty_infinite_and_nan_boxes():
    low = [[0, 0, 0], [2, 0, 0], [-np.inf] * 3, [np.nan, 0, 0]]
    high = [[1, 1, 1], [1, 1, 1], [np.inf] * 3, [1, 1, 1.0]]
    assert geometry.aabb_aabb(low, high, [-9, -9, -9], [9, 9, 9]).tolist() == [True, False, True, False]


def test_leading_axes_broadcast():
    assert geometry.aabb_aabb(np.zeros((4, 1, 3)), np.ones((4, 1, 3)), np.zeros((5, 3)), np.ones((5, 3))).shape == (
        4,
        5,
    )
