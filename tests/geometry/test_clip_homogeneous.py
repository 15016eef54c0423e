"""Clipping in clip space: inside to the bit, nothing lost, attributes as they were."""

from fractions import Fraction

import numpy as np
import pytest
from shadelab import geometry, transform

DEPTHS = ("standard", "zero_to_one", "reversed")


def inside(p, depth):
    x, y, z, w = np.moveaxis(p, -1, 0)
    low = -w if depth == "standard" else 0 * w
    return (x >= -w) & (x <= w) & (y >= -w) & (y <= w) & (z >= low) & (z <= w)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("depth", DEPTHS)
def test_what_is_left_is_inside_to_the_bit(dtype, depth):
    rng = np.random.default_rng(1)
    p = rng.normal(size=(3000, 4, 4)).astype(dtype)
    p[:, 3] = p[:, 0] + p[:, 1] - p[:, 2]
    got = geometry.clip_homogeneous(p, depth=depth, full_output=True)
    there = np.arange(got.points.shape[1]) < got.counts[:, None]
    assert inside(got.points, depth)[there].all() and np.isnan(got.points[~there]).all()
    assert 500 < (got.counts > 2).sum() < 2900 and got.points.dtype == dtype
    assert np.array_equal(got.codes == 0, inside(p, depth))


@pytest.mark.parametrize("depth", DEPTHS)
def test_points_and_attributes_stay_on_the_polygon(depth):
    rng = np.random.default_rng(2)
    p = rng.normal(size=(1000, 3, 4))
    # Weights of the corners as attributes: they must give the points back.
    got = geometry.clip_homogeneous(p, np.eye(3), depth=depth)
    assert got.attributes.shape == (1000, 9, 3)
    assert np.allclose(got.attributes @ p, got.points, atol=1e-12, equal_nan=True)
    assert np.nanmin(got.attributes) >= -1e-15 and np.allclose(np.nansum(got.attributes, -1)[got.counts > 0, 0], 1)


def test_nothing_that_shows_is_lost():
    rng = np.random.default_rng(3)
    p = rng.normal(size=(300, 3, 4)) * [1, 1, 1, 2]
    got = geometry.clip_homogeneous(p, np.eye(3))
    weights = rng.dirichlet([1, 1, 1], (300, 200))
    shown = inside(weights @ p, "standard")
    for i in range(300):
        if not shown[i].any():
            continue
        # In the triangle's own coordinates what is left is a convex polygon, which holds every sample that shows.
        corners = got.attributes[i, : got.counts[i], 1:]
        edges = np.roll(corners, -1, 0) - corners
        turn = edges[:, 0] * (weights[i, :, None, 2] - corners[:, 1]) - edges[:, 1] * (
            weights[i, :, None, 1] - corners[:, 0]
        )
        within = (turn >= -1e-12).all(-1)
        assert np.array_equal(within | (np.abs(turn).min(-1) < 1e-9), shown[i] | (np.abs(turn).min(-1) < 1e-9))
    assert 1000 < shown.sum() < 50000


def test_a_ground_plane_that_passes_behind_the_eye():
    m = transform.perspective(fov_y=1.0, near=0.1, far=1000.0) @ transform.look_at([0, 2, 0.0], [0, 1, -5])
    ground = np.array([[-1e4, 0, 1e4, 1], [1e4, 0, 1e4, 1], [1e4, 0, -1e4, 1], [-1e4, 0, -1e4, 1.0]]) @ m.T
    assert (ground[:, 3] < 0).any()
    for borders in (geometry.clip._BORDERS, ("near",)):
        got = geometry.clip_homogeneous(ground, borders=borders)
        assert got.counts >= 3 and (got.points[: got.counts, 3] > 0).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_shared_edges_are_clipped_alike(dtype):
    rng = np.random.default_rng(4)
    p = rng.normal(size=(500, 4, 4)).astype(dtype)
    a, b = geometry.clip_homogeneous(p[:, [0, 1, 2]]), geometry.clip_homogeneous(p[:, [1, 0, 3]])
    shared = 0
    for i in range(500):
        one, other = ({tuple(x) for x in c.points[i, : c.counts[i]].tolist()} for c in (a, b))
        e, f = p[i, 0].astype(float), p[i, 1].astype(float)
        # Corners on the common edge, between its ends, are in both, to the bit.
        for x in one | other:
            t = (np.array(x) - e) @ (f - e) / ((f - e) @ (f - e))
            if 1e-4 < t < 1 - 1e-4 and np.abs(e + t * (f - e) - x).max() < 1e-5:
                assert x in one and x in other
                shared += 1
    assert shared > 100


def test_corners_on_the_border_make_no_second_one():
    p = np.array([[-1, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1.0]])
    got = geometry.clip_homogeneous(p)
    assert got.counts == 3 and np.array_equal(got.points[:3], p)
    touching = np.array([[1, 0, 0, 1], [2, 1, 0, 1], [2, -1, 0, 1.0]])
    assert geometry.clip_homogeneous(touching).counts == 1


def test_clipped_ends_are_those_of_rational_arithmetic():
    rng = np.random.default_rng(5)
    p = rng.normal(size=(200, 3, 4)) + np.array([0, 0, 0, 1])
    got = geometry.clip_homogeneous(p, borders=["left"])
    for i in range(200):
        f = [[Fraction(float(x)) for x in q] for q in p[i]]
        expected = []
        for q, r in zip(f, f[1:] + f[:1], strict=True):
            dq, dr = q[0] + q[3], r[0] + r[3]
            if dq >= 0:
                expected.append(q)
            if dq * dr < 0:
                expected.append([x + dq / (dq - dr) * (y - x) for x, y in zip(q, r, strict=True)])
        left = got.points[i, : got.counts[i]]
        assert len(left) == len(expected)
        if expected:
            assert np.allclose(left, [[float(x) for x in q] for q in expected], atol=4e-15)


def test_nan_and_bad_arguments():
    p = np.array([[[-1, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1.0]]] * 2)
    p[0, 1, 3] = np.nan
    assert geometry.clip_homogeneous(p).counts.tolist() == [0, 3]
    with pytest.raises(ValueError, match="borders: expected one of"):
        geometry.clip_homogeneous(p, borders=["front"])
    with pytest.raises(ValueError, match=r"attributes: expected shape \(\.\.\., 3, C\), got \(2, 2\)"):
        geometry.clip_homogeneous(p, np.zeros((2, 2)))
