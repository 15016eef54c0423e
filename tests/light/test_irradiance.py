"""Irradiance: inverse squares, cosines, and far rectangles that are points."""

from itertools import pairwise

import numpy as np
import pytest
import shadelab as sl
from scipy import integrate, optimize


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


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_spots_fall_off_smoothly_between_their_angles(dtype):
    spot = sl.light.SpotLight((0, 2, 0), (0, -3, 0), (8, 4, 2), inner_angle=0.2, outer_angle=0.6)
    angle = np.array([0.0, 0.19, 0.4, 0.59, 0.61, 3.0])
    points = np.stack([np.sin(angle), 2 - np.cos(angle), 0 * angle], -1).astype(dtype)
    toward = np.stack([-np.sin(angle), np.cos(angle), 0 * angle], -1).astype(dtype)
    got = sl.light.irradiance(spot, points, toward)
    t = np.clip((np.cos(angle) - np.cos(0.6)) / (np.cos(0.2) - np.cos(0.6)), 0, 1)
    share = t * t * (3 - 2 * t)
    assert np.allclose(got, share[:, None] * np.array([8, 4, 2]), atol=100 * np.finfo(dtype).eps)
    assert got[0, 0] == pytest.approx(8, rel=1e-6) and got[-2:].max() == 0


def _quadrature(light, point, normal):
    """By an adaptive rule over rings of the disk, or of the cone of a sphere, cut at the horizon so that every piece is
    smooth."""
    if isinstance(light, sl.light.SphereLight):
        to = np.subtract(light.center, point)
        distance = np.linalg.norm(to)
        axis = to / distance
        edge = np.arcsin(light.radius / distance)

        def value(a, phi, x, y):
            around = np.multiply.outer(np.cos(phi), x) + np.multiply.outer(np.sin(phi), y)
            return (np.cos(a) * axis + np.sin(a) * around) @ normal * np.sin(a)
    else:
        axis = np.array(light.normal) / np.linalg.norm(light.normal)
        edge = light.radius

        def value(a, phi, x, y):
            around = np.multiply.outer(np.cos(phi), x) + np.multiply.outer(np.sin(phi), y)
            to = light.center + a * around - point
            return (to @ normal) * np.maximum(-(to @ axis), 0) / (to * to).sum(-1) ** 2 * a

    x = np.cross(axis, [0.3, 0.8, 0.5])
    x /= np.linalg.norm(x)
    y = np.cross(axis, x)

    def ring(a):
        # Where the ring is above the horizon: a interval of phi about the normal's own azimuth.
        top = np.arctan2(np.dot(normal, y), np.dot(normal, x))
        if value(a, top, x, y) <= 0:
            return 0.0
        if value(a, top + np.pi, x, y) >= 0:
            half = np.pi
        else:
            half = optimize.brentq(lambda p: value(a, top + p, x, y), 0, np.pi, xtol=1e-15)
        sides = ((top - half, top), (top, top + half))
        return sum(integrate.fixed_quad(lambda p: value(a, p, x, y), *side, n=160)[0] for side in sides)

    def total(pieces):
        nodes = np.concatenate([[0], pieces, [edge]])
        return sum(integrate.quad(ring, a, b, epsabs=1e-12, epsrel=1e-12, limit=200)[0] for a, b in pairwise(nodes))

    # The radius at which the ring first touches the horizon is a kink.
    kinks = []
    probe = np.linspace(0, edge, 400)
    top = np.arctan2(np.dot(normal, y), np.dot(normal, x))
    for turn in (0, np.pi):
        s = [value(a, top + turn, x, y) if a else np.nan for a in probe]
        for i in range(1, len(s) - 1):
            if s[i] * s[i + 1] < 0:
                kinks.append(optimize.brentq(lambda a, t=turn: value(a, top + t, x, y), probe[i], probe[i + 1]))
    return total(sorted(kinks))


