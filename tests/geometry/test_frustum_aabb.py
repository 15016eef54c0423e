"""Boxes and frusta: nothing that shows is lost, nothing inside sticks out, in exact arithmetic."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog
from shadelab import geometry, transform


def scene(dtype, depth, far=30.0, shift=0.0):
    view = transform.look_at([3 + shift, 2, 5.0], [shift, 1, 0])
    m = (transform.perspective(fov_y=1.0, aspect=1.5, near=0.5, far=far, depth=depth) @ view).astype(dtype)
    return m, geometry.frustum_planes(m, depth=depth)


def shows(m, p, depth):
    """Whether a point lies in the clip volume of a matrix as given, in rationals."""
    x, y, z, w = (sum(Fraction(float(a)) * Fraction(float(b)) for a, b in zip(row, [*p, 1], strict=True)) for row in m)
    return -w <= x <= w and -w <= y <= w and (-w if depth == "standard" else 0) <= z <= w


def points_on_the_border(m, planes, n, dtype, seed):
    """Points of the frustum's faces, off them by a few units of rounding."""
    rng = np.random.default_rng(seed)
    corners = (
        np.array([[x, y, z, 1] for x in (-1, 1) for y in (-1, 1) for z in (0, 0.9)]) @ np.linalg.inv(m.astype(float)).T
    )
    corners = corners[:, :3] / corners[:, 3:]
    p = (rng.dirichlet(np.ones(8), n)[..., None] * corners).sum(1)
    plane = planes[rng.integers(0, 6, n)].astype(float)
    p -= ((p * plane[:, :3]).sum(-1) + plane[:, 3])[:, None] * plane[:, :3]
    p = p.astype(dtype)
    return p + (rng.integers(-2, 3, (n, 3)) * np.spacing(np.abs(p).max(-1, keepdims=True))).astype(dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("depth", ["standard", "zero_to_one", "reversed"])
@pytest.mark.parametrize("shift", [0.0, 1e4])
def test_points_at_the_border_are_never_told_wrong(dtype, depth, shift):
    m, planes = scene(dtype, depth, shift=shift)
    p = points_on_the_border(m, planes, 400, dtype, 1)
    got = geometry.frustum_aabb(planes, p, p)
    seen = np.array([shows(m, x, depth) for x in p])
    assert not (seen & (got < 0)).any() and not (~seen & (got > 0)).any()
    assert 20 < seen.sum() < 380


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_rounding_leaves_little_untold(dtype):
    _, planes = scene(dtype, "standard")
    p = (np.random.default_rng(2).normal(size=(20000, 3)) * 5).astype(dtype)
    got = geometry.frustum_aabb(planes, p, p)
    # Points are in or out, but for a layer as thick as rounding.
    assert (got == 0).sum() <= 2 and 1000 < (got == 1).sum() < 19000


def test_every_answer_against_linear_programming():
    rng = np.random.default_rng(3)
    _, planes = scene(np.float64, "standard")
    n = 300
    low = rng.normal(size=(n, 3)) * 5 - [0, 0, 5]
    high = low + rng.exponential(3, (n, 3))
    got = geometry.frustum_aabb(planes, low, high, full_output=True)
    lost = 0
    for k in range(n):
        met = (
            linprog(
                np.zeros(3), A_ub=-planes[:, :3], b_ub=planes[:, 3], bounds=list(zip(low[k], high[k], strict=True))
            ).status
            == 0
        )
        corners = np.array(list(product(*zip(low[k], high[k], strict=True))))
        heights = corners @ planes[:, :3].T + planes[:, 3]
        assert (got.side[k] == 1) == (heights > 0).all()
        assert not (met and got.side[k] == -1)
        if got.side[k] == -1:
            assert (heights[:, got.plane[k]] < 0).all()
        lost += not met and got.side[k] == 0
    assert (np.bincount(got.side + 1) > 10).all()
    # Conservative, yet not useless: few boxes that do not show go unnoticed.
    assert lost < 0.15 * n


def test_an_infinite_far_plane_culls_nothing():
    for depth in ("standard", "zero_to_one", "reversed"):
        _, planes = scene(np.float32, depth, far=np.inf)
        behind = geometry.frustum_aabb(planes, [-3e6, -1, -5.1e6], [-2.9e6, 1, -5e6], full_output=True)
        assert behind.side >= 0 and behind.plane == -1


def test_nan_and_empty_boxes_are_not_lost():
    _, planes = scene(np.float64, "standard")
    low = [[99, 99, 99], [np.nan, 99, 99], [99, 99, 99.0]]
    assert geometry.frustum_aabb(planes, low, [[100, 100, 100], [100, 100, 100], [0, 0, 0]]).tolist() == [-1, 0, 0]
    with pytest.raises(ValueError, match=r"planes: expected shape \(\.\.\., 6, 4\)"):
        geometry.frustum_aabb(planes[:5], [0, 0, 0], [1, 1, 1])
