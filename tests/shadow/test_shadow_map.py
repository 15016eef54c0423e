"""Shadow maps: depth equals rays through the texels' centres, the window holds the scene, conventions hold."""

import numpy as np
import pytest
import shadelab as sl
import trimesh

KINDS = ("rect", "point", "sun")


def texel_rays(m):
    """Origins and directions (of unit depth) through the texels' centres."""
    height, width = m.depth.shape
    left, right, bottom, top = m.window
    x = left + (np.arange(width) + 0.5) / width * (right - left)
    y = top - (np.arange(height) + 0.5) / height * (top - bottom)
    x, y = np.meshgrid(x, y)
    aside = x[..., None] * m.frame[0] + y[..., None] * m.frame[1]
    if m.projection == "perspective":
        return np.broadcast_to(m.position, aside.shape), aside + m.frame[2]
    return m.position + aside, np.broadcast_to(m.frame[2], aside.shape)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tilt", [0.0, 1.0, 1.4])
def test_depth_of_a_plane_is_that_of_its_rays(scenes, kind, tilt, dtype):
    turn = trimesh.transformations.rotation_matrix(tilt, [0, 0, 1])[:3, :3]
    positions, faces = scenes.quad(0.0, (-2, 2), (-2, 2), np.float64)
    positions = (positions @ turn.T).astype(dtype)
    m = sl.shadow.shadow_map(positions, faces, scenes.lights()[kind], 64)
    assert m.depth.dtype == dtype
    origins, directions = texel_rays(m)
    normal = turn @ [0, 1, 0]
    expected = -(origins @ normal) / (directions @ normal)
    drawn = np.isfinite(m.depth)
    assert drawn.sum() > 64
    # Corners rounded to the dtype move the plane by ulps, which a tilt of 1.4 magnifies by 1 / cos = 6.
    assert np.allclose(m.depth[drawn], expected[drawn], rtol=100 * np.finfo(dtype).eps, atol=0)
    assert m.near == m.depth.min() and m.far == m.depth[drawn].max()


@pytest.mark.parametrize("kind", KINDS)
def test_depth_agrees_with_traced_rays(scenes, kind):
    sphere = trimesh.creation.icosphere(3, 0.7)
    mesh = scenes.join(
        (sphere.vertices + np.array([0, 1, 0]), np.asarray(sphere.faces)), scenes.quad(0.0, (-2, 2), (-2, 2), float)
    )
    m = sl.shadow.shadow_map(*mesh, scenes.lights()[kind], 128)
    origins, directions = texel_rays(m)
    hit = sl.accel.BVH(*mesh).closest_hit(origins, directions)
    both = np.isfinite(hit.t) & np.isfinite(m.depth)
    # Silhouettes differ by the rasteriser's grid of 1/256 texel: a few texels of the outline.
    assert (np.isfinite(hit.t) != np.isfinite(m.depth)).mean() < 2e-3
    assert (np.abs(hit.t - m.depth)[both] > 1e-9).mean() < 2e-3


@pytest.mark.parametrize("kind", KINDS)
def test_matrix_brings_the_scene_into_clip_space(scenes, kind):
    positions, faces = scenes.join(scenes.quad(0.0, (-2, 2), (-1, 1), float), scenes.quad(1.0, (0, 1), (0, 1), float))
    m = sl.shadow.shadow_map(positions, faces, scenes.lights()[kind], 256)
    clip = np.concatenate([positions, np.ones((len(positions), 1))], -1) @ m.matrix.T
    ndc = clip[:, :3] / clip[:, 3:]
    # The window lies two texels outside of everything.
    assert np.abs(ndc[:, :2]).max() == pytest.approx(1 - 4 / 260, abs=1e-6)
    # Near and far are those of texel centres, half a texel within the corners.
    assert np.abs(ndc[:, 2]).max() < 1.01


def test_fits_to_receivers(scenes):
    positions, faces = scenes.join(scenes.quad(0.0, (-9, 9), (-9, 9)), scenes.quad(1.0, (-0.1, 0.1), (-0.1, 0.1)))
    light = scenes.rect_light(side=0.5)
    receivers = np.array([[-0.2, 0, -0.2], [0.2, 0, 0.2]])
    wide = sl.shadow.shadow_map(positions, faces, light, 64)
    close = sl.shadow.shadow_map(positions, faces, light, 64, receivers=receivers)
    assert close.texel_size() < wide.texel_size() / 10
    # The reach of the blocker search stays inside: 0.05 at the receivers, and half the light by (1/3 - 1/4).
    assert close.window[1] >= 0.05 + 0.25 * (1 / 3 - 1 / 4)
    found = sl.shadow.pcss(close, receivers, [0, 1, 0], full_output=True)
    assert (found.search_radius * close.texel_size() <= 0.25 * (1 / 3 - 1 / 4) + 1e-6).all()


