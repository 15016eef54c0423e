"""Every kind of light casts shadows: by rays all of them, by maps those that a map can look from."""

import numpy as np
import pytest
import shadelab as sl
from shadelab.light import (
    AmbientLight,
    DiskLight,
    PointLight,
    PolygonLight,
    RectLight,
    SphereLight,
    SpotLight,
)

# A roof of half the plane y = 1, x < 0.
ROOF = np.array([[-60.0, 1, -60], [0, 1, -60], [0, 1, 60], [-60, 1, 60]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])
AREAS = {
    "disk": DiskLight((0, 2, 0), (0, -1, 0), 0.5),
    "sphere": SphereLight((0, 2, 0), 0.3),
    "polygon": PolygonLight([[-0.5, 2, -0.5], [0.5, 2, -0.5], [0.5, 2, 0.5], [-0.5, 2, 0.5]]),
}


@pytest.mark.parametrize("light", AREAS.values(), ids=AREAS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_half_of_a_light_over_an_edge_is_seen(light, dtype):
    bvh = sl.accel.BVH(ROOF.astype(dtype), FACES)
    # Mirrored about the edge's shadow, what is lit here is dark there.
    x = np.array([-3, -0.3, -0.1, 0, 0.1, 0.3, 3], dtype)
    points = np.stack([x, 0 * x, 0 * x], -1)
    lit = sl.shadow.ray_traced(bvh, points, None, light, samples=1024)
    assert lit.dtype == dtype and lit[0] == 0 and lit[-1] == 1
    assert np.allclose(lit + lit[::-1], 1, atol=0.015) and (np.diff(lit) >= -1e-3).all()
    # With normals points count by what they send: the share of irradiance, in closed form of the part in sight.
    up = np.broadcast_to(np.array([0, 1, 0], dtype), points.shape)
    weighed = sl.shadow.ray_traced(bvh, points, up, light, samples=1024)
    assert abs(weighed[3] - 0.5) < 0.01 and weighed[0] == 0 and weighed[-1] == 1


def test_a_square_polygon_is_the_rectangle():
    bvh = sl.accel.BVH(ROOF, FACES)
    rect = RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1))
    points = np.stack([np.linspace(-1, 1, 21), np.zeros(21), np.zeros(21)], -1)
    up = np.broadcast_to([0.0, 1, 0], points.shape)
    a, b = (sl.shadow.ray_traced(bvh, points, up, x, samples=1024) for x in (rect, AREAS["polygon"]))
    assert np.abs(a - b).max() < 6e-3


def test_ambient_light_is_what_of_the_sky_is_open():
    bvh = sl.accel.BVH(ROOF, FACES)
    up = np.array([0.0, 1, 0])
    # Under the middle of the edge half of the cosine-weighed hemisphere is roof.
    lit = sl.shadow.ray_traced(bvh, np.zeros(3), up, AmbientLight(), samples=4096)
    assert abs(float(lit) - 0.5) < 0.01


def test_a_spot_light_casts_the_shadow_of_a_point():
    bvh = sl.accel.BVH(ROOF, FACES)
    spot, point = SpotLight((0, 3, 0), (0, -1, 0), outer_angle=0.8), PointLight((0, 3, 0))
    rng = np.random.default_rng(0)
    points = np.stack([rng.uniform(-1, 1, 500), np.zeros(500), rng.uniform(-1, 1, 500)], -1)
    a, b = (sl.shadow.ray_traced(bvh, points, None, x) for x in (spot, point))
    assert np.array_equal(a, b) and 0.3 < a.mean() < 0.7
    # Its map looks along its axis, no wider than its cone.
    chart = sl.shadow.shadow_map(ROOF, FACES, spot, 512)
    assert np.allclose(chart.frame[2], [0, -1, 0]) and np.abs(chart.window).max() < np.tan(0.8) * 1.02
    far = np.abs(points[:, 0]) > 0.02
    assert np.array_equal(sl.shadow.hard(chart, points[far]), a[far])


@pytest.mark.parametrize("light", AREAS.values(), ids=AREAS)
def test_soft_maps_follow_the_rays(light):
    bvh = sl.accel.BVH(ROOF, FACES)
    points = np.stack([np.linspace(-1, 1, 41), np.zeros(41), np.zeros(41)], -1)
    up = np.broadcast_to([0.0, 1, 0], points.shape)
    exact = sl.shadow.ray_traced(bvh, points, up, light, samples=1024)
    chart = sl.shadow.shadow_map(ROOF, FACES, light, 1024, receivers=points)
    soft = sl.shadow.pcss(chart, points, up, blocker_samples=64, filter_samples=64)
    # Round lights are squares of the same area to the filter.
    assert np.abs(soft - exact).mean() < 0.04
