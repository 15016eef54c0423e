"""Draws from lights: points on the light, densities that integrate to one, and validation."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

RECT = sl.light.RectLight((0.5, 2, 0), (1, 0.5, 0), (0, 0, 2), (3, 2, 1))
DISK = sl.light.DiskLight((0.5, 2, 0.3), (0.2, -1, 0.1), 0.8)
SPHERE = sl.light.SphereLight((0.5, 2, 0.3), 0.8)
# A notch: not convex.
NOTCH = sl.light.PolygonLight([[0, 2, 0], [2, 2, 0], [2, 2, 2], [1, 2, 0.5], [0, 2, 2]])
AREAS = [RECT, DISK, SPHERE, NOTCH, sl.light.AmbientLight()]
FLOATS = [np.float32, np.float64]
IDS = [type(light).__name__ for light in AREAS]


@pytest.mark.parametrize("dtype", FLOATS)
def test_samples_lie_on_the_rectangle_and_have_their_density(dtype):
    points = np.random.default_rng(1).uniform(-1, 1, (1000, 3)).astype(dtype)
    u = sl.sampling.sobol(1000, 2, dtype=dtype)
    wi, distance, pdf = sl.light.light_sample(RECT, points, u)
    assert wi.dtype == distance.dtype == pdf.dtype == dtype
    front = pdf > 0
    assert np.array_equal(front, (points - RECT.center) @ np.array(RECT.normal) > 0) and front.any()
    assert not wi[~front].any() and not distance[~front].any()
    at = (points + wi * distance[:, None] - np.array(RECT.center, dtype))[front]
    edges = np.array([RECT.edge_u, RECT.edge_v])
    eps = np.finfo(dtype).eps
    assert np.allclose(at @ np.array(RECT.normal), 0, atol=20 * eps)
    assert np.allclose(at @ (edges / (edges**2).sum(-1, keepdims=True)).T, u[front] - 0.5, atol=20 * eps)


@pytest.mark.parametrize("dtype", FLOATS)
@pytest.mark.parametrize("method", ["area", "solid_angle"])
@pytest.mark.parametrize("light", AREAS, ids=IDS)
def test_draws_have_the_density_that_is_asked_for(light, method, dtype):
    points = np.random.default_rng(1).uniform(-1, 1, (2000, 3)).astype(dtype)
    u = (0.001 + 0.998 * sl.sampling.sobol(2000, 2)).astype(dtype)
    wi, _, pdf = sl.light.light_sample(light, points, u, method=method)
    seen = pdf > 0
    assert seen.any() and np.array_equal(seen, np.linalg.norm(wi, axis=-1) > 0.5)
    again = sl.light.light_pdf(light, points, wi, method=method)[seen]
    eps = np.finfo(dtype).eps
    found = again > 0
    assert found.mean() > 0.999  # the rim of a cone is hit or missed by rounding
    error = np.abs(again / pdf[seen] - 1)[found]
    if hasattr(light, "normal"):
        # Flat lights lose what the cosine at the light does, in density and distance.
        axis = np.array(light.normal) / np.linalg.norm(light.normal)
        error = error * (wi[seen] @ axis)[found] ** 2
    assert error.max() < 40 * eps


@pytest.mark.parametrize("light", [DISK, SPHERE, NOTCH], ids=["disk", "sphere", "polygon"])
def test_samples_lie_on_the_light(light):
    point = np.array([0.1, -0.2, 0.3])
    wi, distance, pdf = sl.light.light_sample(light, point, sl.sampling.sobol(1 << 12, 2))
    assert (pdf > 0).all()
    at = point + wi * distance[:, None]
    if light is SPHERE:
        assert np.allclose(np.linalg.norm(at - light.center, axis=-1), light.radius, atol=1e-12)
    elif light is DISK:
        off = at - light.center
        axis = np.array(light.normal) / np.linalg.norm(light.normal)
        assert np.abs(off @ axis).max() < 1e-12 and np.linalg.norm(off, axis=-1).max() < light.radius + 1e-12
    else:
        assert np.allclose(at[:, 1], 2)
        in_notch = (at[:, 2] > 0.5 + 1.5 * np.abs(at[:, 0] - 1) + 1e-9).sum()
        assert in_notch == 0


@pytest.mark.parametrize("light", [RECT, DISK, SPHERE, NOTCH], ids=IDS[:-1])
def test_draws_follow_the_density(light):
    """Counts of draws in cells of direction against the density, integrated over them on a fine grid."""
    point, n = np.array([0.1, -0.2, 0.3]), 1 << 15
    wi, _, _ = sl.light.light_sample(light, point, np.random.default_rng(7).random((n, 2)))
    # Directions by their gnomonic picture about +y.
    flat = wi[:, [0, 2]] / wi[:, 1:2]
    assert (wi[:, 1] > 0).all()
    low, high = flat.min(0) - 1e-9, flat.max(0) + 1e-9
    cells, fine = 10, 100
    axes = [np.linspace(a, b, cells * fine + 1) for a, b in zip(low, high, strict=True)]
    middles = [(a[1:] + a[:-1]) / 2 for a in axes]
    x, z = np.meshgrid(*middles, indexing="ij")
    direction = np.stack([x, np.ones_like(x), z], -1)
    length = np.linalg.norm(direction, axis=-1)
    weight = np.prod((high - low) / (cells * fine)) / length**3
    density = sl.light.light_pdf(light, point, direction / length[..., None]) * weight
    assert density.sum() == pytest.approx(1, abs=3e-3)
    expected = density.reshape(cells, fine, cells, fine).sum((1, 3)) * n
    found = np.histogram2d(flat[:, 0], flat[:, 1], [a[::fine] for a in axes])[0]
    many = expected > 20
    pooled = np.append(found[many], found[~many].sum()), np.append(expected[many], expected[~many].sum())
    keep = pooled[1] > 0
    # Four tests at 0.1 % together, with a fixed seed; borders of cells cost the grid a part in a thousand.
    result = stats.chisquare(pooled[0][keep], pooled[1][keep] * n / pooled[1].sum())
    assert result.pvalue > 0.001 / 4


@pytest.mark.parametrize("method", ["area", "solid_angle"])
@pytest.mark.parametrize("light", AREAS, ids=IDS)
def test_estimates_the_irradiance(light, method):
    u = sl.sampling.sobol(1 << 15, 2)
    point, normal = np.array([0.2, 0.1, -0.3]), np.array([0.0, 0.6, 0.8])
    wi, _, pdf = sl.light.light_sample(light, point, u, method=method)
    cosine = np.divide(np.maximum(wi @ normal, 0), pdf, out=np.zeros(len(u)), where=pdf > 0)
    exact = sl.light.irradiance(light, point, normal)
    # Scrambled points at n = 2^15: far below 1e-4 on smooth integrands, 1e-3 with the horizon's kink.
    assert np.allclose(cosine.mean() * np.array(light.radiance), exact, rtol=1e-3)


def test_only_the_shining_side_has_a_density():
    behind, front = [0.5, 4.0, 0.0], [0.5, 0.0, 0.0]
    toward = np.array([[0.0, -1, 0], [0.0, 1, 0]])
    assert np.array_equal(sl.light.light_pdf(RECT, [behind, front], toward) > 0, [False, True])
    both = sl.light.RectLight(RECT.center, RECT.edge_u, RECT.edge_v, two_sided=True)
    assert np.array_equal(sl.light.light_pdf(both, [behind, front], toward) > 0, [True, True])
    assert sl.light.light_pdf(RECT, front, [1.0, 0.0, 0.0]) == 0
    assert np.isnan(sl.light.light_pdf(RECT, [np.nan, 0, 0], [0.0, 1, 0]))
    assert sl.light.light_pdf(SPHERE, SPHERE.center, [0.0, 1, 0]) == 0


def test_bad_lights_are_refused_by_name():
    light = sl.light
    with pytest.raises(ValueError, match="edge_v: expected an edge perpendicular"):
        light.RectLight((0, 0, 0), (1, 0, 0), (1, 1, 0))
    with pytest.raises(ValueError, match="edge_u: expected an edge of 1e-15"):
        light.RectLight((0, 0, 0), (0, 0, 0), (1, 1, 0))
    with pytest.raises(ValueError, match="radiance: expected no negative channel"):
        light.RectLight((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, -1, 0))
    with pytest.raises(ValueError, match="position: expected three numbers"):
        light.PointLight((0, 0))
    with pytest.raises(ValueError, match="position: expected a finite number"):
        light.PointLight((0, 0, np.nan))
    with pytest.raises(ValueError, match="direction: expected a vector of non-zero length"):
        light.DirectionalLight((0, 0, 0))
    with pytest.raises(ValueError, match="inner_angle: expected a number in"):
        light.SpotLight((0, 0, 0), (0, 1, 0), inner_angle=1.0, outer_angle=0.5)
    with pytest.raises(ValueError, match="radius: expected a number in"):
        light.SphereLight((0, 0, 0), 0.0)
    with pytest.raises(ValueError, match="normal: expected a vector of non-zero length"):
        light.DiskLight((0, 0, 0), (0, 0, 0), 1.0)
    with pytest.raises(ValueError, match=r"corners: expected shape \(n, 3\)"):
        light.PolygonLight([[0, 0, 0], [1, 0, 0]])
    with pytest.raises(ValueError, match="corners: expected a polygon with an area"):
        light.PolygonLight([[0, 0, 0], [1, 0, 0], [2, 0, 0]])
    with pytest.raises(ValueError, match="corners: expected a planar polygon, got one that is 0"):
        light.PolygonLight([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]])
    with pytest.raises(ValueError, match="corners: expected a polygon that does not cross itself"):
        light.PolygonLight([[0, 0, 0], [2, 2, 0], [2, 0, 0], [0, 3, 0]])
    with pytest.raises(TypeError, match="light: expected a light with an area, got PointLight"):
        light.light_pdf(light.PointLight((0, 0, 0)), [0.0, 0, 0], [0.0, 1, 0])
    with pytest.raises(AttributeError):
        RECT.area = 3


@pytest.mark.parametrize("light", [RECT, NOTCH], ids=["rectangle", "polygon"])
def test_over_the_solid_angle_every_direction_has_one_density(light):
    point = [0.1, 1.7, 0.3]
    wi, _, pdf = sl.light.light_sample(light, point, sl.sampling.sobol(1 << 10, 2), method="solid_angle")
    whole = sl.light.polygon_moments(light.corners, point, [0.0, 1, 0])[0]
    assert np.allclose(pdf, 1 / whole, rtol=1e-12)
    assert (sl.light.light_pdf(light, point, wi, method="solid_angle") > 0).all()


@pytest.mark.parametrize(
    "light",
    [
        sl.light.RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1)),
        sl.light.DiskLight((0, 2, 0), (0, -1, 0), 1.0),
        sl.light.SphereLight((0, 2, 0), 1.0),
        sl.light.PolygonLight([[0, 2, 0], [1, 2, 0], [0, 2, 1]]),
        sl.light.AmbientLight(),
    ],
)
def test_numbers_beyond_the_square_give_nan(light):
    u = [[1.5, 0.5], [0.5, 2.0], [-0.1, 0.5], [0.5, np.nan], [1.0, 1.0], [0.25, 0.75]]
    drawn = sl.light.light_sample(light, [0.0, 0.0, 0.0], u)
    for part in drawn:
        assert np.isnan(part[:4]).all() and not np.isnan(part[4:]).any()
