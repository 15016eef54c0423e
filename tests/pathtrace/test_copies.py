"""Meshes that stand in many places are kept once, and the picture is that of the flattened scene."""

import subprocess
import sys

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st
from shadelab import brdf, mesh, scene
from shadelab.light import RectLight
from shadelab.pathtrace._copies import shareable
from shadelab.pathtrace._world import World

CLAY = scene.Material((0.7, 0.3, 0.2), roughness=0.8)
GREEN = scene.Material((0.2, 0.6, 0.3), roughness=0.3, metallic=1.0)
GLASS = brdf.Dielectric(1.5)
FLOOR = scene.Instance(mesh.plane((8, 8)), sl.transform.translate((0, -1, 0)), (CLAY,))
CAMERA = scene.Camera((0.5, 1.2, 5), (0, 0, 0), fov_y=0.8)
LAMP = RectLight((0, 3, 1), (1, 0, 0), (0, 0, -1), (9, 8, 7))


def ball(**more):
    """With normals of its own, two materials, and colours at will."""
    b = mesh.icosphere(2, 0.4)
    ids = (np.arange(len(b.faces)) % 2).astype(np.int32)
    return mesh.Mesh(b.positions, b.faces, normals=b.positions / 0.4, material_ids=ids, **more)


def both(world, size=(24, 20), samples=8, **options):
    return [
        sl.pathtrace.path_trace(world, size, samples, 5, instances=how, **{"dtype": np.float64, **options}).radiance
        for how in ("flat", "shared")
    ]


def assert_alike(flat, shared, share=0.98):
    """All but few pixels to rounding: a ray that grazes an edge may take another way."""
    close = np.isclose(flat, shared, rtol=1e-9, atol=1e-12).all(-1)
    assert close.mean() >= share, f"{1 - close.mean():.3f} of the pixels differ"


def placed(seed, count=6):
    """Turned, stretched, sheared, some of them mirrored."""
    rng = np.random.default_rng(seed)
    matrices = []
    for _ in range(count):
        m = np.eye(4)
        m[:3, :3] = (
            np.linalg.qr(rng.normal(size=(3, 3)))[0] * rng.choice([-1.0, 1.0]) @ np.diag(rng.uniform(0.5, 1.5, 3))
        )
        m[:3, 3] = rng.uniform((-1.6, -0.6, -1), (1.6, 1.2, 1))
        matrices.append(m)
    return matrices


@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 10**6), clear=st.booleans(), colored=st.booleans())
def test_shared_meshes_give_the_flattened_picture(seed, clear, colored):
    colors = np.random.default_rng(seed).uniform(0.2, 1, (162, 3)) if colored else None
    thing = ball(colors=colors)
    pairs = [(CLAY, GREEN), (GREEN, GLASS if clear else CLAY)]
    things = [scene.Instance(thing, m, pairs[k % 2]) for k, m in enumerate(placed(seed))]
    world = scene.Scene([FLOOR, *things], (LAMP,), CAMERA, background=(0.1, 0.1, 0.2))
    # Through glass, more paths pass edges.
    assert_alike(*both(world), share=0.9 if clear else 0.98)


def test_a_mirrored_glass_ball_keeps_its_inside():
    mirrored = np.diag([-1.0, 1, 1, 1])
    glass = scene.Instance(ball(), mirrored, (GLASS, GLASS))
    other = scene.Instance(glass.mesh, sl.transform.translate((1.2, 0, 0)), (GLASS, GLASS))
    world = scene.Scene([FLOOR, glass, other], (), CAMERA, background=(1, 1, 1))
    flat, shared = both(world, samples=32)
    assert_alike(flat, shared, share=0.9)
    np.testing.assert_allclose(shared.mean(), flat.mean(), rtol=1e-3)


