"""Percentage-closer filtering: equals brute force, tends to the hard shadow, keeps its bounds."""

import numpy as np
import pytest
import shadelab as sl

UP = [0, 1, 0]


def random_receivers(n, dtype, seed=5):
    return (np.random.default_rng(seed).uniform(-3, 3, (n, 3)) * [1, 0, 1]).astype(dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_equals_brute_force_over_a_random_map(dtype, projection):
    rng = np.random.default_rng(7)
    depth = np.where(rng.uniform(size=(32, 48)) < 0.2, np.inf, rng.uniform(2, 6, (32, 48))).astype(dtype)
    m = sl.shadow.ShadowMap(depth, projection, [0, 4, 0], [[1, 0, 0], [0, 0, -1], [0, -1, 0]], [-1, 1, -1, 1], 2, 6)
    points = random_receivers(300, dtype)
    got = sl.shadow.pcf(m, points, samples=9, radius=2.5, kernel="grid", seed=None)
    scale = np.array([48 / 2, 32 / 2])
    plane = points[:, [0, 2]] / (4 if projection == "perspective" else 1)
    centre = (plane * [1, 1] + 1) * scale
    expected = np.zeros(300)
    for oy in (-2.5 * 2 / 3, 0, 2.5 * 2 / 3):
        for ox in (-2.5 * 2 / 3, 0, 2.5 * 2 / 3):
            x, y = np.floor(centre + np.array([ox, oy])).astype(int).T
            inside = (x >= 0) & (x < 48) & (y >= 0) & (y < 32)
            expected += ~(inside & (depth[y.clip(0, 31), x.clip(0, 47)] < 4)) / 9
    # A tap within rounding of a texel's border may fall to either side.
    assert (np.abs(got - expected) > 1e-5).mean() < 0.01


@pytest.mark.parametrize("kernel", ["vogel", "box", "grid", "tent", "poisson"])
def test_tends_to_the_hard_shadow(scenes, kernel):
    m = scenes.analytic_map(sl)
    points = random_receivers(2000, np.float32)
    hard = sl.shadow.hard(m, points, UP)
    assert np.array_equal(sl.shadow.pcf(m, points, UP, radius=0.0, kernel=kernel), hard)
    # A filter of half side r can only change receivers within r of the texels' edge.
    near = np.abs(points[:, 0]) < 0.06
    small = sl.shadow.pcf(m, points, UP, radius=0.05, units="world", kernel=kernel)
    assert np.array_equal(small[~near], hard[~near]) and not np.array_equal(small, hard)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_penumbra_of_the_box_is_a_ramp_of_its_width(scenes, dtype):
    m = scenes.analytic_map(sl, dtype, n=2048)
    x = np.linspace(-0.6, 0.6, 301).astype(dtype)
    points = np.stack([x, 0 * x, 0 * x], -1)
    lit = sl.shadow.pcf(m, points, UP, samples=1024, radius=0.4, units="world", kernel="box", seed=None)
    # One texel (0.004 of 0.8) and one sample in a thousand.
    assert np.abs(lit - np.clip(0.5 + x / 0.8, 0, 1)).max() < 0.004 / 0.8 + 2 / 1024


def test_units_agree_and_noise_is_unbiased(scenes):
    m = scenes.analytic_map(sl, n=1024)
    points = np.zeros((20_000, 3), np.float32) + np.float32([0.02, 0, 0.3])
    texels = 0.1 / m.texel_size(4.0)
    for kernel in ("vogel", "box", "grid"):
        a = sl.shadow.pcf(m, points, UP, radius=0.1, units="world", kernel=kernel)
        b = sl.shadow.pcf(m, points, UP, radius=texels, kernel=kernel)
        assert np.array_equal(a, b)
        exact = sl.shadow.pcf(m, points[:1], UP, samples=4096, radius=texels, kernel=kernel, seed=None)
        # The fixed points of a grid of 64 columns know the edge to 1 / 128; the noise of the mean is below 0.002.
        assert abs(a.mean() - exact[0]) < 1 / 128 + 0.004
        assert np.unique(a).size > 1
        assert not np.array_equal(a, sl.shadow.pcf(m, points, UP, radius=0.1, units="world", kernel=kernel, seed=1))


@pytest.mark.parametrize("samples", [1, 7, 8, 9, 16, 33])
def test_every_sample_counts_once(scenes, samples):
    m = scenes.analytic_map(sl)
    points = random_receivers(500, np.float32) * 0.1
    lit = sl.shadow.pcf(m, points, UP, samples=samples, radius=20)
    counts = lit * samples
    assert np.allclose(counts, np.round(counts), atol=1e-4) and lit.min() >= 0 and lit.max() <= 1


def test_filter_wider_than_the_map(scenes):
    m = scenes.analytic_map(sl, n=8)
    lit = sl.shadow.pcf(m, [[0.0, 0, 0]], UP, samples=1024, radius=1e30, kernel="box")
    # Nearly all of the filter lies outside, where it is lit.
    assert 0.9 < lit[0] <= 1


def test_levels_and_threads_change_nothing(scenes):
    m = scenes.analytic_map(sl)
    points = random_receivers(40_000, np.float32)
    before, results = sl.threads(), []
    try:
        for level in sl.simd_levels():
            for n in (1, 3):
                sl.set_threads(n)
                with sl.simd(level):
                    results.append(sl.shadow.pcf(m, points, UP, radius=9))
                    results[-1] = (results[-1], *sl.shadow.pcss(m, points, UP, light_size=1.0, full_output=True))
    finally:
        sl.set_threads(before)
    for other in results[1:]:
        assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(results[0], other, strict=True))


