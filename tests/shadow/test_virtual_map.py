"""Virtual maps: equal to the whole map where their pages are, and only there."""

import numpy as np
import pytest
import shadelab as sl
import trimesh
from shadelab.light import DirectionalLight, PointLight, RectLight

UP = [0.0, 1.0, 0.0]
LIGHTS = {
    "sun": DirectionalLight((0.3, -1.0, 0.2)),
    "point": PointLight((0.2, 6.0, 0.1)),
    "rect": RectLight((0, 6, 0), (1, 0, 0), (0, 0, 1)),
}


def bumps(dtype=np.float32, half=4.0):
    rng = np.random.default_rng(2)
    parts = [
        (np.array([[-half, 0, -half], [half, 0, -half], [half, 0, half], [-half, 0, half]]), [[0, 2, 1], [0, 3, 2]])
    ]
    for x, z in rng.uniform(-0.8 * half, 0.8 * half, (30, 2)):
        ball = trimesh.creation.icosphere(2, 0.2)
        parts.append((ball.vertices + np.array([x, rng.uniform(0.3, 1.5), z]), ball.faces))
    offsets = np.cumsum([0] + [len(p) for p, _ in parts[:-1]])
    positions = np.concatenate([p for p, _ in parts]).astype(dtype)
    return positions, np.concatenate([np.asarray(f) + o for (_, f), o in zip(parts, offsets, strict=True)])


