"""Variance shadow maps: a bound that holds, exact for two depths, equal to filtered comparisons, and where it leaks."""

import numpy as np
import pytest
import scipy.ndimage
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

SHADOW = sl.shadow
UP = [0, 1, 0]
distributions = st.lists(st.tuples(st.floats(-1, 1), st.floats(0.01, 1)), min_size=1, max_size=8)


@given(distributions, st.floats(-1.2, 1.2))
@settings(max_examples=200, deadline=None)
def test_no_distribution_exceeds_the_bound(pairs, t):
    z, w = np.array(pairs).T
    w /= w.sum()
    bound = SHADOW.chebyshev_bound((w * z).sum(), (w * z**2).sum(), t)
    # The variance is a difference of numbers up to 1; where t is that near to the mean, nothing is left of it.
    if abs(t - (w * z).sum()) > 1e-7:
        assert bound >= w[z >= t].sum() - 1e-7


@given(st.floats(-1, 0.9), st.floats(0.01, 0.99))
@settings(max_examples=100, deadline=None)
def test_two_depths_meet_the_bound(z, share):
    mean, square = share * z + (1 - share), share * z * z + (1 - share)
    assert SHADOW.chebyshev_bound(mean, square, 1.0) == pytest.approx(1 - share, abs=1e-9)


def test_equals_filtered_comparisons_between_two_parallel_planes(scenes):
    """One flat blocker, one flat receiver: brute force with the same weights, everywhere."""
    m = scenes.analytic_map(sl, np.float64, 256)
    points = scenes.plane_receivers(256)
    filtered = SHADOW.moment_map(m, "variance", sigma=3.0)
    compared = scipy.ndimage.gaussian_filter((m.depth >= 4).astype(float), 3.0, mode="nearest", truncate=3.0)
    lit = SHADOW.variance(filtered, points, min_variance=0.0)
    np.testing.assert_allclose(lit, compared, atol=1e-12)
    # By a table, over any box; here 11 texels.
    table = SHADOW.moment_map(m, "variance", filter="summed_area")
    boxed = scipy.ndimage.uniform_filter((m.depth >= 4).astype(float), 11)[8:-8, 8:-8]
    lit = SHADOW.variance(table, points[8:-8, 8:-8], radius=5.5, min_variance=0.0)
    np.testing.assert_allclose(lit, boxed, atol=1e-8)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_never_darker_than_filtered_comparisons(scenes, dtype):
    rng = np.random.default_rng(1)
    depth = rng.choice([2.0, 2.5, 3.2, 4.0], (128, 128)).astype(dtype)
    down = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    m = SHADOW.ShadowMap(depth, "perspective", [0, 4, 0], down, [-1, 1, -1, 1], 2.0, 4.0)
    points = scenes.plane_receivers(128, dtype)
    lit = SHADOW.variance(SHADOW.moment_map(m, "variance", filter="summed_area"), points, radius=3.5)
    compared = scipy.ndimage.uniform_filter((depth >= 4).astype(float), 7)
    inner = np.s_[4:-4, 4:-4]
    assert (lit[inner] >= compared[inner] - 1e-5).all()
    assert (lit[inner] > compared[inner] + 0.05).mean() > 0.5


@pytest.mark.parametrize("kind", ["rect", "point", "sun"])
@pytest.mark.parametrize("tilt", [0.0, 0.7, 1.3])
def test_a_lit_plane_is_lit(scenes, kind, tilt):
    c, s = np.cos(tilt), np.sin(tilt)
    corners = (
        np.array([[-3.0, 0, -3], [3, 0, -3], [3, 0, 3], [-3, 0, 3]]) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T
    )
    m = SHADOW.shadow_map(corners.astype(np.float32), [[0, 2, 1], [0, 3, 2]], scenes.lights()[kind], 512)
    w = np.random.default_rng(2).uniform(0.05, 0.95, (20_000, 2))
    points = corners[0] + w[:, :1] * (corners[1] - corners[0]) + w[:, 1:] * (corners[3] - corners[0])
    filtered = SHADOW.moment_map(m, "variance", sigma=2.0, receivers=points)
    # The plane's own curvature in perspective is all that is left to darken it.
    assert SHADOW.variance(filtered, points).min() > 0.98


