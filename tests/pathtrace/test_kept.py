"""What is made of a scene is kept for its next picture, and made anew when anything has changed."""

import dataclasses
import gc
import threading
import weakref

import numpy as np
import pytest
import shadelab as sl
from shadelab import brdf, environment, light, mesh, scene
from shadelab.pathtrace import _world

CAMERA = scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.8)


def ball(color=0.5):
    b = mesh.icosphere(1)
    own = mesh.Mesh(b.positions.copy(), b.faces.copy(), colors=np.full((len(b.positions), 3), color))
    return scene.Scene(scene.Instance(own), (), CAMERA, background=(1, 1, 1))


def look(world, **options):
    return sl.pathtrace.path_trace(world, (8, 8), 4, 2, **options).radiance


def test_a_scene_is_flattened_once():
    world = ball()
    first = look(world)
    kept = _world._kept[2]
    assert np.array_equal(look(world), first) and _world._kept[2] is kept
    sl.pathtrace.aovs(world, (4, 4))
    assert _world._kept[2] is kept
    # Of another precision, another is made.
    assert look(world, dtype=np.float64).dtype == np.float64
    assert _world._kept[2] is not kept
    assert np.array_equal(look(world), first)


def test_arrays_written_to_are_seen():
    world = ball()
    own = world.instances[0].mesh
    before = look(world)
    own.positions[:] *= 0.5
    smaller = look(world)
    assert not np.array_equal(before, smaller)
    assert np.array_equal(smaller, look(scene.Scene(world.instances, (), CAMERA, background=(1, 1, 1))))
    own.colors[:] = 0.25
    assert look(world).sum() < smaller.sum()
    world.instances[0].transform[0, 3] = 50
    assert (look(world) == 1).all()


def test_what_is_kept_goes_with_its_scene():
    world = ball()
    look(world)
    made = weakref.ref(_world._kept[2])
    del world
    gc.collect()
    assert made() is None and _world._kept is None


def test_material_ids_written_to_are_checked():
    b = mesh.icosphere(1)
    own = mesh.Mesh(b.positions, b.faces, material_ids=np.zeros(len(b.faces), np.int32))
    things = [scene.Instance(own, sl.transform.translate([x, 0, 0])) for x in (-1, 1)]
    world = scene.Scene(things, (), CAMERA, background=(1, 1, 1))
    for instances in ("shared", "flat"):
        own.material_ids[:] = 0
        look(world, instances=instances)
        for wrong in (7, -1):
            own.material_ids[3] = wrong
            with pytest.raises(ValueError, match=f"materials: face 3 of the mesh asks for material {wrong} of 1"):
                look(world, instances=instances)


def test_what_is_no_array_cannot_be_changed():
    lamp = light.RectLight((0, 3, 0), (1, 0, 0), (0, 0, 1), (5, 5, 5), texture=np.ones((2, 2)))
    clay = scene.Material((0.5, 0.4, 0.3))
    dye = np.array([0.5, 0.4, 0.3])
    things, lights = [scene.Instance(mesh.icosphere(1), None, [clay, brdf.Diffuse(dye)])], [lamp]
    sky = np.ones((4, 8, 3))
    world = scene.Scene(things, lights, CAMERA, environment=environment.Environment(sky))
    before = look(world)
    # Lists and arrays given are copied, so that what happens to them later is no matter.
    things.append(scene.Instance(mesh.box()))
    lights.append(lamp)
    dye[:], sky[:] = 0, 0
    assert np.array_equal(look(world), before)
    parts = (world, world.instances[0], world.instances[0].mesh, clay, world.instances[0].materials[1], lamp, CAMERA)
    for part in parts:
        for field in dataclasses.fields(part):
            with pytest.raises(dataclasses.FrozenInstanceError):
                setattr(part, field.name, getattr(part, field.name))
    assert isinstance(world.instances, tuple) and isinstance(world.lights, tuple)
    for array in (lamp.texture, world.environment.radiance):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0


