"""Moment shadow maps: bounds against linear programming, two depths exactly, what 16 bits and their bias cost."""

import numpy as np
import pytest
import scipy.ndimage
import scipy.optimize
import shadelab as sl
from hypothesis import example, given, settings
from hypothesis import strategies as st

SHADOW = sl.shadow
DOWN = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
METHODS = ["hamburger", "hausdorff"]


def moments_of(z, w):
    return np.stack([(w * z**k).sum(-1) for k in (1, 2, 3, 4)], -1)


def random_distributions(n, depths, seed=1):
    rng = np.random.default_rng(seed)
    z, w = rng.uniform(-1, 1, (n, depths)), rng.dirichlet(np.ones(depths), n)
    t = rng.uniform(-1, 1, n)
    return z, w, t, (w * (z < t[:, None])).sum(1)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("depths", [3, 4, 8, 50])
def test_no_distribution_has_less_before_the_receiver(method, depths):
    z, w, t, share = random_distributions(20_000, depths)
    bound = SHADOW.moment_bound(moments_of(z, w), t, method=method)
    # Three depths are met exactly where t is one; the square root of a rounding near such.
    assert (bound <= share + 1e-5).all()
    assert (bound >= 0).all() and (bound <= 1).all()


def test_the_bound_on_an_interval_is_sharper():
    z, w, t, _ = random_distributions(20_000, 8)
    loose, tight = (SHADOW.moment_bound(moments_of(z, w), t, method=m) for m in METHODS)
    assert (tight >= loose - 1e-6).all()
    assert tight.mean() > loose.mean() + 0.01


@pytest.mark.parametrize("method", METHODS)
def test_the_bound_is_the_least_by_linear_programming(method):
    """Over all distributions on a fine grid of depths, the least share before t."""
    z, w, t, _ = random_distributions(12, 6, seed=3)
    grid = np.linspace(-1, 1, 2001) if method == "hausdorff" else np.sinh(np.linspace(-4, 4, 8001)) / 4
    for i in range(len(t)):
        moments = moments_of(z[i], w[i])
        # t itself must be on the grid: the extremal distribution has it.
        points = np.sort(np.append(grid, t[i]))
        least = scipy.optimize.linprog(
            (points < t[i]).astype(float),
            A_eq=np.stack([points**k for k in range(5)]),
            b_eq=[1, *moments],
            method="highs",
        )
        if not least.success:
            continue
        bound = SHADOW.moment_bound(moments, t[i], method=method)
        # The grid is a restriction, so its least is no less; and a step of it away.
        assert bound <= least.fun + 1e-6
        assert bound >= least.fun - 0.02


# Anywhere, at the ends of the range, and within 1e-16 to 1e-7 of them.
BY_AN_END = st.tuples(st.sampled_from([-1.0, 1.0]), st.floats(-16, -7)).map(lambda e: e[0] * (1 - 10.0 ** e[1]))
DEPTHS = st.one_of(st.floats(-1, 1), st.sampled_from([-1.0, 1.0]), BY_AN_END)


@given(DEPTHS, DEPTHS, st.floats(0.05, 0.95), st.sampled_from([np.float32, np.float64]))
@example(-0.9999999999999999, -0.0078125, 0.5, np.float64)
@settings(max_examples=500, deadline=None)
def test_two_depths_are_found(z, other, share, dtype):
    z, other = sorted(np.array([z, other], dtype).astype(float))
    if other - z < 0.02:
        return
    moments = moments_of(np.array([z, other]), np.array([share, 1 - share])).astype(dtype)
    for method in METHODS:
        nearer, farther = SHADOW.moment_bound(moments, np.array([z, other], dtype), method=method)
        assert 0 <= nearer < (1e-6 if dtype == np.float32 else 1e-13)
        # Measured over 1e6 pairs: 3e-4 and 1e-11 at most.
        assert abs(farther - share) < (1e-3 if dtype == np.float32 else 1e-9)
        between = SHADOW.moment_bound(moments, dtype((z + other) / 2), method=method)
        assert between < share + 1e-6
        if dtype == np.float64 or other - z > 0.5:
            assert abs(between - share) < 1e-3