def test_a_narrow_filter_is_a_hard_shadow(scenes):
    m = scenes.analytic_map(sl, np.float64, 256)
    points = scenes.plane_receivers(256)
    for filter in ("none", "mip", "summed_area"):
        filtered = SHADOW.moment_map(m, "variance", filter=filter)
        radius = None if filter == "none" else 0.0
        assert np.abs(SHADOW.variance(filtered, points, radius=radius) - SHADOW.hard(m, points, UP)).max() < 1e-5


def test_light_bleeds_through_two_blockers_as_the_theory_says():
    """Blockers at 2 and 3 over half of the filter each, a receiver at 4: all dark, and yet."""
    depth = np.where(np.arange(64) < 32, 2.0, 3.0)[None].repeat(64, 0)
    down = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    m = SHADOW.ShadowMap(depth, "perspective", [0, 4, 0], down, [-1, 1, -1, 1], 2.0, 3.0)
    filtered = SHADOW.moment_map(m, "variance", filter="summed_area", receivers=[[0.0, 0, 0]])
    lit = SHADOW.variance(filtered, [[0.0, 0, 0]], full_output=True)
    mean, variance = lit.moments[0, 0], lit.moments[0, 1] - lit.moments[0, 0] ** 2
    assert lit.lit[0] == pytest.approx(variance / (variance + (lit.z[0] - mean) ** 2), abs=1e-12)
    # In depth itself: variance 1/4, 3/2 from the mean.
    assert lit.lit[0] == pytest.approx(0.25 / (0.25 + 2.25), abs=1e-3)
    assert SHADOW.variance(filtered, [[0.0, 0, 0]], light_bleeding=0.12)[0] == 0


def test_outside_behind_and_nan(scenes):
    m = scenes.analytic_map(sl)
    filtered = SHADOW.moment_map(m, "variance")
    points = np.float32([[-99, 0, 0], [0, 9, 0], [np.nan, 0, 0], [-1, 0, 0]])
    found = SHADOW.variance(filtered, points, full_output=True)
    assert found.lit[0] == found.lit[1] == 1 and np.isnan(found.lit[2]) and found.lit[3] < 1e-3
    assert found.lit.dtype == np.float32 and found.moments.shape == (4, 2)
    normals = np.float32([[0, 1, 0], [0, np.nan, 0]])
    assert np.isnan(SHADOW.variance(filtered, [-1.0, 0, 0], normals)).tolist() == [False, True]


def test_the_same_for_any_number_of_threads(scenes):
    m = scenes.analytic_map(sl)
    filtered = SHADOW.moment_map(m, "variance")
    points = scenes.plane_receivers(256, np.float32)
    results = []
    for n in (1, 2, 3):
        sl.set_threads(n)
        results.append(SHADOW.variance(filtered, points))
    sl.set_threads(None)
    assert all(np.array_equal(results[0], r) for r in results[1:])


def test_errors_name_the_argument(scenes):
    m = scenes.analytic_map(sl)
    filtered, point = SHADOW.moment_map(m, "variance"), [[0.0, 0, 0]]
    wrong = [
        ("moment_map", TypeError, (m, point), {}),
        ("moment_map", ValueError, (SHADOW.moment_map(m), point), {}),
        ("radius", ValueError, (filtered, point), {"radius": 2.0}),
        ("min_variance", ValueError, (filtered, point), {"min_variance": -1}),
        ("light_bleeding", ValueError, (filtered, point), {"light_bleeding": 1.0}),
        ("slope_bias", ValueError, (filtered, point), {"slope_bias": -1}),
        ("receivers", ValueError, (filtered, [1.0]), {}),
        ("out", ValueError, (filtered, point), {"out": np.empty(2)}),
    ]
    for name, error, args, kwargs in wrong:
        with pytest.raises(error, match=name):
            SHADOW.variance(*args, **kwargs)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_without_variance_nothing_lies_beyond_the_mean(dtype):
    tiny = np.finfo(dtype).smallest_subnormal
    for t in (tiny, np.finfo(dtype).tiny, dtype(1e-30)):
        assert sl.shadow.chebyshev_bound(dtype(0), dtype(0), dtype(t)) == 0
    assert sl.shadow.chebyshev_bound(dtype(0), dtype(0), dtype(0)) == 1
