"""Draws from lights: points on the light, densities that integrate to one, and validation."""

import numpy as np
import pytest
import shadelab as sl

LIGHT = sl.light.RectLight((0.5, 2, 0), (1, 0.5, 0), (0, 0, 2), (3, 2, 1))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_samples_lie_on_the_light_and_have_their_density(dtype):
    points = np.random.default_rng(1).uniform(-1, 1, (1000, 3)).astype(dtype)
    u = sl.sampling.sobol(1000, 2, dtype=dtype)
    wi, distance, pdf = sl.light.light_sample(LIGHT, points, u)
    assert wi.dtype == distance.dtype == pdf.dtype == dtype
    at = points + wi * distance[:, None] - np.array(LIGHT.center, dtype)
    edges = np.array([LIGHT.edge_u, LIGHT.edge_v])
    eps = np.finfo(dtype).eps
    assert np.allclose(at @ np.array(LIGHT.normal), 0, atol=20 * eps)
    assert np.allclose(at @ (edges / (edges**2).sum(-1, keepdims=True)).T, u - 0.5, atol=20 * eps)
    front = pdf > 0
    assert np.array_equal(front, (points - LIGHT.center) @ np.array(LIGHT.normal) > 0) and front.any()
    inside = front & (np.abs(u - 0.5).max(-1) < 0.499)
    cosine = np.abs(wi @ np.array(LIGHT.normal))
    again = sl.light.light_pdf(LIGHT, points, wi)
    assert (np.abs(again / pdf - 1)[inside] * cosine[inside] < 20 * eps).all()


def test_estimates_the_solid_angle_and_the_irradiance():
    u = sl.sampling.sobol(1 << 14, 2)
    point, normal = np.array([0.2, 0.1, -0.3]), np.array([0.0, 0.6, 0.8])
    wi, _, pdf = sl.light.light_sample(LIGHT, point, u)
    moments = sl.light.polygon_moments(LIGHT.corners, point, normal)
    # Scrambled points at n = 2^14: far below 1e-4 on smooth integrands, 1e-3 with the horizon's kink.
    assert (1 / pdf).mean() == pytest.approx(moments[0], rel=1e-3)
    assert (np.maximum(wi @ normal, 0) / pdf).mean() == pytest.approx(moments[1], rel=1e-3)


def test_only_the_shining_side_has_a_density():
    behind, front = [0.5, 4.0, 0.0], [0.5, 0.0, 0.0]
    toward = np.array([[0.0, -1, 0], [0.0, 1, 0]])
    assert np.array_equal(sl.light.light_pdf(LIGHT, [behind, front], toward) > 0, [False, True])
    both = sl.light.RectLight(LIGHT.center, LIGHT.edge_u, LIGHT.edge_v, two_sided=True)
    assert np.array_equal(sl.light.light_pdf(both, [behind, front], toward) > 0, [True, True])
    assert sl.light.light_pdf(LIGHT, front, [1.0, 0.0, 0.0]) == 0
    assert np.isnan(sl.light.light_pdf(LIGHT, [np.nan, 0, 0], [0.0, 1, 0]))


def test_bad_lights_are_refused_by_name():
    with pytest.raises(ValueError, match="edge_v: expected an edge perpendicular"):
        sl.light.RectLight((0, 0, 0), (1, 0, 0), (1, 1, 0))
    with pytest.raises(ValueError, match="edge_u: expected an edge of non-zero length"):
        sl.light.RectLight((0, 0, 0), (0, 0, 0), (1, 1, 0))
    with pytest.raises(ValueError, match="radiance: expected no negative channel"):
        sl.light.RectLight((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, -1, 0))
    with pytest.raises(ValueError, match="position: expected three numbers"):
        sl.light.PointLight((0, 0))
    with pytest.raises(ValueError, match="position: expected a finite number"):
        sl.light.PointLight((0, 0, np.nan))
    with pytest.raises(ValueError, match="direction: expected a vector of non-zero length"):
        sl.light.DirectionalLight((0, 0, 0))
    with pytest.raises(TypeError, match="light: expected a light with an area, got PointLight"):
        sl.light.light_pdf(sl.light.PointLight((0, 0, 0)), [0.0, 0, 0], [0.0, 1, 0])
    with pytest.raises(AttributeError):
        LIGHT.area = 3
