"""Irradiance: inverse squares, cosines, and far rectangles that are points."""

import numpy as np
import pytest
import shadelab as sl


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_punctual_lights_follow_their_laws(dtype):
    rng = np.random.default_rng(1)
    points, normals = rng.normal(size=(2, 500, 3)).astype(dtype)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    position, color = np.array([0.5, 2.0, -1.0]), np.array([1.0, 2.0, 0.0])
    to = position - points
    distance = np.linalg.norm(to, axis=-1)
    cosine = np.maximum((to * normals).sum(-1) / distance, 0)
    got = sl.light.irradiance(sl.light.PointLight(position, color), points, normals)
    assert got.dtype == dtype
    # Cosines near zero are sums that cancel: absolute, not relative.
    assert np.allclose(got, (cosine / distance**2)[:, None] * color, rtol=0, atol=20 * np.finfo(dtype).eps)
    sun = sl.light.DirectionalLight((0, -3, 0), color)
    expected = np.maximum(normals[:, 1:2], 0) * color
    assert np.allclose(sl.light.irradiance(sun, points, normals), expected, rtol=0, atol=4 * np.finfo(dtype).eps)


def test_a_far_rectangle_is_a_point():
    rect = sl.light.RectLight((0, 1000, 0), (0.1, 0, 0), (0, 0, 0.1), (5, 5, 5))
    point = sl.light.PointLight((0, 1000, 0), (5 * rect.area,) * 3)
    at, normal = np.array([0.0, 0, 0]), np.array([0.6, 0.8, 0])
    a, b = sl.light.irradiance(rect, at, normal), sl.light.irradiance(point, at, normal)
    # (size/distance)² = 1e-8 of difference, and the closed form's 1e-15 over a solid angle of 1e-8.
    assert np.allclose(a, b, rtol=2e-7)


def test_rectangles_shine_from_their_front_alone_unless_two_sided():
    edges = ((1, 0, 0), (0, 0, 1))
    one, both = (sl.light.RectLight((0, 1, 0), *edges, two_sided=t) for t in (False, True))
    above, below, level = ([0.1, 2.0, 0.2], [0.0, -1.0, 0.0]), ([0.1, 0.0, 0.2], [0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]
    assert sl.light.irradiance(one, *above).max() == 0 < sl.light.irradiance(both, *above).min()
    assert np.allclose(sl.light.irradiance(both, *above), sl.light.irradiance(one, *below))
    assert np.array_equal(sl.light.irradiance(both, level, [0.0, 1.0, 0.0]), [0, 0, 0])


def test_on_the_light_itself_nothing_is_nan():
    assert np.array_equal(sl.light.irradiance(sl.light.PointLight((1, 2, 3)), [1.0, 2, 3], [0.0, 1, 0]), [0, 0, 0])
    got = sl.light.irradiance(sl.light.PointLight((1, 2, 3)), [[np.nan, 2, 3], [1.0, 1, 3]], [0.0, 1, 0])
    assert np.isnan(got[0]).all() and np.array_equal(got[1], [1, 1, 1])
