"""Percentage-closer soft shadows: similar triangles on an analytic edge, and the limits."""

import numpy as np
import pytest
import shadelab as sl

UP = [0, 1, 0]


def edge_scene(scenes, sl, height, edge, dtype, resolution=2048):
    """A half-plane x < edge at `height` over a wide ground, and its map."""
    ground = scenes.quad(0.0, (-4, 4), (-1, 1), dtype)
    blocker = scenes.quad(height, (-4, edge), (-4, 4), dtype)
    return sl.shadow.shadow_map(*scenes.join(ground, blocker), scenes.rect_light(side=0.8), resolution)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(("height", "edge"), [(2.0, 0.0), (2.0, -0.5), (0.5, 0.3), (1.0, 0.0)])
def test_penumbra_of_a_half_plane_is_that_of_similar_triangles(scenes, dtype, height, edge):
    m = edge_scene(scenes, sl, height, edge, dtype)
    # The ground 4 below the light: the edge's shadow about `middle`, over `width`.
    middle, width = edge * 4 / (4 - height), 0.8 * height / (4 - height)
    x = np.linspace(middle - width, middle + width, 401).astype(dtype)
    found = sl.shadow.pcss(
        m, np.stack([x, 0 * x, 0 * x], -1), UP, blocker_samples=1024, filter_samples=1024, seed=None, full_output=True
    )
    exact = np.clip(0.5 + (x - middle) / width, 0, 1)
    blocked = np.isfinite(found.blocker_depth)
    # Blocker depth and width are exact to rounding wherever a blocker was found ...
    assert np.allclose(found.blocker_depth[blocked], 4 - height, rtol=1e-5)
    assert np.allclose(found.penumbra[blocked], width, rtol=3e-5)
    # ... and the profile to a texel and a few samples in a thousand.
    texel = m.texel_size(4.0) / width
    assert np.abs(found.lit - exact).max() < texel + 3 / 1024
    # Measured on the profile itself, between 10 % and 90 %.
    rise = np.interp([0.1, 0.9], found.lit, x)
    assert (rise[1] - rise[0]) / 0.8 == pytest.approx(width, rel=0.02)


def test_few_samples_are_the_profile_with_noise(scenes):
    m = edge_scene(scenes, sl, 2.0, 0.0, np.float32, 1024)
    x = np.linspace(-0.8, 0.8, 41).astype(np.float32)[:, None].repeat(500, 1)
    lit = sl.shadow.pcss(m, np.stack([x, 0 * x, 0 * x], -1), UP, blocker_samples=16, filter_samples=32)
    exact = np.clip(0.5 + x / 0.8, 0, 1)
    # A search of 16 may miss blockers of less than 1 / 16 of the light: a bias of up to 1 / 64. Noise of 32.
    assert np.abs(lit.mean(1) - exact[:, 0]).max() < 1 / 64
    assert lit.std(1).max() < 1 / 32


def test_a_disk_light_has_the_cosine_profile(scenes):
    m = edge_scene(scenes, sl, 2.0, 0.0, np.float64)
    x = np.linspace(-0.5, 0.5, 101)
    points = np.stack([x, 0 * x, 0 * x], -1)
    lit = sl.shadow.pcss(
        m, points, UP, light_size=0.8, kernel="vogel", blocker_samples=512, filter_samples=2048, seed=None
    )
    # The share of a disk of diameter 0.8 on one side of a chord at x.
    c = np.clip(x / 0.4, -1, 1)
    exact = 0.5 + (np.arcsin(c) + c * np.sqrt(1 - c * c)) / np.pi
    # Two texels: 0.002 of 0.8 each, and the evenness of 2048 points of a spiral.
    assert np.abs(lit - exact).max() < 0.008


def test_an_orthographic_map_takes_an_angle(scenes):
    ground, blocker = scenes.quad(0.0, (-4, 4), (-1, 1), float), scenes.quad(2.0, (-4, 0), (-4, 4), float)
    m = sl.shadow.shadow_map(*scenes.join(ground, blocker), sl.light.DirectionalLight((0, -1, 0)), 2048)
    x = np.linspace(-0.5, 0.5, 101)
    found = sl.shadow.pcss(
        m,
        np.stack([x, 0 * x, 0 * x], -1),
        UP,
        light_size=0.3,
        kernel="box",
        blocker_samples=1024,
        filter_samples=1024,
        seed=None,
        full_output=True,
    )
    width = 2 * 2 * np.tan(0.15)
    assert np.allclose(found.penumbra[np.isfinite(found.blocker_depth)], width, rtol=1e-6)
    assert np.abs(found.lit - np.clip(0.5 + x / width, 0, 1)).max() < m.texel_size() / width + 3 / 1024


