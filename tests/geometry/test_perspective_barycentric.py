"""Weights on the screen and on the triangle: a projection shows what they are."""

import numpy as np
import pytest
import shadelab as sl

from .rational import vector

PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def test_a_projected_point_has_its_weights():
    rng = np.random.default_rng(1)
    corners = rng.normal(size=(300, 3, 3)) - [0, 0, 4]
    weights = rng.dirichlet([1, 1, 1], 300)
    clip = sl.transform.perspective(fov_y=1.0, aspect=1.3, near=0.1, far=100.0) @ np.concatenate(
        [corners, np.ones((300, 3, 1))], -1
    ).swapaxes(-1, -2)
    w = clip[:, 3]
    screen = np.concatenate([clip[:, :2] / w[:, None], np.zeros((300, 1, 3))], 1)
    point = np.einsum("ni,nci->nc", weights, clip)
    shown = sl.geometry.barycentric(
        np.c_[point[:, :2] / point[:, 3:], np.zeros(300)], *(np.ascontiguousarray(screen[..., i]) for i in range(3))
    )
    area = np.abs(sl.geometry.signed_area(screen[:, :2].swapaxes(-1, -2)))
    clear = area > 1e-2
    assert np.allclose(sl.geometry.perspective_barycentric(shown, w)[clear], weights[clear], atol=1e-10)
    assert np.allclose(sl.geometry.perspective_barycentric(weights, w, inverse=True)[clear], shown[clear], atol=1e-10)


@PRECISIONS
@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("size", [1, 1e-30, 1e30])
def test_positive_weights_are_right_to_five_roundings(dtype, inverse, size):
    rng = np.random.default_rng(2)
    weights = rng.dirichlet([1, 1, 1], 200).astype(dtype)
    w = (size * 10 ** rng.uniform(-6, 6, (200, 3))).astype(dtype)
    got = sl.geometry.perspective_barycentric(weights, w, inverse=inverse)
    for i in range(200):
        a, b = vector(weights[i]), vector(w[i])
        raw = [x * y if inverse else x / y for x, y in zip(a, b, strict=True)]
        for k in range(3):
            want = raw[k] / sum(raw)
            assert abs(float(got[i, k]) - want) <= 5 * float(np.finfo(dtype).eps) * want


@PRECISIONS
def test_there_and_back(dtype):
    rng = np.random.default_rng(3)
    weights, w = rng.dirichlet([1, 1, 1], 500).astype(dtype), rng.uniform(0.1, 10, (500, 3)).astype(dtype)
    back = sl.geometry.perspective_barycentric(sl.geometry.perspective_barycentric(weights, w), w, inverse=True)
    assert np.abs(back - weights).max() < 20 * np.finfo(dtype).eps


def test_eye_plane_behind_infinity_and_nan():
    assert np.array_equal(sl.geometry.perspective_barycentric([0.2, 0.3, 0.5], [0, 1, 2]), [1, 0, 0])
    assert np.isnan(sl.geometry.perspective_barycentric([0.5, 0.5, 0], [1, -1, 1])).all()
    assert np.allclose(sl.geometry.perspective_barycentric([0.5, 0.25, 0.25], [1, -1, 1]), [1, -0.5, 0.5])
    both = sl.geometry.perspective_barycentric([[np.nan, 0, 1], [0.2, 0.3, 0.5]], [[1.0, 1, 1], [1, 1, np.inf]])
    assert np.isnan(both).all()
    with pytest.raises(ValueError, match="w: expected shape"):
        sl.geometry.perspective_barycentric([0.2, 0.3, 0.5], [1, 2])
