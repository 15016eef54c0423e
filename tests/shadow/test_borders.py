"""What lies at the borders of maps: nothing is lit that the whole map, or a ray, has in shadow."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import mesh
from shadelab.light import DirectionalLight, PointLight, PolygonLight, SpotLight
from shadelab.scene import Camera

S = sl.shadow


def joined(*bodies):
    positions = np.concatenate([p for p, _ in bodies])
    starts = np.cumsum([0] + [len(p) for p, _ in bodies[:-1]])
    return positions, np.concatenate([f + k for (_, f), k in zip(bodies, starts, strict=True)])


def body(m, offset=(0.0, 0, 0)):
    return m.positions + np.asarray(offset, m.positions.dtype), m.faces


@pytest.mark.parametrize("fov", [0.1, 0.8])
@pytest.mark.parametrize("stable", [True, False])
@pytest.mark.parametrize("blend", [0.1, 0.6])
@pytest.mark.parametrize("method", ["practical", "uniform"])
def test_cascades_hold_all_that_crosses_over_to_them(fov, stable, blend, method):
    ground = mesh.plane((400.0, 400.0))
    camera = Camera((0, 3, 90), (0, 0, 40), fov_y=fov)
    origins, directions = camera.rays((96, 54), dtype=np.float64)
    t = -origins[..., 1] / directions[..., 1]
    points = (origins + directions * t[..., None])[t > 0]
    points = points[(np.abs(points[:, 0]) < 150) & (np.abs(points[:, 2]) < 150)]
    maps = S.cascades(
        *joined(body(ground), body(ground, (0, 30, 0))), DirectionalLight((0, -1, 0)), camera, 256,
        aspect=96 / 54, method=method, near=1.0, far=150.0, blend=blend, stable=stable,
    )  # fmt: skip
    inside = (points - camera.eye) @ maps.axis < 150.0
    assert inside.any() and S.hard(maps, points, [0, 1, 0])[inside].max() == 0.0


def test_faces_of_cubes_without_border_meet():
    room, around = mesh.box((4.0, 4, 4)), mesh.box((0.5, 0.5, 0.5))
    place = np.array([0.1, 0.2, 0.3])
    positions, faces = joined(body(room), body(around, place))
    rng = np.random.default_rng(1)
    away = rng.uniform(-1.5, 1.5, (3000, 3))
    away[:, 0] = np.where(rng.random(3000) < 0.5, 1, -1) * away[:, 1]
    for dtype in (np.float32, np.float64):
        for border in (0, 1):
            cube = S.cube_shadow_map(positions.astype(dtype), faces, PointLight(tuple(place)), 64, border=border)
            outside = (place + away)[np.abs(away).max(-1) > 0.3]
            assert S.hard(cube, outside).max() == 0.0


def test_world_radii_that_reach_beyond_a_cubes_faces_are_refused():
    room = mesh.box((4.0, 4, 4))
    cube = S.cube_shadow_map(*body(room), PointLight((0, 0, 0)), 256, border=8)
    corner = [[1.99, 1.9, 0.0]]
    # 8 of 256 texels across 2 · 1.99 (1 + 16 / 240): 0.13 at the wall.
    assert S.pcf(cube, corner, radius=0.1, units="world").shape == (1,)
    with pytest.raises(ValueError, match="radius"):
        S.pcf(cube, corner, radius=0.5, units="world")
    with pytest.raises(ValueError, match="radius"):
        S.pcf(cube, corner, radius=8.0, bilinear=True)
    with pytest.raises(ValueError, match="radius"):
        S.pcf(cube, corner, [-1, 0, 0], radius=8.0, normal_offset=1.0)


def test_pages_hold_the_last_texels():
    ground, roof = mesh.plane((40.0, 40.0)), mesh.box((30.0, 0.1, 30.0))
    positions, faces = joined(body(ground), body(roof, (0, 2, 0)))
    light = SpotLight((0, 6, 0), (0, -1, 0), (1, 1, 1), inner_angle=0.5, outer_angle=0.8)
    whole = S.shadow_map(positions, faces, light, 512)
    left, right, bottom, top = whole.window
    at = np.array([0.5, 255.5, 510.5, 511.5, 511.99]) / 512
    u, v = np.meshgrid(left + at * (right - left), top - at * (top - bottom))
    places = 6.0 * (u[..., None] * whole.frame[0] + v[..., None] * whole.frame[1] + whole.frame[2]) + whole.position
    places = places.reshape(-1, 3)
    pages = S.virtual_shadow_map(positions, faces, light, places, 512, page=64, border=0)
    assert pages.hit_rate(places) == 1.0
    assert np.array_equal(S.hard(pages, places, [0, 1, 0]), S.hard(whole, places, [0, 1, 0]))


def test_a_polygons_map_stands_in_the_middle_of_its_area():
    cut = [(-1.0, 4.0, z) for z in np.linspace(1, -1, 31)]
    light = PolygonLight(corners=((1, 4, -1), (1, 4, 1), *cut), radiance=(1, 1, 1))
    m = S.shadow_map(*body(mesh.plane((4.0, 4.0))), light, 16)
    np.testing.assert_allclose(m.position, [0, 4, 0], atol=1e-6)