def test_a_small_light_gives_the_hard_shadow(scenes):
    m = scenes.analytic_map(sl)
    points = (np.random.default_rng(5).uniform(-3, 3, (5000, 3)) * [1, 0, 1]).astype(np.float32)
    hard = sl.shadow.hard(m, points, UP)
    assert np.array_equal(sl.shadow.pcss(m, points, UP, light_size=1e-9), hard)
    assert np.array_equal(sl.shadow.pcss(m, points, UP, light_size=0.0), hard)


def test_nothing_blocks_nothing_is_found(scenes):
    m = sl.shadow.shadow_map(*scenes.quad(0.0, (-2, 2), (-2, 2)), scenes.rect_light(), 64)
    points = (np.random.default_rng(5).uniform(-2, 2, (500, 3)) * [1, 0, 1]).astype(np.float32)
    found = sl.shadow.pcss(m, points, UP, full_output=True)
    assert (found.lit == 1).all() and np.isnan(found.blocker_depth).all() and (found.penumbra == 0).all()


def test_the_search_region_is_the_lights_image_at_the_least_depth(scenes):
    m = scenes.analytic_map(sl, n=256)
    found = sl.shadow.pcss(m, [[-1.0, 0, 0]], UP, light_size=0.4, full_output=True)
    # Half of 0.4 (1/2 - 1/4) at unit depth, where a texel measures 2 / 256.
    assert found.search_radius[0] == pytest.approx(0.2 * 0.25 * 128)


def test_blockers_at_two_depths_count_as_one_at_their_mean(scenes):
    depth = np.where(np.indices((256, 256)).sum(0) % 2, 1.0, 2.0)
    m = sl.shadow.ShadowMap(depth, "perspective", [0, 4, 0], [[1, 0, 0], [0, 0, -1], [0, -1, 0]], [-1, 1, -1, 1], 1, 2)
    knobs = {"light_size": 0.4, "blocker_samples": 4096, "full_output": True}
    found = sl.shadow.pcss(m, [[0.0, 0, 0]], UP, search="region", **knobs)
    assert found.blocker_depth[0] == pytest.approx(1.5, abs=0.02)
    assert found.penumbra[0] == pytest.approx((4 - 1.5) / 1.5 * 0.4, rel=0.03)
    assert found.lit[0] == 0
    # At depth 2 a third of the region's side, and half a texel of 19, lies between: (1/2 - 1/4) / (1 - 1/4).
    found = sl.shadow.pcss(m, [[0.0, 0, 0]], UP, search="frustum", **knobs)
    assert found.blocker_depth[0] == pytest.approx((1 + 2 / 9) / (1 + 1 / 9), abs=0.05)


def test_shadows_harden_at_contact(scenes):
    wall = np.array([[0.5, 0, -2], [0.5, 0, 2], [0.5, 1, 2], [0.5, 1, -2]]), np.array([[0, 1, 2], [0, 2, 3]])
    mesh = scenes.join(wall, scenes.quad(0.0, (-4, 4), (-4, 4), float))
    m = sl.shadow.shadow_map(*mesh, scenes.rect_light(side=0.5, center=(-2.0, 0.0)), 1024)
    x = np.linspace(0.5, 0.8, 601)
    points = np.stack([x, 0 * x, 0 * x], -1)
    found = sl.shadow.pcss(m, points, UP, blocker_samples=64, filter_samples=64, full_output=True)
    # Deep shadow begins within two texels of the wall: no light leaks in under it.
    gap = x[np.argmax(found.lit < 0.05)] - 0.5
    assert gap <= 2 * m.texel_size(4.0)
    # Close to the wall the mean blocker is the wall's own foot, and the penumbra is narrow; it widens with distance.
    assert found.penumbra[20] < found.penumbra[-1]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_light_in_the_receivers_plane_gives_fractions(scenes, dtype):
    m = scenes.analytic_map(sl, dtype)
    points = np.random.default_rng(2).uniform(-2, 2, (500, 3)).astype(dtype)
    # Normals square to the direction of the light, to rounding.
    normals = np.cross([0, 4, 0] - points, [1, 0, 0])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    for f in (sl.shadow.hard, sl.shadow.pcf, lambda *a: sl.shadow.pcss(*a, light_size=1.0)):
        lit = f(m, points, normals)
        assert ((lit >= 0) & (lit <= 1)).all()


def test_a_light_without_extent_asks_for_one(scenes):
    m = scenes.analytic_map(sl)
    with pytest.raises(ValueError, match="light_size: the map's light has no extent"):
        sl.shadow.pcss(m, [0, 0, 0])
    with pytest.raises(ValueError, match="light_size"):
        sl.shadow.pcss(m, [0, 0, 0], light_size=-1.0)
    with pytest.raises(ValueError, match="blocker_samples"):
        sl.shadow.pcss(m, [0, 0, 0], light_size=1.0, blocker_samples=0)
