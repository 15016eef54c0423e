"""Barycentric coordinates: reconstruct the point, agree with trimesh."""

import numpy as np
import pytest
import shadelab as sl
import trimesh


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_weights_reconstruct_points_in_the_plane(dtype):
    rng = np.random.default_rng(1)
    a, b, c = rng.normal(size=(3, 500, 3)).astype(dtype)
    w = rng.dirichlet([1, 1, 1], 500).astype(dtype)
    got = sl.geometry.barycentric(w[:, :1] * a + w[:, 1:2] * b + w[:, 2:] * c, a, b, c)
    assert got.dtype == dtype
    # Random triangles may be thin: the error grows with (longest edge / height)^2.
    e = np.stack([b - a, c - b, a - c]).astype(np.float64)
    thin = (np.linalg.norm(e, axis=-1).max(0) ** 2 / np.linalg.norm(np.cross(e[0], e[2]), axis=-1)) ** 2
    assert (np.abs(got - w).max(-1) < 20 * np.finfo(dtype).eps * np.maximum(thin, 1)).all()


def test_agrees_with_trimesh_off_the_plane():
    rng = np.random.default_rng(2)
    t = rng.normal(size=(200, 3, 3))
    p = rng.normal(size=(200, 3))
    expected = trimesh.triangles.points_to_barycentric(t, p, method="cross")
    got = sl.geometry.barycentric(p, t[:, 0], t[:, 1], t[:, 2])
    # Both lose digits on thin triangles; where they are not thin, 1e-9 leaves six digits of slack.
    area = np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=-1)
    assert np.allclose(got[area > 0.5], expected[area > 0.5], atol=1e-9)


def test_degenerate_triangle_gives_nan_and_touches_no_other():
    got = sl.geometry.barycentric([[0.0, 0, 0]] * 2, [[0.0, 0, 0]] * 2, [[1.0, 0, 0]] * 2, [[2.0, 0, 0], [0, 1, 0]])
    assert np.isnan(got[0]).all() and np.array_equal(got[1], [1, 0, 0])


def test_bad_shapes_name_the_argument():
    with pytest.raises(ValueError, match=r"points: expected shape \(\.\.\., 3\), got \(7, 2\)"):
        sl.geometry.barycentric(np.zeros((7, 2)), [0, 0, 0], [1, 0, 0], [0, 1, 0])
