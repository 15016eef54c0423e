"""A lit plane is lit however the light stands to it and to the world's axes: square to it above all, where slopes grant
nothing."""

import numpy as np
import pytest
import shadelab as sl
from shadelab.light import DirectionalLight, SpotLight

S = sl.shadow


def square_to(d):
    """Unit d and two directions square to it, along none of the world's axes."""
    d = np.asarray(d, float) / np.linalg.norm(d)
    u = np.cross(d, [0, 1, 0.1])
    u /= np.linalg.norm(u)
    return d, u, np.cross(d, u)


def sheets(d, u, v, heights, center, dtype):
    """Squares of side 10 at so many units along d from a place."""
    corners = np.array([a * 5 * u + b * 5 * v for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    positions = np.concatenate([corners + h * d + center for h in heights]).astype(dtype)
    return positions, np.concatenate([np.array([[0, 2, 1], [0, 3, 2]]) + 4 * i for i in range(len(heights))])


def lit(m, kind, receivers, normals):
    if kind in ("hard", "pcf"):
        return getattr(S, kind)(m, receivers, normals)
    if kind == "pcss":
        return S.pcss(m, receivers, normals, light_size=0.1)
    return getattr(S, kind)(S.moment_map(m, kind, filter="none"), receivers, normals)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", ["hard", "pcf", "pcss", "variance", "moment"])
@pytest.mark.parametrize("offset", [0.0, 1e2, 1e4])
def test_a_plane_square_to_the_sun_is_lit(dtype, kind, offset):
    d, u, v = square_to((0.3, -1, 0.5))
    ab = np.random.default_rng(1).uniform(-4.9, 4.9, (20_000, 2))
    center = offset * np.array([1.0, 0.5, -0.7])
    receivers = (ab[:, :1] * u + ab[:, 1:] * v + center).astype(dtype)
    for tall in (1.0, 10.0, 100.0, 1000.0):
        m = S.shadow_map(*sheets(d, u, v, (0.0, tall), center, dtype), DirectionalLight(d), 256)
        # Bounds of moments are loose, but not by more than what rounding leaves of variances.
        dark = 1 - lit(m, kind, receivers, -d).mean()
        assert dark <= (1e-3 if kind in ("variance", "moment") else 0.0), (tall, dark)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("offset", [0.0, 1e2, 1e3])
def test_a_plane_square_to_a_spot_light_is_lit(dtype, offset):
    d, u, v = square_to((0.3, -1, 0.5))
    center = offset * np.array([1.0, 0.0, 1.0])
    ab = np.random.default_rng(2).uniform(-2, 2, (20_000, 2))
    receivers = (ab[:, :1] * u + ab[:, 1:] * v + center).astype(dtype)
    m = S.shadow_map(*sheets(d, u, v, (0.0,), center, dtype), SpotLight(center - d, d, outer_angle=1.2), 256)
    for kind in ("hard", "pcf", "pcss"):
        assert lit(m, kind, receivers, -d).min() == 1.0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_what_is_granted_is_rounding_alone(dtype):
    """A sheet nearer to the light by a thousand units in the last place of the coordinates casts its shadow."""
    d, u, v = square_to((0.3, -1, 0.5))
    gap = 1000 * float(np.finfo(dtype).eps) * 10.0
    positions, faces = sheets(d, u, v, (-gap, 0.0, 10.0), np.zeros(3), dtype)
    m = S.shadow_map(positions, faces, DirectionalLight(d), 256)
    ab = np.random.default_rng(3).uniform(-4, 4, (20_000, 2))
    assert S.hard(m, (ab[:, :1] * u + ab[:, 1:] * v).astype(dtype), -d).max() == 0.0
