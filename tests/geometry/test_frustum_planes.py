"""Frustum planes: distances to them are those of what the projection was made of."""

import numpy as np
import pytest
from shadelab import geometry, transform

DEPTHS = ("standard", "zero_to_one", "reversed")


@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("far", [50.0, np.inf])
def test_planes_are_those_of_the_frustum_in_eye_space(depth, far):
    m = transform.perspective(left=-1, right=2, bottom=-0.5, top=1.5, near=2, far=far, depth=depth)
    got = geometry.frustum_planes(m, depth=depth)
    sides = np.array([[2, 0, -1, 0], [-2, 0, -2, 0], [0, 2, -0.5, 0], [0, -2, -1.5, 0]], float)
    sides /= np.linalg.norm(sides, axis=-1, keepdims=True)
    last = [0, 0, 0, 1] if far == np.inf else [0, 0, 1, far]
    assert np.allclose(got, [*sides, [0, 0, -1, -2], last], atol=1e-12)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("depth", DEPTHS)
def test_a_point_shows_where_all_heights_are_positive(depth, dtype):
    rng = np.random.default_rng(1)
    view = transform.look_at([3, 2, 5.0], [0, 1, 0])
    m = transform.perspective(fov_y=1.0, aspect=1.5, near=0.5, far=20.0, depth=depth) @ view
    planes = geometry.frustum_planes(m.astype(dtype), depth=depth)
    assert planes.dtype == dtype and planes.shape == (6, 4)
    p = rng.normal(size=(5000, 3)) * 5
    clip = np.concatenate([p, np.ones((5000, 1))], -1) @ m.T
    w = clip[:, 3:]
    low = -w if depth == "standard" else 0 * w
    near_far = np.concatenate([clip[:, 2:3] - low, w - clip[:, 2:3]], -1)
    if depth == "reversed":
        near_far = near_far[:, ::-1]
    margins = np.concatenate([w + clip[:, :1], w - clip[:, :1], w + clip[:, 1:2], w - clip[:, 1:2], near_far], -1)
    heights = p @ planes[:, :3].T + planes[:, 3]
    assert np.array_equal((heights > 0) | (np.abs(heights) < 1e-4), (margins > 0) | (np.abs(heights) < 1e-4))
    assert np.allclose(np.linalg.norm(planes[:, :3], axis=-1), 1, atol=2e-7 if dtype == np.float32 else 4e-16)


def test_batches_bad_arguments_and_nan():
    m = np.stack([transform.perspective(fov_y=1.0, near=0.1, far=9.0)] * 3)
    m[1, 0, 0] = np.nan
    planes = geometry.frustum_planes(m)
    assert planes.shape == (3, 6, 4) and np.isfinite(planes[[0, 2]]).all() and np.isnan(planes[1, 0]).all()
    with pytest.raises(ValueError, match="depth: expected one of"):
        geometry.frustum_planes(m, depth="linear")