@given(st.lists(st.tuples(DEPTHS, st.floats(0.01, 1)), min_size=1, max_size=6), DEPTHS, st.booleans())
@settings(max_examples=500, deadline=None)
def test_no_depth_at_an_end_makes_the_bound_more_than_the_share(points, t, single):
    dtype = np.float32 if single else np.float64
    z, w = np.array(points).T
    z, w, t = z.astype(dtype).astype(float), w / w.sum(), float(dtype(t))
    moments = moments_of(z, w).astype(dtype)
    share = w[z < t].sum()
    for method in METHODS:
        bound = SHADOW.moment_bound(moments, dtype(t), method=method)
        # What the bias adds, and a few roundings.
        assert 0 <= bound <= share + (1e-6 if single else 1e-13)


def test_one_depth_alone_and_what_is_infinitely_far_are_no_nan():
    assert SHADOW.moment_bound([-1.0, 1, -1, 1], [-1.0, 0.0, 1.0], bias=0.0) == pytest.approx([0, 1, 1], abs=1e-12)
    alone = [0.25, 0.25**2, 0.25**3, 0.25**4]
    assert SHADOW.moment_bound(alone, [0.2, 0.25, 0.3], bias=0.0) == pytest.approx([0, 0, 1], abs=1e-12)
    for method in METHODS:
        found = SHADOW.moment_bound([0.0, 1, 0, 1], [-np.inf, 0.5, np.inf], method=method)
        np.testing.assert_allclose(found, [0, 0.5, 1], atol=1e-9)
    # Moments that no distribution has.
    for none in ([0.0, 0, 0, 1], [0.0, 0, 0, 0], [2.0, 0, 0, 0], [0.0, -1, 0, 1]):
        for method in METHODS:
            bound = SHADOW.moment_bound(none, np.linspace(-1, 1, 9), method=method, bias=0.0)
            assert (bound >= 0).all() and (bound <= 1).all()


def in_16_bits(moments):
    """Through the transform of Peters et al. (2017), rounded, and back."""
    b1, b2, b3, b4 = moments.T
    r = np.sqrt(3)
    q = np.stack([1.5 * b1 - 2 * b3 + 0.5, 4 * (b2 - b4), r / 2 * b1 - 2 * r / 9 * b3 + 0.5, 0.5 * (b2 + b4)], -1)
    q1, q2, q3, q4 = (np.round(q * 65535) / 65535).T
    o1, o3 = q1 - 0.5, q3 - 0.5
    return np.stack([r * o3 - o1 / 3, q4 + q2 / 8, 0.75 * (r * o3 - o1), q4 - q2 / 8], -1)


def drawn(moments, share, target):
    """Moments drawn by a share towards others, as a lookup draws them."""
    return (1 - share) * moments + share * np.array([0, target, 0, target])


@pytest.mark.parametrize(
    ("stored", "target", "published", "too_small"),
    [(lambda m: m.astype(np.float32).astype(float), 0.375, 3e-7, 1e-7), (in_16_bits, 0.628, 6e-5, 2e-5)],
    ids=["float32", "16 bit"],
)
def test_the_published_bias_is_about_the_least(stored, target, published, too_small):
    """A third of it, and some constant depth shadows itself; with it none does, and two depths are all but exact."""
    rng = np.random.default_rng(5)
    n = 20_000
    z = np.sort(rng.uniform(-1, 1, (n, 2)), 1)
    share = rng.uniform(0.05, 0.95, n)
    pairs = stored(moments_of(z, np.stack([share, 1 - share], -1)))
    single = stored(moments_of(z[:, :1], np.ones((n, 1))))
    # (At the very end of the interval z and the end are one depth.)
    inner = z[:, 0] > -0.999
    single, t = single[inner], z[inner, 0]
    acne = [SHADOW.moment_bound(drawn(single, b, target), t, bias=0).max() for b in (published, too_small)]
    assert acne[0] < 0.06 and acne[1] > 0.5
    apart = z[:, 1] - z[:, 0] > 0.02
    off = np.abs(SHADOW.moment_bound(drawn(pairs, published, target), z[:, 1], bias=0) - share)[apart]
    more = np.abs(SHADOW.moment_bound(drawn(pairs, 10 * published, target), z[:, 1], bias=0) - share)[apart]
    assert off.max() < 0.05 and np.sqrt((off**2).mean()) < 2e-3
    assert more.mean() > 3 * off.mean()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("method", METHODS)
