"""Soft shadows from moments: the penumbra of a half-plane in width and profile, no noise, hard at contact."""

import numpy as np
import pytest
import shadelab as sl

SHADOW = sl.shadow
UP = [0, 1, 0]


def profile(x, light, blocker=2.0, ground=4.0):
    """The lit fraction on the ground along x, a half-plane x < 0 hiding a light of this side."""
    width = light * (ground - blocker) / blocker
    return np.clip(0.5 + x / width, 0, 1)


@pytest.mark.parametrize("kind", ["variance", "moment"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("light", [0.2, 0.5, 1.0])
def test_penumbra_of_a_half_plane(scenes, kind, dtype, light):
    m = scenes.analytic_map(sl, dtype, 512)
    table = SHADOW.moment_map(m, kind, filter="summed_area")
    x = np.linspace(-1.5, 1.5, 601)
    found = SHADOW.variance_soft(table, np.stack([x, 0 * x, 0 * x], -1), UP, light_size=light, full_output=True)
    # A texel of the map is 1/64 on the ground: as much of the penumbra as it is of its width.
    np.testing.assert_allclose(found.lit, profile(x, light), atol=0.6 / 64 / light + 0.01)
    inside = np.abs(x) < 0.4 * light
    np.testing.assert_allclose(found.blocker_depth[inside], 2.0, atol=0.02)
    np.testing.assert_allclose(found.penumbra[inside], light, rtol=0.03)
    assert (found.lit[x < -light] == 0).all() or (found.lit[x < -light] < 2e-3).all()
    assert (found.lit[x > light] == 1).all()
    assert found.lit.dtype == dtype


def test_mips_are_close_to_the_table(scenes):
    m = scenes.analytic_map(sl, np.float32, 512)
    x = np.linspace(-1.5, 1.5, 601)
    points = np.stack([x, 0 * x, 0 * x], -1)
    for kind in ("variance", "moment"):
        lit = SHADOW.variance_soft(SHADOW.moment_map(m, kind, filter="mip"), points, UP, light_size=0.5)
        # The kernel of a mip is no box, and depends on where the mips' grid lies.
        assert np.abs(lit - profile(x, 0.5)).max() < 0.25
        assert np.abs(lit - profile(x, 0.5)).mean() < 0.02


def test_a_small_light_gives_a_hard_shadow_and_contact_hardens(scenes):
    m = scenes.analytic_map(sl, np.float64, 256)
    table = SHADOW.moment_map(m, "variance", filter="summed_area")
    points = scenes.plane_receivers(256)
    hard = SHADOW.hard(m, points, UP)
    assert np.abs(SHADOW.variance_soft(table, points, light_size=1e-6) - hard).max() < 1e-5
    widths = []
    for height in (2.0, 1.0, 0.5, 0.1):
        depth = np.where(np.arange(512) < 256, 4.0 - height, 4.0)[None].repeat(512, 0)
        near = SHADOW.ShadowMap(depth, "perspective", [0, 4, 0], m.frame, m.window, 4.0 - height, 4.0)
        table = SHADOW.moment_map(near, filter="summed_area")
        widths.append(SHADOW.variance_soft(table, [[0.0, 0, 0]], UP, light_size=0.5, full_output=True).penumbra[0])
    np.testing.assert_allclose(widths, [0.5 * h / (4 - h) for h in (2.0, 1.0, 0.5, 0.1)], rtol=0.02)


def test_agrees_with_pcss_in_a_scene(scenes):
    """A box over the ground: the same shadow, but without noise."""
    box = scenes.join(scenes.quad(0.0, (-3, 3), (-3, 3)), scenes.quad(1.0, (-0.7, 0.7), (-0.7, 0.7)))
    light = scenes.rect_light(4.0, 0.8)
    points = scenes.plane_receivers(128, np.float32, 2.0)
    m = SHADOW.shadow_map(*box, light, 512, receivers=points)
    reference = SHADOW.ray_traced(sl.accel.BVH(*box), points, UP, light, 256)
    pcss = SHADOW.pcss(m, points, UP)
    soft = SHADOW.variance_soft(SHADOW.moment_map(m, filter="summed_area", receivers=points), points, UP)
    error = [np.sqrt(np.mean((lit - reference) ** 2)) for lit in (soft, pcss)]
    assert error[0] < error[1] < 0.1


@pytest.mark.parametrize("kind", ["variance", "moment"])
@pytest.mark.parametrize("degrees", [20, 40, 60, 70, 80])
def test_a_lit_slope_is_not_grey(scenes, kind, degrees):
    """A sloping plane and a small blocker beside it, near the light, which makes the search wide."""
    a = np.radians(degrees)
    turn = np.array([[np.cos(a), np.sin(a), 0], [0, 1, 0], [0, 0, 1]], np.float32)
    plane, beside = scenes.quad(0.0, (-3, 3), (-3, 3)), scenes.quad(2.0, (2.9, 3.1), (-0.2, 0.2))
    mesh = scenes.join((plane[0] @ turn, plane[1]), beside)
    x, z = np.meshgrid(np.linspace(-2, 0.5, 60), np.linspace(-2, 2, 60))
    points, normal = (np.stack([x, 0 * x, z], -1) @ turn).astype(np.float32), np.float32([-np.sin(a), np.cos(a), 0])
    light = scenes.rect_light(side=1.0)
    lit = SHADOW.ray_traced(sl.accel.BVH(*mesh), points, normal, light) == 1
    m = SHADOW.shadow_map(*mesh, light, 1024)
    table = SHADOW.moment_map(m, kind, filter="summed_area", receivers=points, reduce=2)
    soft = SHADOW.variance_soft(table, points, normal)
    # Measured: 0.999 at least, which is the bias of the moments.
    assert soft[lit].min() > 0.998 and lit.mean() > 0.9
    # Without the bias steep slopes are grey, four moments' first.
    if degrees >= 60:
        bare = SHADOW.variance_soft(table, points, normal, slope_bias=0.0)
        assert bare[lit].mean() < (0.8 if kind == "moment" else 0.999)


def test_a_bias_of_the_search_loses_what_is_near(scenes):
    """A low plate over steep ground: with the search biased as the filter is, hardly any of its shadow is left."""
    a = np.radians(60)
    turn = np.array([[np.cos(a), np.sin(a), 0], [0, 1, 0], [0, 0, 1]], np.float32)
    plane, plate = scenes.quad(0.0, (-3, 3), (-3, 3)), scenes.quad(0.3, (-0.4, 0.4), (-0.4, 0.4))
    far = scenes.quad(2.0, (2.9, 3.1), (-0.2, 0.2))
    mesh = scenes.join((plane[0] @ turn, plane[1]), (plate[0] @ turn, plate[1]), far)
    x, z = np.meshgrid(np.linspace(-1, 1, 60), np.linspace(-1, 1, 60))
    points, normal = (np.stack([x, 0 * x, z], -1) @ turn).astype(np.float32), np.float32([-np.sin(a), np.cos(a), 0])
    light = scenes.rect_light(side=1.0)
    reference = SHADOW.ray_traced(sl.accel.BVH(*mesh), points, normal, light, 64)
    table = SHADOW.moment_map(SHADOW.shadow_map(*mesh, light, 1024), filter="summed_area", receivers=points)
    error = [
        np.sqrt(np.mean((SHADOW.variance_soft(table, points, normal, search_slope_bias=b) - reference) ** 2))
        for b in (0.0, 1.0)
    ]
    assert error[0] < 0.6 * error[1]


def test_errors_name_the_argument(scenes):
    m = scenes.analytic_map(sl)
    point = [[0.0, 0, 0]]
    table = SHADOW.moment_map(m, filter="mip")
    with pytest.raises(ValueError, match="light_size"):
        SHADOW.variance_soft(table, point)
    with pytest.raises(ValueError, match="moment_map"):
        SHADOW.variance_soft(SHADOW.moment_map(m), point, light_size=0.5)
    with pytest.raises(ValueError, match="moment_map"):
        SHADOW.variance_soft(SHADOW.moment_map(m, "exponential_variance", filter="mip"), point, light_size=0.5)
    with pytest.raises(TypeError, match="moment_map"):
        SHADOW.variance_soft(m, point, light_size=0.5)
    lit = SHADOW.variance_soft(table, np.float32([[np.nan, 0, 0], [-99, 0, 0]]), light_size=0.5, full_output=True)
    assert np.isnan(lit.lit[0]) and lit.lit[1] == 1 and np.isnan(lit.penumbra[0]) and lit.penumbra[1] == 0
