"""Cascades: where views are cut, nothing shimmers, nothing jumps where two meet, each is a map like any other."""

import numpy as np
import pytest
import shadelab as sl
from shadelab.light import DirectionalLight, PointLight
from shadelab.scene import Camera

SUN = DirectionalLight((0.4, -1.0, 0.3))
UP = [0.0, 1.0, 0.0]


def posts(dtype=np.float32, reach=60, seed=3):
    """A plain with posts on it."""
    rng = np.random.default_rng(seed)
    half = reach
    parts = [
        (np.array([[-half, 0, -half], [half, 0, -half], [half, 0, half], [-half, 0, half]]), [[0, 2, 1], [0, 3, 2]])
    ]
    for x, z in rng.uniform(-0.9 * half, 0.9 * half, (300, 2)):
        post = sl.mesh.box((0.7, 4.0, 0.7))
        parts.append((post.positions + np.array([x, 2.0, z]), post.faces))
    offsets = np.cumsum([0] + [len(p) for p, _ in parts[:-1]])
    positions = np.concatenate([p for p, _ in parts]).astype(dtype)
    faces = np.concatenate([np.asarray(f) + o for (_, f), o in zip(parts, offsets, strict=True)])
    return positions, faces


def ground(n=20_000, dtype=np.float32, reach=50.0, seed=5):
    points = np.random.default_rng(seed).uniform(-reach, reach, (n, 3))
    points[:, 1] = 0
    return points.astype(dtype)


def test_splits_are_those_of_the_paper():
    splits = sl.shadow.cascade_splits
    assert np.allclose(splits(1, 81, 4, method="logarithmic"), [1, 3, 9, 27, 81], rtol=1e-14)
    assert np.allclose(splits(1, 81, 4, method="uniform"), [1, 21, 41, 61, 81])
    for weight in (0.0, 0.3, 1.0):
        mixed = weight * splits(1, 81, 4, method="logarithmic") + (1 - weight) * splits(1, 81, 4, method="uniform")
        assert np.allclose(splits(1, 81, 4, weight=weight), mixed, rtol=1e-14)
    assert splits(1e-300, 1e300, 2, method="logarithmic")[1] == pytest.approx(1.0, rel=1e-12)
    assert splits(2.0, 3.0, 1).tolist() == [2.0, 3.0]
    for wrong, name in (((0, 1), "near"), ((2, 2), "far"), ((1, 2, 0), "count")):
        with pytest.raises(ValueError, match=name):
            splits(*wrong)
    with pytest.raises(ValueError, match="weight"):
        splits(1, 2, weight=1.5)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("stable", [True, False])
def test_each_receiver_finds_its_place(stable, dtype):
    mesh = posts(dtype)
    camera = Camera((0, 4, 0), (0, 3, -10), near=0.5, far=55.0)
    maps = sl.shadow.cascades(*mesh, SUN, camera, 512, stable=stable)
    points = ground(dtype=dtype)
    inside = in_view(points, camera)
    assert inside.sum() > 500
    index = maps.index(points)
    depth = (points - np.array(camera.eye)) @ maps.axis
    assert np.array_equal(index[inside], np.searchsorted(maps.splits, depth[inside], side="right") - 1)
    assert (index[depth >= 55] == -1).all()
    # What the view sees lies within its map, and the border about it.
    for k, m in enumerate(maps.maps):
        mine = points[inside & (index == k)]
        if len(mine):
            x, y = (mine - m.position) @ m.frame[0], (mine - m.position) @ m.frame[1]
            t = 7.9 * m.texel_size()
            assert (x - t > m.window[0]).all() and (x + t < m.window[1]).all()
            assert (y - t > m.window[2]).all() and (y + t < m.window[3]).all()
    # Against rays: edges are off by a texel, which in the far maps is large against posts.
    lit = sl.shadow.hard(maps, points[inside], UP)
    assert lit.dtype == dtype
    exact = sl.shadow.ray_traced(sl.accel.BVH(*mesh), points[inside], np.broadcast_to(UP, (inside.sum(), 3)), SUN)
    assert (exact == 0).mean() > 0.02
    assert np.abs(lit - exact).mean() < 0.03


@pytest.mark.parametrize("look", ["hard", "pcf", "pcss"])
def test_a_cascade_is_the_map_that_it_says(look):
    mesh = posts()
    maps = sl.shadow.cascades(*mesh, SUN, Camera((0, 4, 0), (0, 3, -10), near=0.5, far=55.0), 256, blend=0.0)
    points = ground()
    index = maps.index(points)
    f = getattr(sl.shadow, look)
    knobs = {"light_size": 0.02} if look == "pcss" else {}
    got = f(maps, points, UP, **knobs)
    for k, m in enumerate(maps.maps):
        # Patterns turn by the place in the batch, so the whole batch is asked.
        assert np.array_equal(got[index == k], f(m, points, UP, **knobs)[index == k])
    assert (got[index == -1] == 1).all()


