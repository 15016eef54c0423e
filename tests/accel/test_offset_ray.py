"""Offset origins never meet the face that they start on, at any scale and any angle."""

import numpy as np
import pytest
import shadelab as sl


def starts(rng, positions, faces, n, grazing):
    """Points on random faces, their unit normals, and directions that leave above by as little as `grazing`."""
    dtype = positions.dtype
    face = rng.integers(len(faces), size=n)
    a, b, c = (positions[faces[face, k]] for k in range(3))
    w = rng.dirichlet([0.5] * 3, n).astype(dtype)
    points = ((1 - w[:, :1] - w[:, 1:2]) * a + w[:, :1] * b + w[:, 1:2] * c).astype(dtype)
    normal = np.cross((b - a).astype(float), (c - a).astype(float))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    tangent = (rng.normal(size=(n, 1)) * (b - a) + rng.normal(size=(n, 1)) * (c - a)).astype(float)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    lift = 10 ** rng.uniform(np.log10(grazing), 0, (n, 1))
    return face, points, normal.astype(dtype), (tangent + lift * normal).astype(dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(("scale", "shift"), [(1, 0), (1e-6, 0), (1e6, 0), (1, 1e3), (100, 1e6)])
@pytest.mark.parametrize("side", [1, -1])
def test_a_ray_never_meets_its_own_face(dtype, scale, shift, side):
    rng = np.random.default_rng(8)
    # Fat triangles, so that normals are right; the claim does not cover needles.
    corners = np.array([[0, 0, 0], [1, 0.1, 0], [0.2, 0.9, 0]])
    turns = np.linalg.qr(rng.normal(size=(400, 3, 3)))[0]
    p = (scale * (corners @ turns + rng.normal(size=(400, 1, 3))) + shift).reshape(-1, 3).astype(dtype)
    f = np.arange(1200).reshape(-1, 3)
    face, points, normals, directions = starts(rng, p, f, 20000, 1e-7)
    directions = (side * directions).astype(dtype)
    extent = np.abs(p[f[face]]).max((1, 2))
    o = sl.accel.offset_ray(points, normals, directions, extent=extent)
    hit = sl.geometry.ray_triangle(o, directions, *(p[f[face, k]] for k in range(3)))
    assert not np.isfinite(hit.t).any()
    bvh = sl.accel.BVH(p, f)
    assert (bvh.closest_hit(o, directions).face != face).all()
    # Without the offset the test would mean nothing.
    assert (bvh.closest_hit(points, directions).face == face).any()


def test_extent_of_a_tree_is_its_largest_coordinate():
    p = np.array([[0, 0, 0], [1, 0, 0], [0, -3, 0.0]])
    bvh = sl.accel.BVH(p, [[0, 1, 2]])
    o, n = [0.1, -0.1, 0.0], [0.0, 0.0, 1.0]
    assert np.array_equal(sl.accel.offset_ray(o, n, extent=bvh), sl.accel.offset_ray(o, n, extent=3.0))


def test_nan_stays_in_its_element():
    points = np.zeros((3, 3), np.float32)
    points[1] = np.nan
    points[2] = 5
    o = sl.accel.offset_ray(points, [0, 1, 0])
    assert np.isnan(o[1]).any() and np.isfinite(o[[0, 2]]).all() and o[0, 1] > 0


def test_a_point_at_infinity_moves_no_other():
    p = np.array([[np.inf, 0, 0], [1, 0, 0]], np.float32)
    moved = sl.accel.offset_ray(p, np.array([0, 0, 1], np.float32))
    assert 0 < moved[1, 2] < 1e-5
    with pytest.raises(ValueError, match="extent"):
        sl.accel.offset_ray(p[1], [0, 0, 1.0], extent=-1)