def test_what_emits_or_moves_or_would_lose_its_normals_is_flattened():
    glow = scene.Material((0, 0, 0), emission=(4.0, 3.0, 2.0))
    round_ = mesh.icosphere(1, 0.3)
    plain = mesh.Mesh(round_.positions, round_.faces)
    stretch = [np.diag([1, 2, 1, 1.0]) @ sl.transform.translate((x, 0, 0)) for x in (-1, 1)]
    to = sl.transform.translate
    things = [
        FLOOR,
        *(scene.Instance(plain, to((x, 0.4, 0)), (glow,)) for x in (-1, 1)),
        *(scene.Instance(plain, to((x, 0, 1)), (CLAY,)) for x in (-1, 0, 1)),
        *(scene.Instance(plain, m, (CLAY,)) for m in stretch),
        scene.Instance(plain, to((0, 1, 0)), (CLAY,), transform_end=to((0.3, 1, 0))),
    ]
    world = scene.Scene(things, (), scene.Camera((0, 1, 5), (0, 0, 0), shutter=(0, 1)))
    assert shareable(world, "shared", 1) == [3, 4, 5]
    held = World(world, None, np.dtype(np.float64), "shared", 1)
    assert len(held.copies.rest.instances) == len(things) - 3
    assert_alike(*both(world, samples=16))


def test_everything_may_be_a_copy_and_colors_may_be_of_the_rest_alone():
    thing = ball()
    alone = scene.Scene([scene.Instance(thing, m, (CLAY, GREEN)) for m in placed(3)], (LAMP,), CAMERA)
    assert_alike(*both(alone))
    colored = mesh.Mesh(FLOOR.mesh.positions, FLOOR.mesh.faces, colors=np.full((len(FLOOR.mesh.positions), 3), 0.5))
    floor = scene.Instance(colored, FLOOR.transform, (CLAY,))
    assert_alike(*both(scene.Scene([floor, *alone.instances], (LAMP,), CAMERA)))


def test_in_single_precision_nothing_shades_itself():
    """A furnace: white copies in white light are not seen, wherever they stand."""
    white = scene.Material((1, 1, 1), roughness=1.0, specular=0.0)
    thing = mesh.box((0.7, 0.6, 0.5))
    turned = sl.transform.rotate_axis((1, 2, 3), 0.7) @ sl.transform.scale([3] * 3)
    far = [sl.transform.translate((1000 + x, 0, 0)) @ turned for x in (-2.0, 2.0)]
    camera = scene.Camera((1000, 0, 6), (1000, 0, 0))
    world = scene.Scene([scene.Instance(thing, m, (white,)) for m in far], (), camera, background=(1, 1, 1))
    traced = sl.pathtrace.path_trace(world, (32, 32), 16, 64, roulette=64, instances="shared")
    np.testing.assert_allclose(traced.radiance, 1, atol=1e-5)


def test_threads_and_rounds_change_nothing():
    thing = ball()
    world = scene.Scene([FLOOR, *(scene.Instance(thing, m, (CLAY, GREEN)) for m in placed(5))], (LAMP,), CAMERA)
    options = {"size": (20, 20), "samples": 8, "instances": "shared"}
    one = sl.pathtrace.path_trace(world, **options).radiance
    sl.set_threads(1)
    try:
        np.testing.assert_array_equal(sl.pathtrace.path_trace(world, **options).radiance, one)
    finally:
        sl.set_threads(None)
    *_, last = sl.pathtrace.progressive(world, **options)
    np.testing.assert_allclose(last.radiance, one, rtol=1e-5, atol=1e-7)


def test_faces_are_shared_where_they_outweigh_samples():
    thing = mesh.icosphere(5, 0.1)
    at = [sl.transform.translate((x, y, 0)) for x in range(20) for y in range(22)]
    few, some, many = (scene.Scene([scene.Instance(thing, m) for m in at[:n]], (LAMP,), CAMERA) for n in (3, 30, 440))
    assert shareable(few, "auto", 16) == shareable(many, "flat", 16) == []
    assert shareable(few, "shared", 16) == [0, 1, 2]
    # 29 copies of 20,480 faces are worth 198,000 samples; nine million faces are shared whatever their number.
    assert shareable(some, "auto", 190_000) == list(range(30))
    assert shareable(some, "auto", 200_000) == []
    assert shareable(many, "auto", 10**9) == list(range(440))