def test_another_camera_light_or_material_is_another_scene():
    world = ball()
    seen = look(world)
    lit = dataclasses.replace(world, lights=(light.PointLight((0, 3, 3), (9, 9, 9)),))
    near = dataclasses.replace(world, camera=scene.Camera((0, 0, 3), (0, 0, 0), fov_y=0.8))
    red = dataclasses.replace(
        world, instances=dataclasses.replace(world.instances[0], materials=brdf.Diffuse((1, 0, 0)))
    )
    for other in (lit, near, red):
        first = look(other)
        assert not np.array_equal(first, seen) and np.array_equal(look(world), seen)
        assert np.array_equal(look(other), first)


def test_arrays_of_several_places_are_seen():
    """Written to through one of the meshes, of copies and of what is flattened; in shape alone; and written back."""
    b = mesh.icosphere(1)
    one, two = (mesh.Mesh(b.positions.copy(), b.faces.copy()) for _ in range(2))
    places = [sl.transform.translate([x, 0, 0]) for x in (-1.5, -0.5, 0.5, 1.5)]
    things = [scene.Instance(m, t) for m, t in zip((one, two, one, two), places, strict=True)]
    world = scene.Scene(things, (), CAMERA, background=(1, 1, 1))
    for instances in ("flat", "shared"):
        before = look(world, instances=instances)
        for own in (one, two):
            kept = own.positions.copy()
            own.positions[:] *= 0.7
            changed = look(world, instances=instances)
            assert not np.array_equal(changed, before)
            own.positions[:] = kept
            assert np.array_equal(look(world, instances=instances), before)
        kept = one.faces.copy()
        one.faces[:40] = one.faces[40:]
        assert not np.array_equal(look(world, instances=instances), before)
        one.faces[:] = kept
    # The arrays of both change places: their contents together are the same.
    one.positions[:] *= 0.5
    before = look(world)
    small = one.positions.copy()
    one.positions[:], two.positions[:] = two.positions, small
    assert not np.array_equal(look(world), before)


def test_a_scene_in_the_place_of_one_that_is_gone_is_another():
    pictures = {}
    for color in (0.2, 0.5, 0.8) * 5:
        # Often at the address of the one before.
        found = look(ball(color))
        assert np.array_equal(pictures.setdefault(color, found), found)
    assert len({p.tobytes() for p in pictures.values()}) == 3


def test_threads_that_trace_different_scenes_do_not_get_in_each_others_way():
    worlds = [ball(c) for c in (0.2, 0.5, 0.8)]
    wanted, wrong = [look(w) for w in worlds], []

    def work(k):
        for i in range(30):
            n = (k + i) % 3
            if not np.array_equal(look(worlds[n]), wanted[n]):
                wrong.append(n)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


@pytest.mark.parametrize("instances", ["flat", "shared"])
def test_frames_are_of_the_scene_as_it_was_when_they_were_asked_for(instances):
    b = mesh.icosphere(1)
    given = [b.positions.astype(np.float32), b.faces.copy(), b.positions.astype(np.float32)]
    own = mesh.Mesh(*given, colors=np.full((len(b.positions), 3), 0.5), material_ids=np.zeros(len(b.faces), np.int32))
    things = [scene.Instance(own, sl.transform.translate([x, 0, 0])) for x in (-1, 1)]
    world = scene.Scene(things, (), CAMERA, background=(1, 1, 1))

    def frames():
        return sl.pathtrace.progressive(world, (8, 8), 8, instances=instances)

    wanted = [frame.radiance for frame in frames()]
    for array in (own.positions, own.faces, own.normals, own.colors, own.material_ids):
        # Made anew, since another scene was looked at, and asked for before it changes.
        look(ball())
        coming, before = frames(), array.copy()
        array[:] = 7 if array is own.material_ids else array[::-1] * 0.5 if array.dtype.kind == "f" else array[::-1]
        assert all(np.array_equal(frame.radiance, a) for frame, a in zip(coming, wanted, strict=True))
        array[:] = before
        assert np.array_equal([frame.radiance for frame in frames()], wanted)
