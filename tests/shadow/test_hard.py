"""Hard shadows: the edge where it belongs, no acne, contact, and what is not in the map."""

import numpy as np
import pytest
import shadelab as sl
import trimesh

UP = [0, 1, 0]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_edge_lies_within_half_a_texel(scenes, dtype):
    mesh = scenes.join(scenes.quad(0.0, (-2, 2), (-2, 2), dtype), scenes.quad(2.0, (-3, 0.1), (-3, 3), dtype))
    m = sl.shadow.shadow_map(*mesh, scenes.rect_light(), 512)
    x = np.linspace(-1, 1, 4001, dtype=dtype)
    lit = sl.shadow.hard(m, np.stack([x, 0 * x, 0.3 + 0 * x], -1), UP)
    assert lit.dtype == dtype and set(np.unique(lit)) == {0, 1}
    # An edge at x = 0.1, half way down, throws its shadow to 0.2.
    edge = x[np.argmax(lit)]
    assert abs(edge - 0.2) <= 0.5 * m.texel_size(4.0) + 1e-3
    assert (np.diff(lit) != 0).sum() == 1


def sample_plane(tilt, n=50_000):
    turn = trimesh.transformations.rotation_matrix(tilt, [0, 0, 1])[:3, :3]
    square = np.array([[-3.0, 0, -3], [3, 0, -3], [3, 0, 3], [-3, 0, 3]]) @ turn.T
    weights = np.random.default_rng(1).uniform(0.001, 0.999, (n, 2))
    points = square[0] + weights[:, :1] * (square[1] - square[0]) + weights[:, 1:] * (square[3] - square[0])
    return square.astype(np.float32), points.astype(np.float32), turn @ UP


@pytest.mark.parametrize("kind", ["rect", "point", "sun"])
@pytest.mark.parametrize("tilt", [0.0, 0.5, 1.0, 1.3, 1.5])
def test_a_lit_plane_has_no_acne_at_any_angle(scenes, kind, tilt):
    square, points, normal = sample_plane(tilt)
    m = sl.shadow.shadow_map(square, [[0, 2, 1], [0, 3, 2]], scenes.lights()[kind], 512)
    classical = {"receiver_plane": False, "slope_bias": 0.52}
    for knobs in ({}, classical):
        assert (sl.shadow.hard(m, points, normal, **knobs) == 1).all()
        assert (sl.shadow.pcf(m, points, normal, radius=1.5, slope_bias=2.0, receiver_plane=False) == 1).all()
    # However wide the filter.
    assert (sl.shadow.pcf(m, points, normal, radius=40) == 1).all()
    assert (sl.shadow.pcss(m, points, normal, light_size=0.2 if kind == "sun" else 1.0) == 1).all()
    # And there would be acne without a bias, or this test would prove nothing.
    if tilt:
        assert (sl.shadow.hard(m, points) == 0).mean() > 0.3


@pytest.mark.parametrize("subdivisions", [2, 4])
@pytest.mark.parametrize("kind", ["rect", "sun"])
def test_a_lit_sphere_has_no_acne(scenes, kind, subdivisions):
    sphere = trimesh.creation.icosphere(subdivisions)
    light = scenes.lights()[kind]
    m = sl.shadow.shadow_map(sphere.vertices.astype(np.float32), sphere.faces, light, 512)
    points, face = trimesh.sample.sample_surface(sphere, 50_000, seed=1)
    normals = sphere.face_normals[face]
    lit = (normals * scenes.towards_light(light, points)).sum(-1) > 0.01
    points, normals = points[lit], normals[lit]
    assert (sl.shadow.hard(m, points, normals) == 1).all()
    assert (sl.shadow.pcf(m, points, normals, radius=4) == 1).all()
    assert (sl.shadow.pcss(m, points, normals, light_size=0.2 if kind == "sun" else 1.0) == 1).all()
    # Interpolated normals disagree with the facets; an offset of two texels takes 99.9 % of the acne away.
    smooth = points / np.linalg.norm(points, axis=-1, keepdims=True)
    assert (1 - sl.shadow.hard(m, points, smooth, normal_offset=2.0)).mean() < 1e-3


