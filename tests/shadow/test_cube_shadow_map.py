"""Maps all around a point light: each face is that of a spot light, edges leak nothing, rays agree."""

import numpy as np
import pytest
import shadelab as sl
from shadelab.light import DirectionalLight, PointLight, SphereLight, SpotLight

AXES = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)


def room(dtype=np.float32, half=2.0, ball=0.4):
    """A closed box seen from within, with balls in it: (positions, faces), and points and normals on its walls."""
    outside = sl.mesh.box((2 * half, 2 * half, 2 * half))
    parts = [(outside.positions, outside.faces[:, ::-1])]
    for place in ((1.1, 0.2, 0.3), (-0.9, -0.8, 0.2), (0.1, 1.0, 1.1), (0.3, -1.2, -0.7), (-0.5, 0.8, -1.1)):
        sphere = sl.mesh.icosphere(3, ball)
        parts.append((sphere.positions + np.array(place), sphere.faces))
    offsets = np.cumsum([0] + [len(p) for p, _ in parts[:-1]])
    positions = np.concatenate([p for p, _ in parts]).astype(dtype)
    return positions, np.concatenate([f + o for (_, f), o in zip(parts, offsets, strict=True)])


def walls(n=20_000, half=2.0, dtype=np.float32):
    rng = np.random.default_rng(4)
    k = rng.integers(0, 6, n)
    points = rng.uniform(-half, half, (n, 3))
    points[np.arange(n), k // 2] = half * AXES[k].sum(-1)
    return points.astype(dtype), -AXES[k].astype(dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_six_spot_lights_see_the_same(dtype):
    mesh = room(dtype)
    light = PointLight((0.1, -0.1, 0.05))
    cube = sl.shadow.cube_shadow_map(*mesh, light, 256, border=8)
    points, normals = walls(dtype=dtype)
    index = cube.index(points)
    away = points - np.array(light.position)
    assert np.array_equal(index, 2 * np.abs(away).argmax(-1) + (away[np.arange(len(away)), index // 2] < 0))
    lit = sl.shadow.hard(cube, points, normals)
    assert lit.dtype == dtype
    for k, axis in enumerate(AXES):
        # The cone about the cube's face, of which the map is the square.
        half = float(cube.maps[k].window[1])
        spot = SpotLight(light.position, tuple(axis), outer_angle=float(np.arctan(half)))
        alone = sl.shadow.shadow_map(*mesh, spot, 256)
        at = index == k
        # Windows differ by two texels of the fit: edges of shadows may fall to either side.
        same = sl.shadow.hard(alone, points[at], normals[at]) == lit[at]
        assert same.mean() > 0.985


def test_agrees_with_rays_and_leaks_nothing_at_edges():
    mesh = room()
    light = PointLight((0.1, -0.1, 0.05))
    cube = sl.shadow.cube_shadow_map(*mesh, light, 512)
    points, normals = walls(40_000)
    bvh = sl.accel.BVH(*mesh)
    exact = sl.shadow.ray_traced(bvh, points, normals, light)
    lit = sl.shadow.hard(cube, points, normals)
    assert 0.1 < (exact == 0).mean() < 0.9
    assert (lit != exact).mean() < 0.01
    # Within two texels of an edge of the cube no more is wrong than elsewhere.
    away = np.sort(np.abs(points - np.array(light.position)), -1)
    seam = away[:, 1] / away[:, 2] > 1 - 4 / 256
    assert seam.sum() > 200 and (lit != exact)[seam].mean() < 0.02


@pytest.mark.parametrize("look", ["pcf", "pcss"])
def test_nothing_dark_and_nothing_leaks_across_the_edges_of_an_empty_room(look):
    """Walls see the light; a box within hides it everywhere behind. Seen from aside, seams run over the walls."""
    at = (0.45, 0.3, -0.2)
    light = SphereLight(at, 0.1) if look == "pcss" else PointLight(at)
    knobs = {"radius": 8.0} if look == "pcf" else {}
    inner, outer = sl.mesh.box((2.0, 2, 2)), sl.mesh.box((4.0, 4, 4))
    positions = np.concatenate([inner.positions, outer.positions])
    faces = np.concatenate([inner.faces, outer.faces + len(inner.positions)])
    cube = sl.shadow.cube_shadow_map(positions, faces, light, 256)
    look = getattr(sl.shadow, look)
    points, normals = walls()
    assert (look(cube, points, normals, **knobs) == 0).all()
    points, normals = walls(half=1.0)
    # Where walls meet, the one does hide the other from a filter that follows its plane: that is no seam.
    inner = np.sort(np.abs(points), -1)[:, 1] < 0.7
    ends = np.sort(np.abs(points[inner] - np.array(at)), -1)
    assert (ends[:, 1] / ends[:, 2] > 0.97).sum() > 200
    assert (look(cube, points[inner], normals[inner], **knobs) == 1).all()


def test_filters_wider_than_the_border_are_refused():
    cube = sl.shadow.cube_shadow_map(*room(), PointLight((0, 0, 0)), 64, border=3)
    assert cube.border == pytest.approx(3, rel=1e-5)
    sl.shadow.pcf(cube, [1.0, 0, 0], radius=2.9)
    with pytest.raises(ValueError, match="radius: 4 texels reach beyond"):
        sl.shadow.pcf(cube, [1.0, 0, 0], radius=4)


def test_a_sphere_widens_faces_by_what_is_searched():
    narrow = sl.shadow.cube_shadow_map(*room(), PointLight((0, 0, 0)), 64, border=2)
    wide = sl.shadow.cube_shadow_map(*room(), SphereLight((0, 0, 0), 0.2), 64, border=2)
    assert wide.border > 2 * narrow.border and wide.light_size[0] == pytest.approx(0.2 * np.sqrt(np.pi))


def test_threads_and_nan():
    cube = sl.shadow.cube_shadow_map(*room(), PointLight((0, 0, 0)), 64)
    points, normals = walls(3000)
    points[7] = np.nan
    before, found = sl.threads(), []
    try:
        for n in (1, 3):
            sl.set_threads(n)
            found.append(sl.shadow.pcf(cube, points, normals, radius=2.0))
    finally:
        sl.set_threads(before)
    assert np.array_equal(*found, equal_nan=True) and np.flatnonzero(np.isnan(found[0])).tolist() == [7]
    empty = sl.shadow.cube_shadow_map(np.zeros((0, 3)), np.zeros((0, 3), int), PointLight((0, 0, 0)), 32)
    assert (sl.shadow.hard(empty, points[:5], normals[:5]) == 1).all()


def test_errors_name_the_argument():
    p, f = room()
    for wrong, kind, name in (
        ({"light": DirectionalLight((0, -1, 0))}, TypeError, "light"),
        ({"resolution": 0}, ValueError, "resolution"),
        ({"border": 32}, ValueError, "border"),
        ({"bits": 12}, ValueError, "bits"),
        ({"surface": "third"}, ValueError, "surface"),
    ):
        with pytest.raises(kind, match=name):
            sl.shadow.cube_shadow_map(p, f, **{"light": PointLight((0, 0, 0)), "resolution": 64} | wrong)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_seams_do_not_leak_without_a_border(dtype):
    """A light inside a closed box inside a room: receivers where two faces meet round to either side."""
    walls_, shell = sl.mesh.box((4.0, 4, 4)), sl.mesh.box((0.5, 0.5, 0.5))
    place = np.array([0.1, 0.2, 0.3])
    p = np.concatenate([walls_.positions, shell.positions + place]).astype(dtype)
    cube = sl.shadow.cube_shadow_map(
        p, np.concatenate([walls_.faces, shell.faces + len(walls_.positions)]), PointLight(tuple(place)), 64, border=0
    )
    rng = np.random.default_rng(3)
    away = rng.uniform(-1.5, 1.5, (20_000, 3))
    away[:, 0] = np.abs(away[:, 1]) * rng.choice([-1, 1], 20_000)
    # Within the inner box it is light.
    away = away[np.abs(away).max(-1) > 0.3]
    assert sl.shadow.hard(cube, (place + away).astype(dtype)).max() == 0.0