def test_texels_at_16k_and_a_map_of_one_texel(scenes):
    m = sl.shadow.shadow_map(*scenes.quad(0.0, (-1, 1), (-1, 1)), scenes.rect_light(), (16384, 1))
    assert m.depth.shape == (1, 16384) and np.allclose(m.depth[np.isfinite(m.depth)], 4, rtol=1e-6)
    m = sl.shadow.shadow_map(*scenes.quad(0.0, (-1, 1), (-1, 1)), scenes.rect_light(), 1)
    assert m.depth.tolist() == [[4.0]]


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_casts_from_an_empty_mesh_or_from_behind(scenes, kind):
    light = scenes.lights()[kind]
    empty = sl.shadow.shadow_map(np.zeros((0, 3), np.float32), np.zeros((0, 3), int), light, 8)
    assert np.isinf(empty.depth).all()
    assert sl.shadow.hard(empty, [0, 0, 0], [0, 1, 0]) == 1
    if kind == "rect":
        behind = sl.shadow.shadow_map(*scenes.quad(9.0, (-1, 1), (-1, 1)), light, 8)
        assert np.isinf(behind.depth).all()


def test_a_caster_through_the_lights_plane_is_clipped_not_lost(scenes):
    wall = np.array([[0.5, -1, -1], [0.5, 6, -1], [0.5, 6, 1], [0.5, -1, 1]])
    m = sl.shadow.shadow_map(wall, [[0, 1, 2], [0, 2, 3]], scenes.rect_light(), 512)
    # Behind the wall as seen from the light, at a height that the part before the light's plane covers.
    assert sl.shadow.hard(m, [[1.0, 2.0, 0], [-1.0, 2.0, 0]], bias=1e-3).tolist() == [0, 1]


def test_threads_change_nothing(scenes):
    sphere = trimesh.creation.icosphere(4)
    before, maps = sl.threads(), []
    try:
        for n in (1, 2, 5):
            sl.set_threads(n)
            maps.append(sl.shadow.shadow_map(sphere.vertices, sphere.faces, scenes.lights()["point"], 256))
    finally:
        sl.set_threads(before)
    assert all(np.array_equal(maps[0].depth, m.depth) for m in maps)


def test_errors_name_the_argument(scenes):
    p, f = scenes.quad(0.0, (-1, 1), (-1, 1))
    light = scenes.rect_light()
    with pytest.raises(ValueError, match="faces: index 7"):
        sl.shadow.shadow_map(p, [[0, 1, 7]], light)
    with pytest.raises(ValueError, match="resolution"):
        sl.shadow.shadow_map(p, f, light, 0)
    with pytest.raises(TypeError, match="light: expected a light that a map can look from"):
        sl.shadow.shadow_map(p, f, 3)
    with pytest.raises(ValueError, match="resolution: expected a number or"):
        sl.shadow.shadow_map(p, f, light, (1, 2, 3))
    with pytest.raises(ValueError, match="surface"):
        sl.shadow.shadow_map(p, f, light, surface="back")
    with pytest.raises(ValueError, match="bits: expected None, 16, 24 or 32"):
        sl.shadow.shadow_map(p, f, light, bits=8)
    with pytest.raises(TypeError, match="snap"):
        sl.shadow.shadow_map(p, f, light, snap="yes")
    with pytest.raises(ValueError, match="cull"):
        sl.shadow.shadow_map(p, f, light, cull="both")
    with pytest.raises(ValueError, match="window: expected left < right"):
        sl.shadow.ShadowMap(np.ones((2, 2)), "perspective", [0, 4, 0], np.diag([1, 1, -1]), [1, 1, -1, 1], 1, 2)
    with pytest.raises(ValueError, match="depth: expected shape"):
        sl.shadow.ShadowMap(np.ones(4), "perspective", [0, 4, 0], np.diag([1, 1, -1]), [-1, 1, -1, 1], 1, 2)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.filterwarnings("error")
def test_what_is_not_finite(scenes, kind):
    p, f = scenes.quad(0.0, (-1, 1), (-1, 1))
    light = scenes.lights()[kind]
    for bad in (np.nan, np.inf):
        broken = np.array(p)
        broken[0, 1] = bad
        with pytest.raises(ValueError, match="positions: vertex 0 is not finite"):
            sl.shadow.shadow_map(broken, f, light, 8)
        some = sl.shadow.shadow_map(p, f, light, 8, receivers=[[bad, 0, 0], [0.1, 0, 0.1], [0.5, -1, 0.4]])
        alone = sl.shadow.shadow_map(p, f, light, 8, receivers=[[0.1, 0, 0.1], [0.5, -1, 0.4]])
        assert np.array_equal(some.depth, alone.depth)
        with pytest.raises(ValueError, match="receivers: expected a finite point, got none among 1"):
            sl.shadow.shadow_map(p, f, light, 8, receivers=[[bad, 0, 0]])
        none = sl.shadow.shadow_map(p, f, light, 8, receivers=np.zeros((0, 3)))
        assert np.array_equal(none.depth, sl.shadow.shadow_map(p, f, light, 8).depth)