def test_contact_shadows_begin_within_a_texel_of_the_wall(scenes):
    wall = np.array([[0.5, 0, -2], [0.5, 0, 2], [0.5, 1, 2], [0.5, 1, -2]]), np.array([[0, 1, 2], [0, 2, 3]])
    mesh = scenes.join(wall, scenes.quad(0.0, (-4, 4), (-4, 4), float))
    m = sl.shadow.shadow_map(*mesh, scenes.rect_light(center=(-2.0, 0.0)), 1024)
    x = np.linspace(0.5, 0.9, 4001)
    lit = sl.shadow.hard(m, np.stack([x, 0 * x, 0 * x], -1), UP)
    gap = x[np.argmax(lit == 0)] - 0.5
    assert gap <= m.texel_size(4.0)
    # The shadow has no holes up to its end: the wall's top, 3 below the light, 2.5 aside, ends it at 1.333.
    assert (lit[np.argmax(lit == 0) :] == 0).all()
    # A constant bias detaches it by what similar triangles say: the wall at the bias' height is the first to block.
    biased = sl.shadow.hard(m, np.stack([x, 0 * x, 0 * x], -1), UP, bias=0.1)
    detached = x[np.argmax(biased == 0)] - 0.5
    assert detached == pytest.approx(0.1 * 2.5 / 3.9, abs=2 * m.texel_size(4.0))


def test_outside_of_the_map_and_behind_the_light_is_lit(scenes):
    m = scenes.analytic_map(sl)
    assert sl.shadow.hard(m, [[-40.0, 0, 0], [0, 0, 70], [-1, 5, 0], [-1, 4, 0]], UP).tolist() == [1, 1, 1, 1]


def test_nan_stays_where_it_is(scenes):
    m = scenes.analytic_map(sl)
    points = np.array([[-1.0, 0, 0]] * 5, np.float32)
    normals = np.array([[0.0, 1, 0]] * 5, np.float32)
    points[1, 2] = normals[3, 0] = np.nan
    points[4] = np.inf
    for f in (sl.shadow.hard, sl.shadow.pcf, lambda *a: sl.shadow.pcss(*a, light_size=0.1)):
        got = f(m, points, normals)
        assert got[[0, 2]].tolist() == [0, 0] and np.isnan(got[[1, 3, 4]]).all()


def test_batches_broadcast_and_out_is_written(scenes):
    m = scenes.analytic_map(sl)
    points = np.random.default_rng(3).uniform(-1, 1, (4, 5, 3)).astype(np.float32) * [1, 0, 1]
    out = np.empty((4, 5), np.float32)
    got = sl.shadow.hard(m, points[::-1], UP, out=out)
    assert got is out and np.array_equal(got, np.where(points[::-1, :, 0] < 0, 0, 1))
    assert sl.shadow.hard(m, np.zeros((0, 3))).shape == (0,)
    assert sl.shadow.hard(m, [1.0, 0, 0]).shape == ()


def test_errors_name_the_argument(scenes):
    m = scenes.analytic_map(sl)
    with pytest.raises(ValueError, match=r"receivers: expected shape \(\.\.\., 3\)"):
        sl.shadow.hard(m, np.zeros((4, 2)))
    with pytest.raises(ValueError, match="cannot broadcast"):
        sl.shadow.hard(m, np.zeros((4, 3)), np.zeros((5, 3)))
    with pytest.raises(ValueError, match="slope_bias"):
        sl.shadow.hard(m, [0, 0, 0], slope_bias=-1)
    with pytest.raises(TypeError, match="shadow_map: expected a ShadowMap"):
        sl.shadow.hard(np.ones((4, 4)), [0, 0, 0])
