"""Oriented boxes and frusta: by their corners, and as boxes along the axes."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shadelab import geometry, transform

SIGNS = np.array(list(product((-1, 1), repeat=3)))


def planes_of(dtype=np.float64):
    view = transform.look_at([3, 2, 5.0], [0, 1, 0])
    return geometry.frustum_planes((transform.perspective(fov_y=1.0, near=0.5, far=30.0) @ view).astype(dtype))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_corners_tell(dtype):
    rng = np.random.default_rng(1)
    n = 2000
    planes = planes_of(dtype)
    center, half = (rng.normal(size=(n, 3)) * 5).astype(dtype), rng.exponential(2, (n, 3)).astype(dtype)
    axes = Rotation.random(n, rng=rng).as_matrix().astype(dtype)
    got = geometry.frustum_obb(planes, center, axes, half, full_output=True)
    corners = center[:, None].astype(float) + np.einsum("kj,nj,nji->nki", SIGNS, half.astype(float), axes.astype(float))
    heights = corners @ planes[:, :3].T.astype(float) + planes[:, 3]
    firm = np.abs(heights).min((1, 2)) > 1e-4
    expected = np.where((heights > 0).all((1, 2)), 1, np.where((heights < 0).all(1).any(1), -1, 0))
    assert np.array_equal(got.side[firm], expected[firm]) and firm.sum() > 0.9 * n
    assert (np.bincount(got.side + 1) > 20).all()
    out = got.side == -1
    assert (heights[out, :, got.plane[out]] < 0).all() and (got.plane[~out] == -1).all()


def test_boxes_along_the_axes_are_told_alike():
    rng = np.random.default_rng(2)
    center, half = rng.normal(size=(2000, 3)) * 5, rng.exponential(2, (2000, 3))
    one = geometry.frustum_aabb(planes_of(), center - half, center + half)
    assert np.array_equal(one, geometry.frustum_obb(planes_of(), center, np.eye(3), half))


def test_negative_extents_and_nan_are_not_lost():
    half = [[1, 1, 1], [1, -1, 1], [1, np.nan, 1]]
    assert geometry.frustum_obb(planes_of(), [99.0, 99, 99], np.eye(3), half).tolist() == [-1, 0, 0]