def test_maps_that_are_none_are_refused():
    def made(depth=((1.0, np.inf),), kind="perspective", frame=((1, 0, 0), (0, 1, 0), (0, 0, -1)), near=1.0, far=2.0):
        return sl.shadow.ShadowMap(depth, kind, [0, 4, 0], frame, [-1, 1, -1, 1], near, far)

    made(), made(near=0.0, far=0.0), made(kind="orthographic", near=-1.0)
    for wrong, name in (
        ({"depth": [[1.0, np.nan]]}, "depth"),
        ({"frame": 2 * np.eye(3)}, "frame"),
        ({"frame": [[1, 0, 0], [1, 0, 0], [0, 0, 1]]}, "frame"),
        ({"near": -1.0}, "near"),
        ({"near": 3.0}, "far"),
    ):
        with pytest.raises(ValueError, match=name):
            made(**wrong)


@pytest.mark.parametrize("kind", ["sun", "point"])
def test_a_map_for_receivers_reaches_as_far_as_penumbrae_that_are_asked_for(kind):
    """Half of a broad light is hidden at the foot of a wall's shadow, by what stands far aside of the receivers."""
    p = [[-50, 0, -50], [50, 0, -50], [50, 0, 50], [-50, 0, 50], [-50, 20, -50], [0, 20, -50], [0, 20, 50]]
    mesh = np.array([*p, [-50, 20, 50]], float), [[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6]]
    light, wide = {
        "sun": (sl.light.DirectionalLight((0, -1, 0)), 0.2),
        "point": (sl.light.PointLight((0, 40, 0)), 4.0),
    }[kind]
    x = np.linspace(0.05, 2, 40)
    points = np.concatenate([np.stack([x, 0 * x, z + 0 * x], -1) for z in (0.0, 2.0)])

    def lit(m):
        return sl.shadow.pcss(m, points, [0, 1, 0], light_size=wide, blocker_samples=256, filter_samples=256)

    whole = lit(sl.shadow.shadow_map(*mesh, light, 2048))
    assert 0.4 < whole[0] < 0.6
    fitted = sl.shadow.shadow_map(*mesh, light, 2048, receivers=points, light_size=wide)
    # Sixteen samples a side and texels of either map.
    assert np.abs(lit(fitted) - whole).max() < 0.08
    with pytest.raises(ValueError, match="light_size"):
        lit(sl.shadow.shadow_map(*mesh, light, 2048, receivers=points))
    with pytest.raises(ValueError, match="light_size"):
        sl.shadow.shadow_map(*mesh, light, 64, receivers=points, light_size=-1.0)


def test_mirrored_frames_negative_depths_and_biases_are_refused():
    frame = np.array([[1.0, 0, 0], [0, 0, -1], [0, -1, 0]])
    window = [-1, 1, -1, 1]
    m = sl.shadow.ShadowMap(np.ones((4, 4)), "perspective", [0, 1, 0], frame, window, 1.0, 1.0)
    with pytest.raises(ValueError, match="frame"):
        sl.shadow.ShadowMap(np.ones((4, 4)), "perspective", [0, 1, 0], -frame, window, 1.0, 1.0)
    with pytest.raises(ValueError, match="depth"):
        sl.shadow.ShadowMap(-np.ones((4, 4)), "perspective", [0, 1, 0], frame, window, 1.0, 1.0)
    with pytest.raises(ValueError, match="bias"):
        sl.shadow.hard(m, [[0.0, 0, 0]], bias=-1.0)


def test_a_polygons_map_stands_at_its_centroid():
    """Corners along an edge move nothing."""
    square = [[-1.0, 4, -1], [-1, 4, 1], [1, 4, 1], [1, 4, -1]]
    edge = np.linspace([-1.0, 4, -1], [-1, 4, 1], 61)[:-1].tolist()
    mesh = [[-5.0, 0, -5], [5, 0, -5], [5, 0, 5]], [[0, 2, 1]]
    for corners in (square, edge + square[1:], square[::-1]):
        m = sl.shadow.shadow_map(*mesh, sl.light.PolygonLight(corners), 8)
        assert np.abs(m.position - [0, 4, 0]).max() < 1e-5
