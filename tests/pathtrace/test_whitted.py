"""Whitted's ray tracing: mirrors, glass, hard shadows, against closed forms and Mitsuba."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import brdf, mesh, scene
from shadelab.light import DirectionalLight, PointLight, RectLight
from shadelab.pathtrace import whitted

from .recursion_scenes import glowing, mitsuba_picture, through_mirrors_and_glass, tiles
from .scenes import lambert, thing

SIZE = (48, 32)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_floor_under_a_point_light_is_the_closed_form(dtype):
    lamp = PointLight((0, 1, 0), (2, 3, 4))
    camera = scene.Camera((0, 2, 2), (0, 0, 0), fov_y=0.4)
    world = scene.Scene(thing(mesh.plane((9, 9)), lambert(0.5, 0.6, 0.7)), lamp, camera)
    got = whitted(world, SIZE, dtype=dtype)
    _, directions = camera.rays(SIZE)
    points = np.asarray(camera.eye) + directions * (-2 / directions[..., 1:2])
    squared = (points**2).sum(-1) + 1
    wanted = np.array([0.5, 0.6, 0.7]) / np.pi * np.array([2, 3, 4]) / squared[..., None] ** 1.5
    assert got.radiance.dtype == dtype
    assert np.allclose(got.radiance, wanted, rtol=2e-6 if dtype == np.float32 else 1e-12)
    assert np.isinf(got.variance).all() and (got.samples == 1).all()


def test_shadows_are_sharp_even_of_area_lights():
    lamp = RectLight((0, 4, 0), (1, 0, 0), (0, 0, 1), (5, 5, 5))
    things = [
        thing(mesh.plane((8, 8)), lambert(0.5, 0.5, 0.5)),
        thing(mesh.box((1, 0.1, 1)), lambert(0, 0, 0), (0, 2, 0)),
    ]
    # From above the plate nothing hides its shadow but itself: look at the rim from the side.
    camera = scene.Camera((0, 1.5, 6), (0, 0, 0), fov_y=0.6)
    got = whitted(scene.Scene(things, lamp, camera), (96, 64)).radiance[..., 0]
    _, directions = camera.rays((96, 64))
    points = np.asarray(camera.eye) + directions * (-1.5 / directions[..., 1:2])
    floor = (directions[..., 1] < 0) & (np.abs(points[..., [0, 2]]).max(-1) < 3.9)
    # The plate's lower rim, seen from the light's middle; what the plate itself covers in the picture is left out.
    reach = 0.5 * 4 / (4 - 2.05)
    across = np.abs(points[..., [0, 2]]).max(-1)
    at_plate = np.asarray(camera.eye) + directions * (0.5 / np.maximum(directions[..., 1:2], 1e-9))
    inside, outside = floor & (across < reach - 0.02), floor & (across > reach + 0.1)
    assert inside.sum() > 50 and outside.sum() > 500
    assert (got[inside] == 0).all() and (got[outside] > 0).all()
    assert np.isfinite(at_plate).all()


def test_a_flat_mirror_shows_the_mirrored_scene():
    """What a camera sees in a mirror on the floor is what one below the floor sees without it."""
    ball = thing(mesh.icosphere(3, 0.4), lambert(0.3, 0.6, 0.9), (0, 0.8, 0))
    lamp = DirectionalLight((0.3, -1.0, -0.2), (2, 2, 2))
    mirror = thing(mesh.plane((20, 20)), brdf.Conductor(eta=(1e-3,) * 3, k=(1e3,) * 3))
    size = (32, 32)
    above = whitted(scene.Scene([ball, mirror], lamp, scene.Camera((0, 1, 3), (0, -0.8, 0), fov_y=0.4)), size, 1, 1)
    below = whitted(scene.Scene([ball], lamp, scene.Camera((0, -1, 3), (0, 0.8, 0), fov_y=0.4)), size, 1, 0)
    flipped = below.radiance[::-1]
    assert (flipped > 0).any()
    # Edges of pixels' centres round apart.
    close = np.abs(above.radiance - flipped) < 5e-3 * flipped + 1e-4
    assert close.mean() > 0.99


def test_glass_loses_no_light():
    """In an even sky a body of glass is as bright as the sky, whatever the Fresnel: all branches together."""
    ball = scene.Scene(
        scene.Instance(mesh.icosphere(3), materials=brdf.Dielectric(eta=1.5)),
        (),
        scene.Camera((0, 0, 4), (0, 0, 0)),
        background=(1, 1, 1),
    )
    full = whitted(ball, (24, 24), 1, 30, cutoff=1e-5).radiance
    # A flat face's neighbour may be in the way of what bent normals send on: grazing rays lose a little.
    assert full.max() < 1 + 1e-4 and np.median(full) > 0.999
    coarse = whitted(ball, (24, 24), 1, 30, cutoff=0.1).radiance
    assert (coarse <= full + 1e-6).all() and coarse.min() < 0.99


def test_a_depth_of_zero_shows_no_reflection():
    plain = whitted(through_mirrors_and_glass(), SIZE, max_depth=0).radiance
    deep = whitted(through_mirrors_and_glass(), SIZE, max_depth=5).radiance
    black = plain.sum(-1) == 0
    assert black.sum() > 100 and (deep[black].sum(-1) > 0).mean() > 0.95
    assert np.array_equal(plain[~black], deep[~black])


def test_agrees_with_mitsuba_through_mirrors_and_glass(tmp_path):
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    world = through_mirrors_and_glass()
    # Mitsuba's perfect conductor reflects all.
    white = scene.Material((1, 1, 1), 1.0, 0.0)
    things = [
        scene.Instance(i.mesh, i.transform, white if getattr(i.materials[0], "metallic", 0) else i.materials[0])
        for i in world.instances
    ]
    world = scene.Scene(things, (), world.camera, background=world.background)
    runs = np.stack([tiles(mitsuba_picture(mi, world, tmp_path, SIZE, 64, s, 12)) for s in range(8)])
    ours = np.stack([tiles(whitted(world, SIZE, 64, 11, seed=s, cutoff=1e-5).radiance) for s in range(8)])
    sigma = np.sqrt(runs.var(0, ddof=1) / 8 + ours.var(0, ddof=1) / 8 + 1e-8)
    z = (ours.mean(0) - runs.mean(0)) / sigma
    # 72 scores of about 14 degrees of freedom; the seeds are fixed.
    assert np.abs(z).max() < 5.5 and np.sqrt((z**2).mean()) < 1.5, z


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_scale_changes_nothing(scale):
    def world(s):
        lamp = PointLight((0, 2 * s, s), (s * s,) * 3)
        things = [
            thing(mesh.box((s, s, s)), lambert(0.5, 0.5, 0.5)),
            thing(mesh.plane((8 * s, 8 * s)), scene.Material((1, 1, 1), 1, 0), (0, -0.5 * s, 0)),
        ]
        return scene.Scene(things, lamp, scene.Camera((s, s, 3 * s), (0, 0, 0), fov_y=0.5), background=(0.1, 0.2, 0.3))

    a, b = whitted(world(1.0), SIZE).radiance, whitted(world(scale), SIZE).radiance
    assert (np.abs(a - b) < 1e-3 * a + 1e-5).mean() > 0.99


def test_threads_and_runs():
    world, before = through_mirrors_and_glass(), sl.threads()
    whole = whitted(world, (24, 16), 8, seed=2)
    sl.set_threads(1)
    assert np.array_equal(whitted(world, (24, 16), 8, seed=2).radiance, whole.radiance)
    sl.set_threads(before)
    parts = [whitted(world, (24, 16), 4, seed=2, start=s) for s in (0, 4)]
    merged = parts[0].merge(parts[1])
    assert (merged.samples == 8).all() and np.allclose(merged.radiance, whole.radiance, atol=1e-6)
    assert np.allclose(merged.variance, whole.variance, rtol=1e-3, atol=1e-9)


def test_wrong_calls_name_the_argument():
    world = scene.Scene(mesh.box())
    with pytest.raises(ValueError, match="max_depth: expected an integer"):
        whitted(world, SIZE, max_depth=65)
    with pytest.raises(ValueError, match="cutoff: expected a number"):
        whitted(world, SIZE, cutoff=-1)
    assert glowing((1, 1, 1)).emission == (1, 1, 1)
