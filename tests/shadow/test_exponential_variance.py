"""Exponential variance shadow maps: still a bound, still exact for two depths, darker where two blockers overlap."""

import numpy as np
import pytest
import shadelab as sl
from shadelab._kernels import shadow as kernels

SHADOW = sl.shadow
DOWN = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]


def bound(moments, t, a, b):
    """The kernel's bound on its own."""
    n = len(t)
    out = np.empty(n)
    kernels.exponential_variance([moments, t, np.full(n, a), np.full(n, b), np.zeros(n)], [out])
    return out


@pytest.mark.parametrize(("a", "b"), [(5.0, 0.0), (40.0, 0.0), (40.0, 5.0)])
def test_no_distribution_exceeds_the_bound(a, b):
    rng = np.random.default_rng(1)
    n = 5000
    z, w = rng.uniform(-1, 1, (n, 6)), rng.dirichlet(np.ones(6), n)
    t = rng.uniform(-1, 1, n)
    e, f = np.exp(a * z), -np.exp(-b * z)
    moments = np.stack([(w * e).sum(1), (w * e**2).sum(1), (w * f).sum(1), (w * f**2).sum(1)], -1)
    share = (w * (z >= t[:, None])).sum(1)
    assert (bound(moments, t, a, b) >= share - 1e-9).all()


def two_depths(blockers, ground=4.0, n=64):
    depth = np.asarray(blockers)[np.arange(n) * len(blockers) // n][None].repeat(n, 0)
    return SHADOW.ShadowMap(depth, "perspective", [0, 4, 0], DOWN, [-1, 1, -1, 1], min(blockers), max(blockers))


def lookup(blockers, kind, point=(0.0, 0, 0), **kwargs):
    m = two_depths(blockers)
    filtered = SHADOW.moment_map(m, kind, filter="summed_area", receivers=[point], **kwargs)
    f = SHADOW.variance if kind == "variance" else SHADOW.exponential_variance
    return f(filtered, [point], radius=16.0)[0]


@pytest.mark.parametrize("exponents", [20.0, 40.0, (40.0, 5.0)])
def test_two_depths_are_exact(exponents):
    assert lookup([2.0, 4.0], "exponential_variance", exponents=exponents) == pytest.approx(0.5, abs=1e-4)


def test_less_light_bleeds_the_larger_the_exponent():
    plain = lookup([2.0, 3.0], "variance")
    bled = [lookup([2.0, 3.0], "exponential_variance", exponents=e) for e in (1.0, 3.0, 5.0)]
    assert 0.09 < plain < 0.11
    assert plain > bled[0] > bled[1] > bled[2]
    assert bled[2] < 1e-3
    # In the end the least variance is what bleeds: (a σ)².
    most = lookup([2.0, 3.0], "exponential_variance", exponents=40.0)
    assert most == pytest.approx(40**2 * 1e-6, rel=0.1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", ["rect", "sun"])
@pytest.mark.parametrize("tilt", [0.0, 0.7, 1.3])
def test_a_lit_plane_is_lit(scenes, kind, tilt, dtype):
    c, s = np.cos(tilt), np.sin(tilt)
    corners = (
        np.array([[-3.0, 0, -3], [3, 0, -3], [3, 0, 3], [-3, 0, 3]]) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T
    )
    normal = np.array([-s, c, 0.0])
    m = SHADOW.shadow_map(corners.astype(dtype), [[0, 2, 1], [0, 3, 2]], scenes.lights()[kind], 512)
    w = np.random.default_rng(2).uniform(0.05, 0.95, (20_000, 2))
    points = corners[0] + w[:, :1] * (corners[1] - corners[0]) + w[:, 1:] * (corners[3] - corners[0])
    filtered = SHADOW.moment_map(m, "exponential_variance", sigma=2.0, receivers=points)
    assert SHADOW.exponential_variance(filtered, points, normal).min() > 0.99


def test_a_narrow_filter_is_a_hard_shadow_and_errors_name_the_argument(scenes):
    m = scenes.analytic_map(sl, np.float64, 256)
    points = scenes.plane_receivers(256)
    filtered = SHADOW.moment_map(m, "exponential_variance", filter="none")
    assert np.abs(SHADOW.exponential_variance(filtered, points) - SHADOW.hard(m, points, [0, 1, 0])).max() < 1e-4
    with pytest.raises(ValueError, match="moment_map"):
        SHADOW.exponential_variance(SHADOW.moment_map(m), points)
    with pytest.raises(ValueError, match="radius"):
        SHADOW.exponential_variance(filtered, points, radius=1.0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("precision", ["double", "compensated"])
def test_a_lit_slope_before_empty_texels_is_lit_from_a_table_too(dtype, precision):
    ground = sl.mesh.plane((10.0, 10.0))
    k = len(ground.positions)
    positions = np.concatenate([ground.positions, [[4, 3, 4], [5, 3, 4], [5, 3, 5]]]).astype(dtype)
    m = SHADOW.shadow_map(
        positions,
        np.concatenate([ground.faces, [[k, k + 2, k + 1]]]),
        sl.light.DirectionalLight((0.2, -1, 0.1)),
        256,
    )
    points = np.random.default_rng(0).uniform(-4, 3, (20_000, 3))
    points[:, 1] = 0
    table = SHADOW.moment_map(m, "exponential_variance", filter="summed_area", precision=precision)
    lit = SHADOW.exponential_variance(table, points, [0, 1, 0])
    # Sums of 24 bits keep little of a box of few texels; those of 53 all that matters.
    assert (lit < (0.9 if precision == "double" else 0.5)).mean() < 1e-3
