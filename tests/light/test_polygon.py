"""Moments of polygons: adaptive quadrature, closed forms, and the horizon."""

import numpy as np
import pytest
import shadelab as sl
from scipy import integrate

SQUARE = np.array([[-1.0, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]])


def quadrature(center, edge_u, edge_v, point, normal, order):
    """∫ cosⁿθ dω over the part above the horizon, the inner integral split where it is cut."""
    light_normal = np.cross(edge_u, edge_v)
    area = np.linalg.norm(light_normal)
    light_normal = light_normal / area

    def integrand(t, s):
        to = center + s * edge_u + t * edge_v - point
        d = np.sqrt(to @ to)
        return max(to @ normal / d, 0) ** order * -(to @ light_normal) / d**3 * area

    def inner(s):
        start, slope = (center + s * edge_u - point) @ normal, edge_v @ normal
        cut = -start / slope if slope else 1.0
        low, high = (-0.5, 0.5) if start - 0.5 * slope > 0 or start + 0.5 * slope > 0 else (0.5, 0.5)
        if -0.5 < cut < 0.5:
            low, high = (cut, 0.5) if slope > 0 else (-0.5, cut)
        return integrate.quad(integrand, low, high, (s,), epsabs=1e-12, epsrel=1e-11)[0]

    # Where the horizon leaves through a side parallel to edge_u, the outer integrand has kinks.
    breaks = []
    for t in (-0.5, 0.5):
        slope = edge_u @ normal
        if slope:
            s = -((center + t * edge_v - point) @ normal) / slope
            breaks += [s] if -0.5 < s < 0.5 else []
    return integrate.quad(inner, -0.5, 0.5, points=breaks or None, epsabs=1e-11, epsrel=1e-10, limit=200)[0]


def test_moments_agree_with_quadrature_across_the_horizon():
    rng = np.random.default_rng(5)
    crossing = 0
    for _ in range(12):
        center, edge_u = rng.normal(0, 1, 3) + np.array([0, 1.2, 0]), rng.normal(size=3)
        edge_v = np.cross(edge_u, rng.normal(size=3))
        normal = rng.normal(size=3) + np.array([0, 0.3, 0])
        normal /= np.linalg.norm(normal)
        point = np.zeros(3)
        if (point - center) @ np.cross(edge_u, edge_v) < 0:
            edge_u, edge_v = edge_v, edge_u
        corners = sl.light.RectLight(center, edge_u, edge_v).corners
        heights = (corners - point) @ normal
        crossing += heights.min() < 0 < heights.max()
        got = sl.light.polygon_moments(corners, point, normal)
        for order in (0, 1, 6):
            # Order 0 has a jump at the horizon that quadrature resolves by its split.
            expected = quadrature(center, edge_u, edge_v, point, normal, order)
            assert got[order] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert crossing >= 3


def test_moments_of_every_order_agree_with_even_points():
    # A grid over the polygon in the plane y = 1, seen under a slanted normal.
    normal = np.array([0.6, 0.8, 0.0])
    n = 2000
    x, z = np.meshgrid((np.arange(n) + 0.5) / n * 2 - 1, (np.arange(n) + 0.5) / n * 2 - 1)
    d2 = x * x + 1 + z * z
    cosine = np.maximum((0.6 * x + 0.8) / np.sqrt(d2), 0)
    weight = 4 / n**2 / d2**1.5
    got = sl.light.polygon_moments(SQUARE, [0, 0, 0], normal)
    # The midpoint rule's error at this step.
    assert np.allclose(got, [(cosine**k * weight).sum() for k in range(7)], rtol=1e-6)


def test_a_polygon_far_over_the_horizon_fills_the_hemisphere():
    huge = SQUARE * [1e9, 1, 1e9]
    # ∫ cosⁿ dω over a hemisphere is 2π/(n + 1).
    assert np.allclose(sl.light.polygon_moments(huge, [0, 0, 0], [0, 1, 0]), 2 * np.pi / np.arange(1, 8), rtol=1e-8)


def test_parts_add_up_and_the_back_is_negative():
    rng = np.random.default_rng(2)
    points, normals = rng.uniform(-2, 0.9, (200, 3)), rng.normal(size=(200, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    whole = sl.light.polygon_moments(SQUARE, points, normals)
    left, right = SQUARE.copy(), SQUARE.copy()
    left[[1, 2], 0] = 0.3
    right[[0, 3], 0] = 0.3
    parts = sl.light.polygon_moments(left, points, normals) + sl.light.polygon_moments(right, points, normals)
    assert np.allclose(whole, parts, atol=1e-13)
    assert np.allclose(sl.light.polygon_moments(SQUARE[::-1], points, normals), -whole, atol=1e-13)
    # An L, not convex, is the square less a corner.
    corner = np.array([[0.0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1]])
    ell = np.array([[-1.0, 1, -1], [1, 1, -1], [1, 1, 0], [0, 1, 0], [0, 1, 1], [-1, 1, 1]])
    rest = whole - sl.light.polygon_moments(corner, points, normals)
    assert np.allclose(sl.light.polygon_moments(ell, points, normals), rest, atol=1e-13)


def test_single_precision_is_double_rounded():
    points = np.random.default_rng(3).uniform(-1, 0.5, (100, 3)).astype(np.float32)
    up = np.array([0, 1, 0], np.float32)
    single = sl.light.polygon_irradiance(SQUARE, points, up)
    assert single.dtype == np.float32
    assert np.array_equal(single, sl.light.polygon_irradiance(SQUARE, points.astype(float), up).astype(np.float32))


def test_nan_stays_in_its_row():
    got = sl.light.polygon_irradiance(SQUARE, [[np.nan, 0, 0], [0, 0, 0]], [0, 1, 0])
    assert np.isnan(got[0]) and got[1] > 1
    with pytest.raises(ValueError, match="corners: expected shape"):
        sl.light.polygon_irradiance(SQUARE[:2], [0, 0, 0], [0, 1, 0])


@pytest.mark.parametrize(
    "flat",
    [
        [(0, 0), (1, 1), (2, 0), (2, 2), (1, 1), (0, 2)],
        [(0, 0), (2, 0), (2, 2), (1, 2), (1, 3), (1, 2), (0, 2)],
        [(0, 0), (2, 2), (2, 0), (1, 1), (0, 3)],
        [(0, 0), (1, 0), (2, 0), (1, 0), (1, 1), (0, 1)],
    ],
)
def test_what_is_drawn_of_a_polygon_is_what_it_is_or_it_is_refused(flat):
    """Corners that touch edges: the triangles that are drawn from cover the polygon once, or there are none."""
    try:
        light = sl.light.PolygonLight([[x, 2.0, z] for x, z in flat], (1, 1, 1), two_sided=True)
        point, up = np.array([0.7, 0, 0.4]), np.array([0.0, 1, 0])
        exact = sl.light.irradiance(light, point, up)
    except ValueError as error:
        assert "corners" in str(error)
        return
    u = sl.sampling.sobol(4096, 2, scramble="owen", seed=3)
    drawn = sl.light.light_sample(light, np.broadcast_to(point, (4096, 3)), u)
    shines = drawn.pdf > 0
    found = (drawn.wi @ up)[shines] @ (1 / drawn.pdf[shines]) / len(u)
    assert np.abs(found / exact - 1).max() < 0.01
