"""Path tracing: Mitsuba's pictures by z-scores, furnaces, and the same bits whatever the threads and the SIMD level."""

import importlib.util
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import shadelab as sl
from scipy import stats
from shadelab import brdf, light, mesh, scene
from shadelab.environment import Environment
from shadelab.light import RectLight
from shadelab.pathtrace.paths import Sampler, Strategy

spec = importlib.util.spec_from_file_location("path_trace_scenes", Path(__file__).with_name("scenes.py"))
scenes = importlib.util.module_from_spec(spec)
spec.loader.exec_module(scenes)
lambert, thing, cornell, spheres, punctual = (
    scenes.lambert,
    scenes.thing,
    scenes.cornell,
    scenes.spheres,
    scenes.punctual,
)
SIZE = scenes.SIZE
TILE = 8


def tiles(picture):
    h, w, c = picture.shape
    return picture.astype(np.float64).reshape(h // TILE, TILE, w // TILE, TILE, c).mean((1, 3))


BUILDS = (
    "cornell spheres punctual furnace glass mirror many_lights environment emissive_mesh small_bright_light".split()
)
# Paths of each picture; scenes with much noise need more for half a per cent to show.
MORE = {"small_bright_light": 2, "glass": 2, "mirror": 4, "emissive_mesh": 2, "many_lights": 4}


@pytest.mark.parametrize("name", BUILDS)
def test_agrees_with_mitsuba_within_monte_carlo_error(name, tmp_path):
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    world, depth, runs = getattr(scenes, name)(), 4, 16
    theirs = scenes.mitsuba_scene(mi, world, tmp_path, depth)
    more = MORE.get(name, 1)
    other = np.stack([tiles(np.array(mi.render(theirs, spp=32 * more, seed=s))) for s in range(runs)])
    ours = [sl.pathtrace.path_trace(world, SIZE, 64 * more, depth, s).radiance for s in range(runs)]
    ours = np.stack([tiles(picture) for picture in ours])
    # Spreads of both sides by their runs; where every path carries the same, single precision's rounding remains.
    spread = (ours.var(0, ddof=1) + other.var(0, ddof=1)) / runs
    mean = ours.mean(0)
    sigma = np.sqrt(spread + (2e-6 * mean) ** 2 + 1e-20)
    t = (mean - other.mean(0)) / sigma
    # Welch's degrees of freedom are 15 to 30; one per cent for all tiles and channels of all scenes together.
    level = stats.t.sf(np.abs(t), runs - 1) * 2
    assert level.min() > 0.01 / (len(BUILDS) * t.size), (t, level.min())
    assert np.sqrt((t**2).mean()) < 1.35
    # The whole picture, per channel: a bias of half a per cent would show at three sigma.
    error = np.sqrt((sigma**2).sum((0, 1))) / sigma[..., 0].size
    assert (error < 0.005 / 3 * mean.mean((0, 1))).all(), error / mean.mean((0, 1))
    assert (np.abs((mean - other.mean(0)).mean((0, 1))) < 4 * error).all()


@pytest.mark.parametrize("name", ["cornell", "mirror", "environment", "emissive_mesh"])
def test_all_strategies_agree(name):
    world, depth, runs = getattr(scenes, name)(), 3, 10
    means, spreads = [], []
    for strategy in get_args(Strategy):
        samples = 128 if strategy in ("uniform", "bsdf") else 32
        seeds = range(100, 100 + runs)
        pictures = [sl.pathtrace.path_trace(world, SIZE, samples, depth, s, strategy=strategy) for s in seeds]
        several = np.stack([tiles(picture.radiance) for picture in pictures])
        means.append(several.mean(0))
        spreads.append(several.var(0, ddof=1) / runs)
    for mean, spread in zip(means, spreads, strict=True):
        t = (mean - means[-1]) / np.sqrt(spread + spreads[-1] + (2e-6 * mean) ** 2 + 1e-20)
        level = stats.t.sf(np.abs(t), runs - 1) * 2
        assert level.min() > 0.01 / (20 * t.size)
        assert np.sqrt((t**2).mean()) < 1.5


@pytest.mark.parametrize("selection", ["all", "power", "tree"])
def test_every_way_to_choose_lights_agrees(selection):
    for name in ("many_lights", "emissive_mesh"):
        world = getattr(scenes, name)()
        options = {"sampler": "independent", "max_depth": 2}
        own = sl.pathtrace.path_trace(world, SIZE, 256, seed=1, light_selection=selection, **options)
        auto = sl.pathtrace.path_trace(world, SIZE, 256, seed=2, **options)
        z = (tiles(own.radiance) - tiles(auto.radiance)) * TILE
        z /= np.sqrt(tiles(own.variance + auto.variance)) + 1e-7
        assert np.abs(z).max() < 5 and np.sqrt((z**2).mean()) < 1.4


def test_white_furnace_is_white():
    things = [
        thing(mesh.box((0.7, 0.9, 0.5)), lambert(1, 1, 1), turn=0.5),
        thing(mesh.plane((4, 4)), lambert(1, 1, 1), (0, -0.5, 0)),
    ]
    # Flat faces: where shading normals are bent, directions below the face are lost.
    world = scene.Scene(things, (), scene.Camera((0, 1, 3), (0, 0, 0)), background=(1, 1, 1))
    traced = sl.pathtrace.path_trace(world, (24, 16), samples=256, max_depth=200)
    # Each path carries one, which no roulette ends, until it leaves: no noise at all, but for rounding.
    assert np.abs(traced.radiance - 1).max() < 1e-4


@pytest.mark.parametrize("compensation", ["kulla_conty", "scaled"])
@pytest.mark.parametrize("make", ["RoughDielectric", "Principled"])
def test_a_furnace_hides_rough_glass_that_loses_nothing(make, compensation):
    """In its walls light is reflected some four times; without compensation a third of it is lost."""
    glass = {
        "RoughDielectric": lambda form: brdf.RoughDielectric(0.7, compensation=form),
        "Principled": lambda form: brdf.Principled(
            1.0, roughness=0.7**0.5, spec_trans=1.0, form="2015", compensation=form
        ),
    }[make]
    camera = scene.Camera((0, 1, 3), (0, 0, 0), fov_y=0.3)

    def mean(form):
        world = scene.Scene(thing(mesh.box((1.5, 1.2, 0.9)), glass(form), turn=0.5), (), camera, background=(1, 1, 1))
        return sl.pathtrace.path_trace(world, (32, 32), samples=512, max_depth=200).radiance.mean()

    # The table's error a few times over, and noise.
    assert mean(compensation) == pytest.approx(1, abs=0.01)
    assert mean("none") < 0.8


@pytest.mark.parametrize("roughness", [0.0, 0.5, 1.0])
def test_furnace_gains_nothing_from_any_material(roughness):
    material = scene.Material((1, 1, 1), metallic=0.0, roughness=roughness)
    ball = scene.Scene(thing(mesh.icosphere(3), material), (), scene.Camera((0, 0, 3), (0, 0, 0)), background=(1, 1, 1))
    traced = sl.pathtrace.path_trace(ball, (32, 32), samples=256, max_depth=64)
    tile = tiles(traced.radiance)
    assert (tile < 1 + 4 * np.sqrt(tiles(traced.variance)) / TILE + 1e-5).all()
    assert tile.mean() > 0.5


def test_an_emitting_mesh_is_a_rectangle_light():
    lamp = RectLight((0, 1.5, 0), (1, 0, 0), (0, 0, 1), (4, 3, 2))
    glow = scene.Material((0, 0, 0), specular=0.0, emission=(4, 3, 2))
    floor = thing(mesh.plane((4, 4)), scene.Material((0.6, 0.5, 0.4), roughness=0.4))
    ball = thing(mesh.icosphere(2, 0.3), lambert(0.5, 0.5, 0.5), (0, 0.4, 0))
    camera = scene.Camera((0, 1.2, 3), (0, 0.4, 0))
    light = sl.pathtrace.path_trace(scene.Scene([floor, ball], lamp, camera), SIZE, 256, 3, seed=1)
    panel = thing(mesh.plane((1, 1)), glow, (0, 1.5, 0))
    emitting = sl.pathtrace.path_trace(scene.Scene([floor, ball, panel], (), camera), SIZE, 256, 3, seed=2)
    # The mesh glows upwards too, and nothing is there to show it.
    z = (tiles(light.radiance) - tiles(emitting.radiance)) * TILE
    z /= np.sqrt(tiles(light.variance + emitting.variance)) + 1e-6
    assert np.abs(z).max() < 4.5 and np.sqrt((z**2).mean()) < 1.4


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_threads_and_levels_change_no_bit(dtype):
    results, before = [], sl.threads()
    for level in sl.simd_levels():
        for threads in (1, 3):
            with sl.simd(level):
                sl.set_threads(threads)
                results.append(sl.pathtrace.path_trace(spheres(), (24, 16), samples=4, dtype=dtype))
    sl.set_threads(before)
    assert results[0].radiance.dtype == dtype
    assert all(np.array_equal(r.radiance, results[0].radiance) for r in results)
    assert all(np.array_equal(r.variance, results[0].variance) for r in results)


def test_precisions_agree_within_noise():
    single, double = (sl.pathtrace.path_trace(spheres(), SIZE, 64, dtype=d) for d in (np.float32, np.float64))
    z = tiles(single.radiance - double.radiance) * TILE / np.sqrt(tiles(single.variance + double.variance) + 1e-10)
    # The same random numbers, so much closer than independent pictures would be.
    assert np.abs(z).max() < 1


def test_runs_merge_and_variance_is_that_of_the_mean():
    world = punctual()
    whole = sl.pathtrace.path_trace(world, (24, 16), 64, seed=5)
    parts = [sl.pathtrace.path_trace(world, (24, 16), 32, seed=5, start=s) for s in (0, 32)]
    merged = parts[0].merge(parts[1])
    assert (merged.samples == 64).all()
    assert np.allclose(merged.radiance, whole.radiance, rtol=1e-5, atol=1e-7)
    assert np.allclose(merged.variance, whole.variance, rtol=1e-4, atol=1e-9)
    # Against the spread of independent pictures.
    several = [sl.pathtrace.path_trace(world, (24, 16), 16, seed=s, sampler="independent") for s in range(32)]
    stated = np.mean([traced.variance.mean() for traced in several[:4]])
    assert stated == pytest.approx(np.var([t.radiance for t in several], axis=0, ddof=1).mean(), rel=0.1)


@pytest.mark.parametrize("sampler", get_args(Sampler))
def test_samplers_agree_and_points_that_spread_err_less(sampler):
    world = cornell()
    reference = sl.pathtrace.path_trace(world, (24, 16), 4096, 3, seed=9, sampler="independent")
    runs = np.stack([sl.pathtrace.path_trace(world, (24, 16), 64, 3, s, sampler=sampler).radiance for s in range(8)])
    error = runs.astype(np.float64) - reference.radiance
    independent = 64 * reference.variance.mean() * 64
    spread = 64 * runs.var(0, ddof=1, dtype=np.float64).mean()
    if sampler == "independent":
        assert spread == pytest.approx(independent, rel=0.15)
    elif sampler not in ("latin_hypercube", "r2"):
        # The box's edges and what is reflected several times are left.
        assert spread < 0.75 * independent
    # The mean of each pixel, whose error is mostly the reference's.
    z = error.mean(0) / np.sqrt(runs.var(0, ddof=1) / 8 + reference.variance + 1e-12)
    assert np.sqrt((z**2).mean()) < 1.3


def test_stops_at_the_target_error():
    coarse = sl.pathtrace.path_trace(punctual(), (24, 16), 4096, target_error=0.05)
    fine = sl.pathtrace.path_trace(punctual(), (24, 16), 4096, target_error=0.01)
    assert coarse.samples.mean() < fine.samples.mean() < 4096 and coarse.samples.min() >= 32
    assert np.sqrt(fine.variance.mean()) <= 0.01 * fine.radiance.mean()


def test_depth_zero_shows_emission_alone_and_depth_adds_light():
    world = cornell()
    pictures = [sl.pathtrace.path_trace(world, SIZE, 16, max_depth=d).radiance.mean() for d in (0, 1, 2, 8)]
    assert pictures == sorted(pictures)
    lamp = RectLight((0, 0, 0), (9, 0, 0), (0, 9, 0), (12, 10, 8))
    facing = scene.Scene(mesh.box((1, 1, 1)).transformed(sl.transform.translate((0, 0, -1))), lamp, world.camera)
    emission = sl.pathtrace.path_trace(facing, SIZE, 16, max_depth=0)
    assert np.allclose(emission.radiance, (12, 10, 8), rtol=1e-6) and emission.variance.max() < 1e-9


def test_even_light_is_the_same_whatever_its_name():
    ball, shade = mesh.icosphere(2), (0.5, 1.0, 0.25)
    camera = scene.Camera((0, 0, 3), (0, 0, 0))
    sky = sl.environment.Environment(np.full((4, 8, 3), shade, np.float32))
    options = {"size": (16, 12), "samples": 8, "max_depth": 3}
    wanted = sl.pathtrace.path_trace(scene.Scene(ball, (), camera, background=shade), **options).radiance
    for lit in (
        scene.Scene(ball, sl.light.AmbientLight(shade), camera),
        scene.Scene(ball, (), camera, environment=sky),
    ):
        assert np.array_equal(sl.pathtrace.path_trace(lit, **options).radiance, wanted)


def test_wrong_calls_name_the_argument():
    world = punctual()
    with pytest.raises(ValueError, match="size: expected an integer"):
        sl.pathtrace.path_trace(world, (0, 4))
    with pytest.raises(ValueError, match="samples: expected an integer"):
        sl.pathtrace.path_trace(world, (4, 4), 0)
    with pytest.raises(ValueError, match="target_error: expected a number"):
        sl.pathtrace.path_trace(world, (4, 4), 1, target_error=0)


def test_a_bvh_of_other_vertices_is_refused():
    ball, other = (scene.Scene(m.astype(np.float32)) for m in (mesh.icosphere(1), mesh.icosphere(1, radius=2.0)))
    arrays, wrong = ball.flatten(), other.flatten()
    same = sl.accel.BVH(arrays.positions, arrays.faces)
    assert sl.pathtrace.path_trace(ball, (4, 4), samples=1, bvh=same).samples.max() == 1
    for bvh in (
        sl.accel.BVH(wrong.positions, wrong.faces),
        sl.accel.BVH(arrays.positions, np.roll(arrays.faces, 1, axis=1)),
    ):
        with pytest.raises(ValueError, match="bvh: expected one of the flattened scene"):
            sl.pathtrace.path_trace(ball, (4, 4), samples=1, bvh=bvh)
    with pytest.raises(TypeError, match="bvh: expected a BVH"):
        sl.pathtrace.path_trace(ball, (4, 4), samples=1, bvh=5)
    with pytest.raises(TypeError, match="bvh: expected a BVH"):
        sl.pathtrace.direct_light(5, [], [0.0, 0, 0], [0.0, 1, 0], [0.5] * 3, eye=[0.0, 1, 0])


def spot_seen(world, depth, strategy, samples=1024, **options):
    """The mean of 16 × 16 pixels that see nearly the same, and its standard error."""
    options = {"strategy": strategy, "seed": 11, "dtype": np.float64, **options}
    traced = sl.pathtrace.path_trace(world, (16, 16), samples, depth, **options)
    pixels = traced.radiance.mean(-1)
    return pixels.mean(), pixels.std(ddof=1) / 16


def agree(world, depth=1, **options):
    seen = np.array([spot_seen(world, depth, s, **options) for s in get_args(Strategy)])
    # Scrambled points err alike over pixels hardly at all: five standard errors, and what rounding leaves.
    bound = 5 * np.hypot(seen[:, 1], seen[0, 1]) + 1e-6 * seen[0, 0]
    np.testing.assert_array_less(np.abs(seen[:, 0] - seen[0, 0]), bound + 1e-12)
    return seen[0, 0]


def open_floor(material, lights=(), **surroundings):
    floor = scene.Instance(mesh.plane((40, 40)), None, (material,))
    return scene.Scene([floor], lights, scene.Camera((2, 2, 0), (0, 0, 0), fov_y=0.02), **surroundings)


HIDING = {
    "rectangle": light.RectLight((0, 1, 0), (1, 0, 0), (0, 0, 1), (1,) * 3),
    "sphere": light.SphereLight((0, 1, 0), 0.4, (1,) * 3),
}


@pytest.mark.parametrize("near", HIDING)
@pytest.mark.parametrize("behind", ["panel", "point", "sky", "mesh"])
def test_a_light_before_another_hides_it_however_it_is_looked_for(near, behind):
    panel = light.RectLight((0, 2, 0), (4, 0, 0), (0, 0, 4), (5,) * 3)
    others = {"panel": (panel,), "point": (light.PointLight((0, 3, 0), (9,) * 3),)}.get(behind, ())
    more = {}
    if behind == "sky":
        pixels = np.ones((8, 16, 3))
        pixels[:3] = 4
        more["environment"] = Environment(pixels)
    world = open_floor(brdf.Diffuse((0.8,) * 3), (HIDING[near], *others), **more)
    if behind == "mesh":
        glow = scene.Material((0, 0, 0), emission=(5.0,) * 3)
        ceiling = scene.Instance(mesh.plane((4, 4)), sl.transform.translate((0, 2, 0)), (glow,))
        world = scene.Scene([*world.instances, ceiling], world.lights, world.camera)
    both = agree(world)
    alone = agree(open_floor(brdf.Diffuse((0.8,) * 3), (HIDING[near],)))
    if behind == "point":
        # It stands right behind: only the near one is left.
        assert both == pytest.approx(alone, rel=1e-3)
    else:
        assert both > 1.5 * alone


MIXED = {
    "plastic": brdf.Plastic((0.5,) * 3),
    "nonlinear": brdf.Plastic((1.0,) * 3, nonlinear=True),
    "pane": brdf.RoughDielectric(0.3, 1.0),
    "glass": brdf.RoughDielectric(0.3, 1.5),
    "compensated pane": brdf.RoughDielectric(0.8, 1.0, compensation="kulla_conty"),
    "compensated glass": brdf.RoughDielectric(0.8, 1.5, compensation="kulla_conty"),
    "compensated principled": brdf.Principled(
        (0.5,) * 3, roughness=0.8, spec_trans=0.5, form="2015", compensation="kulla_conty"
    ),
    "principled": brdf.Principled((0.5,) * 3, eta=1.0, spec_trans=0.5, form="2015"),
}


@pytest.mark.parametrize("name", MIXED)
def test_strategies_agree_where_mirrors_lie_over_rough_ground(name):
    assert agree(open_floor(MIXED[name], background=(1, 1, 1)), samples=256) > 0.1