def test_the_next_takes_over_by_and_by():
    mesh = posts()
    camera = Camera((0, 4, 0), (0, 4, -10), near=0.5, far=55.0)
    maps = sl.shadow.cascades(*mesh, SUN, camera, 256, blend=0.25)
    points = ground()
    found = sl.shadow.hard(maps, points, UP, full_output=True)
    each = np.array([sl.shadow.hard(m, points, UP) for m in maps.maps])
    assert np.array_equal(found.map_index, maps.index(points))
    depth, last = -points[:, 2].astype(np.float64), len(maps.maps) - 1
    for k in range(len(maps.maps)):
        at = found.map_index == k
        n, f = maps.splits[k : k + 2]
        share = np.clip(1 - (f - depth[at]) / (0.25 * (f - n)), 0, 1) * (k < last)
        assert np.allclose(found.share[at], share, atol=1e-5)
        mixed = (1 - share) * each[k, at] + share * each[min(k + 1, last), at]
        assert np.allclose(found.lit[at], mixed, atol=1e-5)
    # So nothing jumps where two meet, but for the shadow's own edges.
    assert ((found.share > 0) & (found.lit > 0) & (found.lit < 1)).any()


def in_view(points, camera):
    clip = np.concatenate([points, np.ones((len(points), 1))], -1) @ (camera.projection(16 / 9) @ camera.view()).T
    return (np.abs(clip[:, :3]) <= clip[:, 3:]).all(-1)


