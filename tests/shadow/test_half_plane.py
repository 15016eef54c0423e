"""Half-planes before a light: similar triangles, strips and corners of them, rays, and the penumbrae of filters."""

import numpy as np
import pytest
import shadelab as sl
from shadelab.light import DiskLight, PointLight, PolygonLight, RectLight

UP = [0, 1, 0]
ROOF = [[0.0, 2, 0], [0, 0, 1], [-1, 0, 0]]


def along(x, z=0.0, dtype=np.float64):
    x = np.asarray(x, dtype)
    return np.stack([x, 0 * x, 0 * x + dtype(z)], -1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(("height", "edge"), [(2.0, 0.0), (0.5, 0.3), (3.5, -0.4)])
def test_penumbra_is_that_of_similar_triangles(scenes, dtype, height, edge):
    light = scenes.rect_light(side=0.8)
    x = np.linspace(-4, 4, 1001)
    lit = sl.shadow.half_plane(along(x, 0.3, dtype), None, light, [[edge, height, 5], [0, 0, 2], [-3, 0, 1]])
    middle, width = edge * 4 / (4 - height), 0.8 * height / (4 - height)
    assert lit.dtype == dtype
    # Rounding of coordinates, over a penumbra of at least 0.11.
    np.testing.assert_allclose(
        lit, np.clip(0.5 + (x - middle) / width, 0, 1), atol=2e-5 if dtype == np.float32 else 1e-13
    )


def test_any_attitude_and_scale_give_the_same(scenes):
    """Shares do not change when all is turned, moved and scaled, nor when directions into the plane lean."""
    rng = np.random.default_rng(3)
    points, normals = rng.uniform(-1, 1, (200, 3)) * [1, 0.2, 1], np.array([0.6, 0.8, 0.0])
    light = scenes.rect_light(side=1.1)
    occluders = np.array([ROOF, [[0.2, 1.0, 0], [1, 0.3, 1], [-1, 0.2, 2]]])
    turn = sl.transform.rotate_axis([1.0, 2, -0.5], 0.7)[:3, :3]
    move, size = np.array([3.0, -2, 5]), 37.0

    def moved(v):
        return size * (np.asarray(v) @ turn.T) + move

    turned = RectLight(
        tuple(moved(light.center)), *(tuple(size * turn @ np.array(e)) for e in (light.edge_u, light.edge_v))
    )
    placed = np.stack([moved(occluders[:, 0]), occluders[:, 1] @ turn.T, occluders[:, 2] @ turn.T], 1)
    for n in (None, normals):
        here = sl.shadow.half_plane(points, n, light, occluders)
        there = sl.shadow.half_plane(moved(points), None if n is None else turn @ n, turned, placed)
        np.testing.assert_allclose(there, here, atol=1e-10)
        assert 0.1 < ((here > 0) & (here < 1)).mean()


def test_two_half_planes_leave_what_neither_hides(scenes):
    light = scenes.rect_light(side=0.8)
    x = np.linspace(-1, 1, 201)
    left, right = [[-0.1, 2, 0], [0, 0, 1], [-1, 0, 0]], [[0.1, 2, 0], [0, 0, 1], [1, 0, 0]]
    one, other = (sl.shadow.half_plane(along(x), None, light, o) for o in (left, right))
    # A gap: what the one hides the other does not.
    np.testing.assert_allclose(sl.shadow.half_plane(along(x), None, light, [left, right]), one + other - 1, atol=1e-12)
    # Square to each other: shares multiply.
    across = [[0, 2, 0.1], [1, 0, 0], [0, 0, 1]]
    product = one * sl.shadow.half_plane(along(x), None, light, across)
    np.testing.assert_allclose(sl.shadow.half_plane(along(x), None, light, [left, across]), product, atol=1e-12)
    # The same twice, or one behind the other, hides no more than once.
    behind = [[-0.3, 1.0, 0], [0, 0, 1], [-1, 0, 0]]
    low = sl.shadow.half_plane(along(x), None, light, behind)
    np.testing.assert_allclose(sl.shadow.half_plane(along(x), None, light, [left, left]), one, atol=1e-12)
    np.testing.assert_allclose(
        sl.shadow.half_plane(along(x), None, light, [left, behind]), np.minimum(one, low), atol=1e-12
    )


def test_a_disk_has_the_profile_of_a_chord():
    light = DiskLight((0, 4, 0), (0, -1, 0), 0.4)
    x = np.linspace(-0.6, 0.6, 301)
    c = np.clip(x / 0.4, -1, 1)
    exact = 0.5 + (np.arcsin(c) + c * np.sqrt(1 - c * c)) / np.pi
    # The documented 2e-5 of a polygon of 512 corners.
    np.testing.assert_allclose(sl.shadow.half_plane(along(x), None, light, ROOF), exact, atol=2e-5)


@pytest.mark.parametrize("normal", [None, UP, [0.8, 0.6, 0.0]])
@pytest.mark.parametrize("kind", ["rect", "disk", "triangle"])
def test_rays_tend_to_it(scenes, kind, normal):
    corners = [(-0.5, 4, -0.4), (0.6, 4, -0.3), (-0.1, 4, 0.5)]
    light = {
        "rect": scenes.rect_light(side=0.8),
        "disk": DiskLight((0, 4, 0), (0, -1, 0), 0.4),
        "triangle": PolygonLight(corners),
    }[kind]
    # A half-plane as a rectangle that no ray passes around, and a second one that crosses its edge.
    walls = scenes.join(scenes.quad(2.0, (-9, 0), (-9, 9), float), scenes.quad(1.0, (-9, 9), (0.05, 9), float))
    points = np.random.default_rng(1).uniform(-0.4, 0.4, (500, 3)) * [1, 0, 1]
    exact = sl.shadow.half_plane(points, normal, light, [ROOF, [[0, 1, 0.05], [1, 0, 0], [0, 0, 1]]])
    lit = sl.shadow.ray_traced(sl.accel.BVH(*walls), points, normal, light, 1024)
    # Two edges over 1,024 Sobol' points: an rms of about 1024^(-3/4) each, and its tail.
    assert np.sqrt(np.mean((lit - exact) ** 2)) < 0.006
    assert np.abs(lit - exact).max() < 0.03
    assert 0.2 < ((exact > 0) & (exact < 1)).mean()


def test_pcss_keeps_width_and_profile_beside_it(scenes):
    """Off the light's axis too, and on a slope: where the comparison by similar triangles alone is not enough."""
    wall = scenes.quad(2.0, (-6, -0.4), (-6, 6))
    slope = (np.array([[-3, -1.0, -3], [3, 1.0, -3], [3, 1.0, 3], [-3, -1.0, 3]], np.float32), wall[1])
    light = scenes.rect_light(side=0.8)
    m = sl.shadow.shadow_map(*scenes.join(slope, wall), light, 2048)
    x = np.linspace(-2.5, 0.8, 331)
    points, normal = np.stack([x, x / 3, 0.5 + 0 * x], -1), np.array([-1, 3, 0]) / np.sqrt(10)
    exact = sl.shadow.half_plane(points, None, light, [[-0.4, 2, 0], [0, 0, 1], [-1, 0, 0]])
    lit = sl.shadow.pcss(m, points, normal, blocker_samples=1024, filter_samples=1024, seed=None)
    # Half a texel of the map over a penumbra of 0.8 and more, and what the slope takes the filter off the light.
    assert np.abs(lit - exact).max() < 0.04
    inner, outer = (np.interp([0.1, 0.9], f, x) for f in (lit, exact))
    assert np.ptp(inner) == pytest.approx(np.ptp(outer), rel=0.03)


def test_whole_where_nothing_hides_and_nothing_where_all_is_hidden(scenes):
    light = scenes.rect_light()
    points = along([-5.0, 5.0])
    for n in (None, UP):
        assert sl.shadow.half_plane(points, n, light, ROOF).tolist() == [0, 1]
        assert (sl.shadow.half_plane(points, n, light, np.empty((0, 3, 3))) == 1).all()
    # Behind the light, behind the receiver, and in its own plane a half-plane hides nothing.
    for height in (4.5, -0.5, 0.0):
        assert sl.shadow.half_plane(points, None, light, [[0, height, 0], [0, 0, 1], [-1, 0, 0]]).tolist() == [1, 1]
    # Through the middle of the light: what is on its far side.
    tilted = [[0, 4, 0], [0, 0, 1], [0, -1, 0]]
    assert sl.shadow.half_plane([[3.0, 0, 0]], None, light, tilted) == pytest.approx(0.5)


def test_nan_stays_where_it_is(scenes):
    points, normals = along([0.0, 0, 0, 0]), np.array([UP] * 4, float)
    points[1, 0], normals[2, 1], normals[3] = np.nan, np.inf, [0, -1, 0]
    lit = sl.shadow.half_plane(points, normals, scenes.rect_light(), ROOF)
    assert lit[0] == pytest.approx(0.5) and np.isnan(lit[1:3]).all() and lit[3] == 1


def test_errors_name_the_argument(scenes):
    light = scenes.rect_light()
    with pytest.raises(TypeError, match="light: expected a RectLight"):
        sl.shadow.half_plane([0, 0, 0], None, PointLight((0, 1, 0)), ROOF)
    for wrong in (np.zeros((2, 3)), np.zeros((1, 1, 3, 3))):
        with pytest.raises(ValueError, match="occluders: expected shape"):
            sl.shadow.half_plane([0, 0, 0], None, light, wrong)
    with pytest.raises(ValueError, match="occluder 1 are parallel"):
        sl.shadow.half_plane([0, 0, 0], None, light, [ROOF, [[0, 1, 0], [1, 0, 0], [2, 0, 0]]])
    with pytest.raises(ValueError, match="occluders: expected finite"):
        sl.shadow.half_plane([0, 0, 0], None, light, [[0, np.nan, 0], [1, 0, 0], [0, 1, 0]])
