"""Maps of moments of cascades and cubes: every receiver finds what its own map says, and hard shadows in the limit."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import mesh
from shadelab.light import DirectionalLight, PointLight, SphereLight
from shadelab.scene import Camera

S = sl.shadow
KINDS = ("variance", "exponential_variance", "moment")
FILTERS = ("none", "gaussian", "mip", "summed_area")


def outdoors():
    """Posts along a road, under the sun, and points on the ground in view."""
    ground, post = mesh.plane((120.0, 120.0)), mesh.box((0.6, 3.0, 0.6))
    bodies = [(ground.positions, ground.faces)]
    bodies += [(post.positions + np.array([1.5, 1.5, -z]), post.faces) for z in (2.0, 5.0, 9.0, 16.0, 30.0)]
    starts = np.cumsum([0] + [len(p) for p, _ in bodies[:-1]])
    positions = np.concatenate([p for p, _ in bodies])
    faces = np.concatenate([f + k for (_, f), k in zip(bodies, starts, strict=True)])
    camera = Camera((0, 2, 2), (0, 0.5, -8), near=1.0, far=40.0)
    maps = S.cascades(positions, faces, DirectionalLight((0.5, -1, 0.2)), camera, 256, count=3)
    rng = np.random.default_rng(1)
    return maps, np.stack([rng.uniform(-2, 4, 4000), np.zeros(4000), rng.uniform(-36, 0, 4000)], -1)


def indoors(light=PointLight((0.1, 0.2, 0.3))):  # noqa: B008 (frozen)
    """A room about a light, with a box in it, and points on its walls."""
    room, inner = mesh.box((4.0, 4, 4)), mesh.box((0.6, 0.6, 0.6))
    positions = np.concatenate([room.positions, inner.positions + np.array([1.0, 0.9, 0.2])])
    faces = np.concatenate([room.faces, inner.faces + len(room.positions)])
    maps = S.cube_shadow_map(positions, faces, light, 256)
    away = np.random.default_rng(2).normal(size=(4000, 3))
    return maps, 2.0 * away / np.abs(away).max(-1, keepdims=True)


@pytest.fixture(scope="module", params=["cascades", "cube"])
def scene(request):
    return outdoors() if request.param == "cascades" else indoors()


def normals_of(points):
    """Up on the ground, inwards on the walls of the room."""
    if not points[:, 1].any():
        return np.broadcast_to([0.0, 1, 0], points.shape)
    walls = np.abs(points) == np.abs(points).max(-1, keepdims=True)
    return -np.sign(points) * walls / np.linalg.norm(walls, axis=-1, keepdims=True)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("filter", FILTERS)
def test_receivers_find_what_their_own_map_says(scene, kind, filter):
    maps, points = scene
    normals = normals_of(points)
    moments = S.moment_map(maps, kind, filter=filter)
    assert (moments.kind, moments.filter, len(moments.maps)) == (kind, filter, len(maps.maps))
    assert moments.bytes == sum(m.bytes for m in moments.maps)
    lookup = getattr(S, kind)
    found = lookup(moments, points, normals, full_output=True)
    index, which = maps.index(points), maps._chosen(points)
    blended = np.zeros(len(points), bool) if which[1] is None else which[1] != 255
    for i, own in enumerate(moments.maps):
        mine = index == i
        alone = lookup(own, points[mine], normals[mine], full_output=True)
        assert np.array_equal(found.moments[mine], alone.moments, equal_nan=True)
        assert np.array_equal(found.lit[mine & ~blended], alone.lit[~blended[mine]])
    for k in np.flatnonzero(blended)[:20]:
        pair = [lookup(moments.maps[i], points[k], normals[k]) for i in (which[0][k], which[1][k])]
        assert min(pair) - 1e-6 <= found.lit[k] <= max(pair) + 1e-6
    assert (found.lit[index < 0] == 1).all()


@pytest.mark.parametrize("kind", KINDS)
def test_without_a_filter_shadows_are_hard(scene, kind):
    """Away from edges, where all texels about a receiver agree."""
    maps, points = scene
    normals = normals_of(points)
    around = S.pcf(maps, points, normals, samples=25, kernel="grid", radius=3.0, seed=None)
    clear = (around == 0) | (around == 1)
    moments = S.moment_map(maps, kind, filter="none")
    found = getattr(S, kind)(moments, points, normals)
    # Slopes within a texel leave some variance, which bounds turn into a little light and shade.
    assert clear.mean() > 0.8 and np.abs(found - around)[clear].max() < 0.05


def test_soft_shadows_of_sets_are_those_of_their_maps():
    maps, points = indoors(SphereLight((0.1, 0.2, 0.3), 0.15))
    normals = normals_of(points)
    moments = S.moment_map(maps, filter="summed_area", reduce=2)
    found = S.variance_soft(moments, points, normals, full_output=True)
    index = maps.index(points)
    for i, own in enumerate(moments.maps):
        alone = S.variance_soft(own, points[index == i], normals[index == i], full_output=True)
        for a, b in zip(found, alone, strict=True):
            assert np.array_equal(a[index == i], b, equal_nan=True)
    assert found.lit.min() < 0.05 and found.lit.max() == 1


def test_faces_of_a_cube_meet_in_moments_too():
    """Across an edge of the cube the shadow of a box goes on: no jump beyond that of neighbouring points."""
    maps, _ = indoors()
    moments = S.moment_map(maps, filter="gaussian")
    # On the ceiling, 1.8 above and beside the light: the edge between +x and +y.
    t = np.linspace(-1.4, 1.9, 400)
    one, two = (np.stack([np.full_like(t, 1.9 + gap), np.full_like(t, 2.0), t], -1) for gap in (-1e-4, 1e-4))
    assert (maps.index(one) != maps.index(two)).all()
    a, b = (S.moment(moments, p, [0, -1, 0]) for p in (one, two))
    # Texels of the two faces meet at an angle: the shadow's edge may shift by one.
    assert a.min() < 0.1 and a.max() > 0.9 and np.abs(a - b).max() < 0.2 and np.abs(a - b).mean() < 0.01


def test_what_sets_refuse():
    maps, points = outdoors()
    with pytest.raises(ValueError, match="radius"):
        S.moment(S.moment_map(maps, filter="summed_area"), points, radius=9.0)
    with pytest.raises(ValueError, match="radius"):
        S.moment(S.moment_map(maps, sigma=6.0), points)
    with pytest.raises(TypeError, match="shadow_map"):
        S.moment_map(maps.maps)
    points[0] = np.nan
    assert np.isnan(S.moment(S.moment_map(maps), points)[0])