def walk():
    """Cameras on a path: small steps, turns, and both."""
    for i in range(12):
        t = 0.037 * i
        eye = (3 * np.sin(t), 4 + 0.2 * t, 2 * t)
        yield Camera(eye, (eye[0] + np.sin(3 * t), eye[1] - 0.1, eye[2] - np.cos(3 * t)), near=0.5, far=55.0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_nothing_shimmers_along_a_path(dtype):
    mesh = posts(dtype)
    points = ground(40_000, dtype)

    def flips(stable):
        before, changed, asked = None, 0, 0
        for camera in walk():
            maps = sl.shadow.cascades(*mesh, SUN, camera, 512, stable=stable, blend=0.0)
            seen = in_view(points, camera)
            lit, index = sl.shadow.hard(maps, points, UP), np.where(seen, maps.index(points), -1)
            if before is not None:
                same = (index == before[1]) & (index >= 0)
                changed += int((lit != before[0])[same].sum())
                asked += int(same.sum())
            before = lit, index
        return changed / asked

    steady = flips(True)
    # In double to the bit; in single a vertex may round to either side of the rasteriser's grid of 1/256 texel.
    assert steady == 0 if dtype == np.float64 else steady < 2e-5
    assert flips(False) > 1e-3


def test_texels_do_not_change_with_the_view():
    mesh = posts()
    sizes = {tuple(m.texel_size() for m in sl.shadow.cascades(*mesh, SUN, camera, 256).maps) for camera in walk()}
    assert len(sizes) == 1
    # Whole multiples of the texel, exactly.
    for m in sl.shadow.cascades(*mesh, SUN, next(iter(walk())), 256).maps:
        assert (m.window / m.texel_size() == np.round(m.window / m.texel_size())).all()


def test_a_snapped_map_follows_its_receivers_by_whole_texels():
    mesh = posts(np.float64)
    points = ground(20_000, np.float64, reach=8.0)
    texels, found = set(), []
    for i in range(6):
        view = points + np.array([0.01 * i, 0, 0.007 * i])
        m = sl.shadow.shadow_map(*mesh, SUN, 512, receivers=view, snap=True)
        texels.add(m.texel_size())
        inner = np.abs(points[:, [0, 2]]).max(-1) < 7.5
        found.append(sl.shadow.hard(m, points[inner], UP))
    assert len(texels) == 1 and all(np.array_equal(found[0], f) for f in found)
    with pytest.raises(ValueError, match="snap: expected directional light"):
        sl.shadow.shadow_map(*mesh, PointLight((0, 9, 0)), 64, snap=True)


def test_ranges_follow_the_mesh_where_the_camera_has_none():
    mesh = posts()
    camera = Camera((0, 4, 0), (0, 4, -10))
    maps = sl.shadow.cascades(*mesh, SUN, camera, 64)
    assert maps.splits[-1] >= 60 and maps.splits[-1] <= 60 * 1.125
    # The mesh begins behind the eye: from a thousandth of the farthest on.
    assert maps.splits[0] == pytest.approx(maps.splits[-1] * 1e-3, rel=0.13)
    away = sl.shadow.cascades(*mesh, SUN, Camera((0, 4, 900), (0, 4, 1000)), 64)
    assert np.isfinite(away.splits).all() and (sl.shadow.hard(away, ground(10), UP) == 1).all()
    empty = sl.shadow.cascades(np.zeros((0, 3)), np.zeros((0, 3), int), SUN, camera, 64)
    assert (sl.shadow.hard(empty, ground(10), UP) == 1).all()


def test_nan_stays_where_it_is_and_threads_change_nothing():
    mesh, camera = posts(), Camera((0, 4, 0), (0, 3, -10), near=0.5, far=20.0)
    maps = sl.shadow.cascades(*mesh, SUN, camera, 128)
    points = ground(2000)
    points[3] = np.nan
    normals = np.broadcast_to(np.float32(UP), points.shape).copy()
    normals[4] = np.nan
    points[4] = [0, 0, -40]
    before, found = sl.threads(), []
    try:
        for n in (1, 3):
            sl.set_threads(n)
            found.append(sl.shadow.pcf(maps, points, normals))
    finally:
        sl.set_threads(before)
    assert np.array_equal(*found, equal_nan=True) and np.flatnonzero(np.isnan(found[0])).tolist() == [3, 4]


def test_errors_name_the_argument():
    p, f = posts()
    given = {"light": SUN, "camera": Camera((0, 4, 0), (0, 4, -10)), "resolution": 64}
    for wrong, kind, name in (
        ({"light": PointLight((0, 9, 0))}, TypeError, "light"),
        ({"camera": None}, TypeError, "camera"),
        ({"border": 32}, ValueError, "border"),
        ({"blend": 1.0}, ValueError, "blend"),
        ({"count": 33}, ValueError, "count"),
        ({"near": 9.0, "far": 3.0}, ValueError, "near"),
        ({"far": 1e300}, ValueError, "far"),
        ({"far": 1e-300}, ValueError, "far"),
        ({"camera": Camera((0, 4, 0), (0, 4, -10), far=1e300)}, ValueError, "far"),
        ({"aspect": 1e300}, ValueError, "aspect"),
        ({"bits": np.zeros(2)}, ValueError, "bits"),
        ({"stable": "yes"}, TypeError, "stable"),
    ):
        with pytest.raises(kind, match=name):
            sl.shadow.cascades(p, f, **given | wrong)
    maps = sl.shadow.cascades(p, f, **given)
    with pytest.raises(ValueError, match=r"radius: .* reach beyond"):
        sl.shadow.pcf(maps, [0, 0, -3.0], UP, radius=9.0)
    with pytest.raises(ValueError, match=r"radius: .* reach beyond"):
        sl.shadow.pcf(maps, [0, 0, -3.0], UP, radius=9.0, units="world")
    with pytest.raises(TypeError, match="full_output"):
        sl.shadow.hard(maps, [0, 0, -3.0], UP, full_output="no")
    with pytest.raises(TypeError, match="receiver_plane"):
        sl.shadow.hard(maps, [0, 0, -3.0], UP, receiver_plane=None)


@pytest.mark.parametrize("stable", [True, False])
@pytest.mark.parametrize("method", ["practical", "uniform", "logarithmic"])
@pytest.mark.parametrize("blend", [0.1, 0.6])
def test_nothing_leaks_where_cascades_cross_over(blend, method, stable):
    # All that is seen of the ground lies in the shadow of a roof as large as it.
    low, roof = sl.mesh.plane(400.0), sl.mesh.plane(400.0)
    positions = np.concatenate([low.positions, roof.positions + np.array([0, 30, 0])])
    faces = np.concatenate([low.faces, roof.faces + len(low.positions)])
    crossed = 0
    for fov in (0.1, 0.3, 0.8, 1.5):
        camera = Camera((0, 3, 90), (0, 0, 40), fov_y=fov)
        origins, directions = camera.rays((160, 90), dtype=np.float64)
        with np.errstate(divide="ignore"):
            t = -origins[..., 1] / directions[..., 1]
        points = (origins + directions * t[..., None])[(t > 0) & (t < 1e4)]
        points = points[np.abs(points[:, [0, 2]]).max(-1) < 150]
        knobs = {"aspect": 160 / 90, "near": 1.0, "far": 150.0, "method": method, "blend": blend, "stable": stable}
        maps = sl.shadow.cascades(positions, faces, DirectionalLight((0, -1, 0)), camera, 256, **knobs)
        points = points[(points - np.array(camera.eye)) @ maps.axis < 150.0]
        found = sl.shadow.hard(maps, points, UP, full_output=True)
        crossed += int((found.share > 0).sum())
        assert not found.lit.any()
    assert crossed > 100