def test_ten_thousand_copies_take_the_memory_of_one():
    """20,480 faces in 10,000 places: flattened, some 39 GB."""
    code = """
import resource, numpy as np, shadelab as sl
from shadelab import mesh, scene
def peak(): return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
thing = mesh.icosphere(5, 0.4)
x, z = np.meshgrid(np.arange(100.0), -np.arange(100.0))
at = [sl.transform.translate((x, 0, z)) for x, z in zip(x.ravel(), z.ravel())]
camera = scene.Camera((50, 20, 30), (50, 0, -50))
def forest(n): return scene.Scene([scene.Instance(thing, m) for m in at[:n]], (), camera, background=(1, 1, 1))
sl.pathtrace.path_trace(forest(2), (32, 32), 4, instances="shared")
before = peak()
world = forest(10_000)
traced = sl.pathtrace.path_trace(world, (32, 32), 4)
assert 0.1 < traced.radiance.mean() < 0.99
print(peak() - before)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    # Two matrices, a box, corners and Python objects: 1.6 KB each.
    assert float(run.stdout) < 40


@pytest.mark.parametrize("bad", ["twice", None, 3])
def test_an_unknown_way_is_named(bad):
    with pytest.raises((TypeError, ValueError), match="instances"):
        sl.pathtrace.path_trace(scene.Scene(mesh.box(), (LAMP,), CAMERA), (4, 4), 1, instances=bad)


@pytest.mark.parametrize("tracer", [sl.pathtrace.whitted, sl.pathtrace.distribution])
@pytest.mark.parametrize("colored", [False, True])
def test_recursion_sees_copies(tracer, colored):
    colors = np.random.default_rng(1).uniform(0.2, 1, (162, 3)) if colored else None
    thing = ball(colors=colors)
    polished = brdf.Conductor((0.9, 0.8, 0.7))
    things = [scene.Instance(thing, m, ((CLAY, GLASS), (GREEN, polished))[k % 2]) for k, m in enumerate(placed(3))]
    glow = scene.Instance(
        mesh.icosphere(1, 0.2), sl.transform.translate((0, 1.5, 0)), (scene.Material(emission=(2.0,) * 3),)
    )
    world = scene.Scene([FLOOR, *things, glow], (LAMP,), CAMERA, background=(0.1, 0.1, 0.2))
    flat, shared = (
        tracer(world, (24, 20), 4, 5, instances=how, dtype=np.float64).radiance for how in ("flat", "shared")
    )
    assert_alike(flat, shared, share=0.9)
    np.testing.assert_allclose(shared.mean(), flat.mean(), rtol=0.01)


@pytest.mark.parametrize("samples", [0, 8])
@pytest.mark.parametrize("moves", [False, True])
def test_aovs_call_copies_what_the_flattened_scene_does(samples, moves):
    colors = np.random.default_rng(2).uniform(0.2, 1, (162, 3))
    clear = scene.Instance(ball(colors=colors), placed(4)[0], (GLASS, GREEN))
    things = [scene.Instance(clear.mesh, m, ((CLAY, GREEN), (GREEN, CLAY))[k % 2]) for k, m in enumerate(placed(5))]
    end = sl.transform.translate((0.4, 1.0, 1)) if moves else None
    lone = scene.Instance(mesh.box((0.4, 0.4, 0.4)), sl.transform.translate((0, 1, 1)), (GREEN,), end)
    camera = scene.Camera((0.5, 1.2, 5), (0, 0, 0), fov_y=0.8, end=scene.Camera((0.6, 1.2, 5), (0, 0, 0), fov_y=0.8))
    # What is flattened stands before, between and after the copies.
    world = scene.Scene([*things[:3], FLOOR, lone, *things[3:], clear], (), camera)
    flat, shared = (
        sl.pathtrace.aovs(world, (40, 30), samples, instances=how, dtype=np.float64) for how in ("flat", "shared")
    )
    for name in ("face", "instance", "material"):
        same = getattr(flat, name) == getattr(shared, name)
        assert same.mean() > 0.99, name
    assert len(np.unique(shared.instance)) > 6
    for name in ("albedo", "normal", "depth", "position", "coverage", "motion"):
        close = np.isclose(getattr(flat, name), getattr(shared, name), rtol=1e-9, atol=1e-9)
        assert close.mean() > 0.98, name


def test_everything_seen_may_be_a_copy():
    alone = scene.Scene([scene.Instance(ball(), m, (CLAY, GREEN)) for m in placed(3)], (LAMP,), CAMERA)
    flat, shared = (sl.pathtrace.aovs(alone, (32, 24), instances=how) for how in ("flat", "shared"))
    for name in ("face", "instance", "material"):
        assert (getattr(flat, name) == getattr(shared, name)).mean() > 0.99