def test_errors_name_the_argument(scenes):
    m = scenes.analytic_map(sl)
    for knobs, name in (
        ({"samples": 0}, "samples"),
        ({"samples": 8, "kernel": "grid"}, "samples: expected a square number"),
        ({"radius": -1.0}, "radius"),
        ({"kernel": "disk"}, "kernel"),
        ({"units": "pixels"}, "units"),
        ({"seed": -1}, "seed"),
    ):
        with pytest.raises(ValueError, match=name):
            sl.shadow.pcf(m, [0, 0, 0], **knobs)


def test_penumbra_of_the_tent_is_smooth(scenes):
    m = scenes.analytic_map(sl, np.float64, n=2048)
    x = np.linspace(-0.6, 0.6, 301)
    points = np.stack([x, 0 * x, 0 * x], -1)
    lit = sl.shadow.pcf(m, points, UP, samples=1024, radius=0.4, units="world", kernel="tent", seed=None)
    u = np.clip(x / 0.4, -1, 1)
    # The integral of a tent, to a texel and a sample.
    assert np.abs(lit - (0.5 + u - np.copysign(u * u, u) / 2)).max() < 0.004 / 0.4 + 2 / 1024


def test_penumbra_of_poisson_points_is_that_of_the_disk(scenes):
    m = scenes.analytic_map(sl, np.float64, n=2048)
    x = np.linspace(-0.45, 0.45, 61)
    points = np.stack(np.broadcast_arrays(x, 0.0, np.linspace(-0.5, 0.5, 400)[:, None]), -1)
    lit = sl.shadow.pcf(m, points, UP, samples=32, radius=0.4, units="world", kernel="poisson")
    u = np.clip(x / 0.4, -1, 1)
    disk = 0.5 + (u * np.sqrt(1 - u * u) + np.arcsin(u)) / np.pi
    # 400 turns of 32 points, and their own deviation from an even disk.
    assert np.abs(lit.mean(0) - disk).max() < 0.06
    # Less noise than as many independent points would have.
    assert lit.std(0).max() < 0.8 * np.sqrt(0.25 / 32)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_bilinear_comparison_equals_brute_force(dtype):
    """One tap: the four comparisons about a place, by nearness."""
    rng = np.random.default_rng(8)
    depth = rng.choice([2.0, np.inf], (32, 48)).astype(dtype)
    m = sl.shadow.ShadowMap(depth, "perspective", [0, 4, 0], [[1, 0, 0], [0, 0, -1], [0, -1, 0]], [-1, 1, -1, 1], 2, 6)
    points = random_receivers(500, dtype)
    got = sl.shadow.pcf(m, points, samples=1, radius=0.0, kernel="grid", seed=None, bilinear=True)
    at = (points[:, [0, 2]].astype(np.float64) / 4 + 1) * [24, 16] - 0.5
    corner, share = np.floor(at).astype(int), at - np.floor(at)
    expected = np.zeros(500)
    for dy in (0, 1):
        for dx in (0, 1):
            weight = np.where(dx, share[:, 0], 1 - share[:, 0]) * np.where(dy, share[:, 1], 1 - share[:, 1])
            x, y = corner[:, 0] + dx, corner[:, 1] + dy
            inside = (x >= 0) & (x < 48) & (y >= 0) & (y < 32)
            expected += weight * ~(inside & (depth[y.clip(0, 31), x.clip(0, 47)] < 4))
    np.testing.assert_allclose(got, expected, atol=48 * np.finfo(dtype).eps)
    # Without jumps: a step of the receiver changes it in proportion.
    x = np.linspace(-1, 1, 5001)
    line = sl.shadow.pcf(m, np.stack([x, 0 * x, 0 * x], -1), samples=16, radius=2.0, bilinear=True, seed=None)
    assert np.abs(np.diff(line)).max() < 16 * 2.5 * (x[1] - x[0]) * 6 / 16 + 1e-6