def test_never_darker_than_filtered_comparisons(scenes, dtype, method):
    rng = np.random.default_rng(1)
    depth = rng.choice([2.0, 2.5, 3.2, 4.0], (128, 128)).astype(dtype)
    m = SHADOW.ShadowMap(depth, "perspective", [0, 4, 0], DOWN, [-1, 1, -1, 1], 2.0, 4.0)
    points = scenes.plane_receivers(128, dtype)
    compared = scipy.ndimage.uniform_filter((depth >= 4).astype(float), 7)
    inner = np.s_[4:-4, 4:-4]
    lit = SHADOW.moment(SHADOW.moment_map(m, filter="summed_area"), points, radius=3.5, method=method)
    bled = SHADOW.variance(SHADOW.moment_map(m, "variance", filter="summed_area"), points, radius=3.5)
    assert (lit[inner] >= compared[inner] - 2e-3).all()
    # And less light bleeds than by two moments.
    assert (lit - compared)[inner].mean() < 0.7 * (bled - compared)[inner].mean()


def test_equals_filtered_comparisons_between_two_parallel_planes(scenes):
    m = scenes.analytic_map(sl, np.float64, 256)
    points = scenes.plane_receivers(256)
    compared = scipy.ndimage.gaussian_filter((m.depth >= 4).astype(float), 3.0, mode="nearest", truncate=3.0)
    for bits, tolerance in ((None, 1e-4), (16, 0.02)):
        lit = SHADOW.moment(SHADOW.moment_map(m, sigma=3.0, bits=bits), points)
        np.testing.assert_allclose(lit, compared, atol=tolerance)
    m = scenes.analytic_map(sl, np.float32, 256)
    lit = SHADOW.moment(SHADOW.moment_map(m, sigma=3.0), points)
    np.testing.assert_allclose(lit, compared, atol=2e-3)


def test_two_blockers_leak_nothing_and_three_depths_are_exact(scenes):
    """Blockers at 2 and 3, ground at 4, a third each."""
    depth = np.array([2.0, 3.0, 4.0])[np.arange(96) // 32][None].repeat(96, 0)
    m = SHADOW.ShadowMap(depth, "perspective", [0, 4, 0], DOWN, [-1, 1, -1, 1], 2.0, 4.0)
    four = SHADOW.moment_map(m, filter="summed_area")
    two = SHADOW.moment_map(m, "variance", filter="summed_area")
    point = [[0.0, 0, 0]]
    assert SHADOW.moment(four, point, radius=48.0)[0] == pytest.approx(1 / 3, abs=1e-3)
    assert SHADOW.variance(two, point, radius=48.0)[0] > 0.39


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
    for bits in (None, 16):
        filtered = SHADOW.moment_map(m, sigma=2.0, receivers=points, bits=bits)
        assert SHADOW.moment(filtered, points, normal).min() > 0.98


def test_a_narrow_filter_is_a_hard_shadow(scenes):
    m = scenes.analytic_map(sl, np.float64, 256)
    points = scenes.plane_receivers(256)
    hard = SHADOW.hard(m, points, [0, 1, 0])
    for filter in ("none", "mip", "summed_area"):
        filtered = SHADOW.moment_map(m, filter=filter)
        radius = None if filter == "none" else 0.0
        assert np.abs(SHADOW.moment(filtered, points, radius=radius) - hard).max() < 1e-3


def test_nan_and_errors(scenes):
    m = scenes.analytic_map(sl)
    filtered = SHADOW.moment_map(m)
    lit = SHADOW.moment(filtered, np.float32([[np.nan, 0, 0], [1, 0, 0]]))
    assert np.isnan(lit).tolist() == [True, False]
    assert np.isnan(SHADOW.moment_bound([np.nan, 1, 0, 1], 0.5))
    assert SHADOW.moment_bound(np.float32([0, 1, 0, 1]), 0.5).dtype == np.float32
    for name, f in (
        ("method", lambda: SHADOW.moment(filtered, [0.0, 0, 0], method="hilbert")),
        ("moment_bias", lambda: SHADOW.moment(filtered, [0.0, 0, 0], moment_bias=2.0)),
        ("bias", lambda: SHADOW.moment_bound([0.0, 1, 0, 1], 0.5, bias=-1)),
        ("moments", lambda: SHADOW.moment_bound([0.0, 1, 0], 0.5)),
        ("method", lambda: SHADOW.moment_bound([0.0, 1, 0, 1], 0.5, method="x")),
    ):
        with pytest.raises(ValueError, match=name):
            f()