def patch(n=4000, dtype=np.float32, middle=(1.0, -1.0), half=0.6):
    points = np.random.default_rng(6).uniform(-half, half, (n, 3)) + np.array([middle[0], 0, middle[1]])
    points[:, 1] = 0
    return points.astype(dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", LIGHTS)
def test_equals_the_whole_map_to_the_bit(kind, dtype):
    mesh, light, points = bumps(dtype), LIGHTS[kind], patch(dtype=dtype)
    large = sl.shadow.virtual_shadow_map(*mesh, light, points, 2048, page=64)
    whole = sl.shadow.shadow_map(*mesh, light, 2048)
    table = large.tables[0]
    assert table.shape == (32, 32) and 1 < large.resident < 300 and large.resident == (table >= 0).sum()
    tiles = whole.depth.reshape(32, 64, 32, 64).swapaxes(1, 2)
    assert np.array_equal(large.maps[0].pages, tiles[table >= 0])
    assert large.hit_rate(points) == 1 and large.bytes < 0.4 * large.whole_bytes
    lit = sl.shadow.hard(whole, points, UP)
    assert 0 < lit.mean() < 1
    assert np.array_equal(sl.shadow.hard(large, points, UP), lit)
    for radius in (1.5, 8.0):
        wide = sl.shadow.pcf(whole, points, UP, radius=radius)
        assert np.array_equal(sl.shadow.pcf(large, points, UP, radius=radius), wide)


def test_pages_are_those_that_receivers_and_their_filters_read():
    mesh, light = bumps(), LIGHTS["sun"]
    whole = sl.shadow.shadow_map(*mesh, light, 1024)

    def place(points):
        d = points - whole.position
        left, right, bottom, top = whole.window
        x = (d @ whole.frame[0] - left) / (right - left)
        return 1024 * x, 1024 * (top - d @ whole.frame[1]) / (top - bottom)

    points = patch(50)
    for border in (0, 20):
        x, y = place(points.astype(np.float64))
        wanted = np.zeros((16, 16), bool)
        for dx in (-border, 0, border):
            for dy in (-border, 0, border):
                wanted[(y + dy).astype(int) // 64, (x + dx).astype(int) // 64] = True
        large = sl.shadow.virtual_shadow_map(*mesh, light, points, 1024, page=64, border=border)
        assert np.array_equal(large.tables[0] >= 0, wanted)


def test_what_is_not_there_is_lit_and_counted():
    mesh, light = bumps(), LIGHTS["sun"]
    near, far = patch(), patch(middle=(-2.0, 2.0))
    large = sl.shadow.virtual_shadow_map(*mesh, light, near, 2048, page=64)
    found = sl.shadow.hard(large, far, UP, full_output=True)
    assert large.hit_rate(far) == 0 and (found.map_index == -1).all() and (found.lit == 1).all()
    both = np.concatenate([near, far])
    assert large.hit_rate(both) == pytest.approx(0.5)


def test_levels_follow_pixels():
    mesh, light = bumps(), LIGHTS["sun"]
    eye, pixel = np.array([0.0, 0.3, 4.0]), 2e-3
    points = patch(20_000, middle=(0, 0), half=3.9)
    large = sl.shadow.virtual_shadow_map(*mesh, light, points, 8192, page=64, eye=eye, pixel=pixel)
    assert len(large.maps) == 8 and [m.size[0] for m in large.maps] == [8192 >> i for i in range(8)]
    found = sl.shadow.hard(large, points, UP, full_output=True)
    texel = large.maps[0].texel_size() * 2.0**found.map_index
    size = pixel * np.linalg.norm(points - eye, axis=-1)
    # The largest texels that are no larger than the pixel.
    assert (texel <= size * (1 + 1e-5))[found.map_index > 0].all() and (2 * texel > size * (1 - 1e-5)).all()
    assert len(np.unique(found.map_index)) >= 3
    # Each level is the whole map of its size; edges differ between them by a texel.
    for k in np.unique(found.map_index):
        whole = sl.shadow.shadow_map(*mesh, light, 8192 >> k)
        # Windows of whole maps grow by two texels of their own, so it is the level's own pages that must agree.
        at = found.map_index == k
        assert (sl.shadow.hard(whole, points[at], UP) != found.lit[at]).mean() < 0.02
    assert large.bytes < 0.1 * large.whole_bytes


def test_missing_pages_fall_back_to_coarser_levels():
    mesh, light = bumps(), LIGHTS["sun"]
    eye, pixel = np.array([1.0, 0.5, -1.0]), 4e-3
    far = patch(3000, middle=(-2.0, 2.0))
    large = sl.shadow.virtual_shadow_map(*mesh, light, far, 4096, page=64, eye=eye, pixel=pixel)
    closer = far + np.float32(1e-3)
    # From where the view is now these would want a finer level.
    moved = sl.shadow.VirtualShadowMap(
        large.maps, large.border, large.page, tuple(far[0] + [0, 0.1, 0]), large.pixel, large.needed, large.reused
    )
    assert moved.hit_rate(closer) < 0.5
    found = sl.shadow.hard(moved, closer, UP, full_output=True)
    assert (found.map_index > 0).all()
    exact = sl.shadow.hard(sl.shadow.shadow_map(*mesh, light, 4096), closer, UP)
    assert (found.lit != exact).mean() < 0.05


def test_pages_of_a_frame_before_are_taken_over():
    mesh, light = bumps(), LIGHTS["point"]
    first = sl.shadow.virtual_shadow_map(*mesh, light, patch(), 2048, page=64)
    assert first.reused == 0 and first.reuse_rate == 0
    view = patch(middle=(1.6, -1.0))
    second = sl.shadow.virtual_shadow_map(*mesh, light, view, 2048, page=64, previous=first)
    fresh = sl.shadow.virtual_shadow_map(*mesh, light, view, 2048, page=64)
    assert 0.3 < second.reuse_rate < 1 and second.needed == second.resident
    assert np.array_equal(second.tables[0], fresh.tables[0])
    assert np.array_equal(second.maps[0].pages, fresh.maps[0].pages)
    with pytest.raises(ValueError, match="previous"):
        sl.shadow.virtual_shadow_map(*mesh, LIGHTS["sun"], view, 2048, page=64, previous=first)
    with pytest.raises(TypeError, match="previous"):
        sl.shadow.virtual_shadow_map(*mesh, light, view, 2048, page=64, previous=3)


def test_threads_change_nothing():
    mesh, before, found = bumps(), sl.threads(), []
    try:
        for n in (1, 3):
            sl.set_threads(n)
            found.append(sl.shadow.virtual_shadow_map(*mesh, LIGHTS["sun"], patch(), 2048, page=64))
    finally:
        sl.set_threads(before)
    assert np.array_equal(found[0].maps[0].pages, found[1].maps[0].pages)


def test_nothing_seen_and_nothing_there():
    mesh = bumps()
    none = sl.shadow.virtual_shadow_map(*mesh, LIGHTS["sun"], np.zeros((0, 3)), 256, page=64)
    assert none.resident == 0 and np.isnan(none.reuse_rate) and np.isnan(none.hit_rate(np.zeros((0, 3))))
    assert (sl.shadow.hard(none, patch(5), UP) == 1).all()
    empty = sl.shadow.virtual_shadow_map(np.zeros((0, 3)), np.zeros((0, 3), int), LIGHTS["sun"], patch(5), 256, page=64)
    assert (sl.shadow.hard(empty, patch(5), UP) == 1).all()
    points = patch(5)
    points[2] = np.nan
    some = sl.shadow.virtual_shadow_map(*mesh, LIGHTS["sun"], points, 256, page=64)
    assert np.isnan(sl.shadow.hard(some, points, UP)).tolist() == [False, False, True, False, False]


def test_errors_name_the_argument():
    p, f = bumps()
    for wrong, kind, name in (
        ({"page": 100}, ValueError, "page: expected a power of two"),
        ({"page": 32}, ValueError, "page"),
        ({"page": 0}, ValueError, "page"),
        ({"page": 64.0}, TypeError, "page"),
        ({"page": 512}, ValueError, "page: expected at most the resolution"),
        ({"resolution": 1000}, ValueError, "resolution: expected a power of two"),
        ({"resolution": 32768}, ValueError, "resolution"),
        ({"border": -1}, ValueError, "border"),
        ({"eye": (0, 0, 0)}, ValueError, "pixel: expected beside eye"),
        ({"pixel": 1e-3}, ValueError, "eye: expected beside pixel"),
        ({"eye": (0, 0), "pixel": 1e-3}, ValueError, "eye"),
        ({"receivers": [[np.nan] * 3]}, ValueError, "receivers: expected a finite point"),
    ):
        given = {"light": LIGHTS["sun"], "receivers": patch(5), "resolution": 256, "page": 64} | wrong
        with pytest.raises(kind, match=name):
            sl.shadow.virtual_shadow_map(p, f, **given)


def test_the_last_texel_has_its_page():
    ground, roof = sl.mesh.plane((40.0, 40.0)), sl.mesh.box((30.0, 0.1, 30.0))
    p = np.concatenate([ground.positions, roof.positions + np.array([0, 2, 0])])
    f = np.concatenate([ground.faces, roof.faces + len(ground.positions)])
    light = sl.light.SpotLight((0, 6, 0), (0, -1, 0), (1, 1, 1), 0.5, 0.8)
    whole = sl.shadow.shadow_map(p, f, light, 512)
    left, right = whole.window[:2]
    # Half a texel before the map's last border, where nothing but the last column is asked for.
    points = np.array([[-6 * (left + 511.5 / 512 * (right - left)), 0, 0.37]])
    large = sl.shadow.virtual_shadow_map(p, f, light, points, 512, page=64, border=0)
    assert large.hit_rate(points) == 1.0
    assert sl.shadow.hard(large, points, UP) == sl.shadow.hard(whole, points, UP) == 0.0
