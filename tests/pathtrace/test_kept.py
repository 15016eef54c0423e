"""What is made of a scene is kept for its next picture, and made anew when anything has changed."""

import gc
import weakref

import numpy as np
import pytest
import shadelab as sl
from shadelab import mesh, scene
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
