"""Lights of some size as rays meet them, few or many: what a tree of them tells is what asking each one tells."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import scene
from shadelab.light import PointLight, RectLight, SphereLight

COUNTS = (1, 4, 5, 8, 1000)
UP = np.array([0.0, 1, 0])
NOWHERE = sl.accel.BVH([[0.0, 90, 0], [1e-3, 90, 0], [0, 90, 1e-3]], [[0, 1, 2]])


def rectangles(count, colors=None, two_sided=True):
    """Of all directions in the box from (-1, 1, -1) to (1, 2, 1), that cover about the same part of it."""
    rng = np.random.default_rng(count)
    side = 1.2 / np.sqrt(count)
    lights = []
    for k in range(count):
        u, v = np.linalg.qr(rng.normal(size=(3, 2)))[0].T * side
        at = rng.uniform((-1, 1, -1), (1, 2, 1))
        color = (0.0,) * 3 if colors is None else colors[k]
        lights.append(RectLight(tuple(at), tuple(u), tuple(v), tuple(color), two_sided=two_sided))
    return lights


def met(light, origins, directions):
    """How far along rays a rectangle is met from the side that shines, by hand; and how far from its border."""
    c, u, v, n = (np.asarray(x) for x in (light.center, light.edge_u, light.edge_v, light.normal))
    with np.errstate(all="ignore"):
        t = (c - origins) @ n / (directions @ n)
        at = origins + directions * t[..., None] - c
        inside = np.minimum(0.5 - np.abs(at @ u / (u @ u)), 0.5 - np.abs(at @ v / (v @ v)))
    faces = (directions @ n < 0) | light.two_sided
    return np.where(faces & (t > 0) & (inside > 0), t, np.inf), np.abs(inside)


@pytest.mark.parametrize("two_sided", [True, False])
@pytest.mark.parametrize("count", COUNTS)
def test_lights_stop_a_beam_where_each_by_itself_would(count, two_sided):
    rng = np.random.default_rng(7)
    points = rng.uniform((-2, 0, -2), (2, 0, 2), (2000, 3)) * [1, 0, 1]
    lamp = np.array([0.2, 3.0, -0.1])
    black = rectangles(count, two_sided=two_sided)
    arguments = points, UP, [0.5] * 3, 0.0, 1.0, 0.0
    lights = [*black, PointLight(tuple(lamp), (9, 8, 7))]
    both = sl.pathtrace.direct_light(NOWHERE, lights, *arguments, wo=UP, samples=1)
    free = sl.pathtrace.direct_light(NOWHERE, PointLight(tuple(lamp), (9, 8, 7)), *arguments, wo=UP).radiance
    way = lamp - points
    distance = np.linalg.norm(way, axis=-1)
    way /= distance[:, None]
    hidden, near = np.zeros(len(points), bool), np.zeros(len(points), bool)
    for light in black:
        t, border = met(light, points, way)
        hidden |= t < distance
        near |= border < 1e-9
    assert not near.any() and 0.01 < hidden.mean() < 0.9
    assert np.array_equal(both.radiance, np.where(hidden[:, None], 0.0, free))


def quads(lights):
    """Meshes of the same shapes that emit the same."""
    things = []
    for light in lights:
        glow = scene.Material((0, 0, 0), emission=light.radiance, specular=0.0)
        things.append(scene.Instance(sl.mesh.Mesh(light.corners, [[0, 1, 2], [0, 2, 3]]), None, glow))
    return things


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("count", COUNTS)
def test_rays_meet_lights_as_they_meet_meshes_of_their_shape(count, dtype):
    """The same random directions find the same light, but where a border is rounded."""
    lights = rectangles(count, np.random.default_rng(1).uniform(0.1, 3, (count, 3)))
    floor = scene.Instance(sl.mesh.plane((6, 6)), None, scene.Material((0.6,) * 3, specular=0.0))
    camera = scene.Camera((0, 0.8, 5), (0, 0.8, 0), fov_y=0.8)

    def look(things, lights):
        options = {"max_depth": 1, "strategy": "bsdf", "light_selection": "power", "dtype": dtype}
        return sl.pathtrace.path_trace(scene.Scene(things, lights, camera), (48, 48), 8, **options).radiance

    with_lights, with_meshes = look([floor], lights), look([floor, *quads(lights)], ())
    differ = ~np.isclose(with_lights, with_meshes, rtol=1e-4 if dtype == np.float32 else 1e-10).all(-1)
    # 18,000 and 36,000 rays; at most a few graze a border within rounding.
    assert differ.sum() <= (6 if dtype == np.float32 else 0)
    assert with_lights.mean() > 0.05


@pytest.mark.parametrize("count", COUNTS)
def test_strategies_agree_among_many_lights_that_hide_each_other(count):
    lights = rectangles(count, np.random.default_rng(2).uniform(0.5, 3, (count, 3)))
    floor = scene.Instance(sl.mesh.plane((6, 6)), None, scene.Material((0.6,) * 3, specular=0.0))
    camera = scene.Camera((0, 0.8, 5), (0, 0.3, 0), fov_y=0.6)
    world = scene.Scene([floor], lights, camera)
    found = [
        sl.pathtrace.path_trace(world, (16, 16), samples, 2, strategy=s, seed=k)
        for k, (s, samples) in enumerate((("bsdf", 2048), ("light", 512), ("mis", 512)))
    ]
    for one in found[1:]:
        off = one.radiance.astype(float).sum() - found[0].radiance.astype(float).sum()
        assert abs(off) < 4 * np.sqrt(float(one.variance.sum()) + float(found[0].variance.sum()))


@pytest.mark.parametrize("shape", ["rectangle", "sphere"])
def test_many_lights_in_one_place_shine_as_one(shape):
    """Enough of them for a tree, among others elsewhere."""
    if shape == "rectangle":
        light = RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1), (5, 5, 5))
    else:
        light = SphereLight((0, 2, 0), 0.5, (5, 5, 5))
    # These face away, to the sky.
    away = [RectLight((x, 3, z), (0, 0, 0.1), (0.1, 0, 0), (9, 9, 9)) for x in (-1, 0, 1) for z in (-1, 0, 1)]
    assert away[0].normal == (0, 1, 0)
    points = np.array([[0.3, 0, 0.1], [1.5, 0, 1]])

    def lit(*lights):
        got = sl.pathtrace.direct_light(NOWHERE, lights, points, UP, [0.6] * 3, 0, 1, 0.0, wo=UP, samples=1024)
        return got.radiance[:, 0]

    alone = lit(light)
    # The first stops the others: one is seen, whichever is asked.
    np.testing.assert_allclose(lit(*away[:4], *[light] * 8, *away[4:]), alone, rtol=0.01)