@pytest.mark.parametrize(
    ("light", "point"),
    [
        (sl.light.DiskLight((0, 1, 0), (0, -1, 0), 0.7), (0.3, 0, 0.1)),
        (sl.light.DiskLight((0, 1, 0), (0, -1, 0), 0.7), (0, 0, 0)),
        (sl.light.DiskLight((0, 1, 0), (0.3, -1, 0.5), 0.7), (2.0, -1.0, 1.0)),
        (sl.light.DiskLight((0, 0.2, 0), (0, -1, 0), 1.5), (1.2, 0, 0)),
        (sl.light.SphereLight((0, 1, 0), 0.7), (0.3, 0, 0.1)),
        (sl.light.SphereLight((0, 1, 0), 0.99), (0, 0, 0)),
        (sl.light.SphereLight((0, 1, 0), 0.05), (2, 0, 1)),
    ],
)
def test_disks_and_spheres_against_quadrature(light, point):
    """At every orientation: wholly above the horizon, cut by it, and below."""
    point, worst = np.array(point, float), 0.0
    toward = np.subtract(light.center, point)
    toward /= np.linalg.norm(toward)
    aside = np.cross(toward, [0.1, 0.2, 0.9])
    aside /= np.linalg.norm(aside)
    for angle in (0.0, 0.5, 1.2, 1.5, 1.7, 2.0, 2.4):
        normal = np.cos(angle) * toward + np.sin(angle) * aside
        got = float(sl.light.irradiance(light, point, normal)[0])
        worst = max(worst, abs(got - _quadrature(light, point, normal)))
    assert worst < 1e-9


def test_disks_shine_from_their_front_and_spheres_outwards():
    disk = sl.light.DiskLight((0, 1, 0), (0, -1, 0), 0.5)
    both = sl.light.DiskLight((0, 1, 0), (0, -1, 0), 0.5, two_sided=True)
    above, below = ([0.1, 2.0, 0.2], [0.0, -1.0, 0.0]), ([0.1, 0.0, 0.2], [0.0, 1.0, 0.0])
    assert sl.light.irradiance(disk, *above).max() == 0 < sl.light.irradiance(both, *above).min()
    assert np.allclose(sl.light.irradiance(both, *above), sl.light.irradiance(disk, *below))
    sphere = sl.light.SphereLight((0, 1, 0), 0.5)
    assert sl.light.irradiance(sphere, [0.1, 1.0, 0.2], [0.0, 1.0, 0.0]).max() == 0
    assert np.allclose(sl.light.irradiance(sl.light.AmbientLight((1, 2, 3)), *below), np.pi * np.array([1, 2, 3]))


def test_sizes_and_brightness_that_no_square_holds_are_refused():
    with pytest.raises(ValueError, match=r"edge_u: expected an edge of 1e-15 to 1e\+15 in length, got 1e-200"):
        sl.light.RectLight((0, 0, 0), (1e-200, 0, 0), (0, 0, 1e-200))
    with pytest.raises(ValueError, match="edge_v"):
        sl.light.RectLight((0, 0, 0), (1, 0, 0), (0, 0, 1e200))
    with pytest.raises(ValueError, match="radius"):
        sl.light.DiskLight((0, 0, 0), (0, 1, 0), 1e-200)
    with pytest.raises(ValueError, match="radius"):
        sl.light.SphereLight((0, 0, 0), 1e200)
    with pytest.raises(ValueError, match="intensity: expected channels of at most"):
        sl.light.PointLight((0, 0, 0), (1e300, 0, 0))
    # Small enough for both precisions, and held by them.
    for edge in (1e-15, 1e15):
        light = sl.light.RectLight((0, edge, 0), (edge, 0, 0), (0, 0, edge))
        for dtype in (np.float32, np.float64):
            got = sl.light.irradiance(light, np.zeros(3, dtype), np.array([0, 1, 0], dtype))
            # Four squares with a corner above the point, half as wide as far: 2 A atan A each, A = 1/√5.
            assert got == pytest.approx(4 / 5**0.5 * np.arctan(1 / 5**0.5), rel=1e-5)
