"""Path tracing: Mitsuba's pictures by z-scores, furnaces, and the same bits whatever the threads and the SIMD level."""

from typing import get_args

import numpy as np
import pytest
import shadelab as sl
from shadelab import mesh, scene
from shadelab.light import DirectionalLight, PointLight, RectLight
from shadelab.pathtrace.paths import Sampler

SIZE = (48, 32)
TILE = 8


def lambert(*color):
    return scene.Material(color, specular=0.0)


def thing(shape, material, at=(0.0, 0.0, 0.0), turn=0.0):
    matrix = sl.transform.translate(at) @ sl.transform.rotate_axis((0, 1, 0), turn)
    return scene.Instance(shape, matrix, (material,))


def cornell():
    """A box open to the front, two blocks, a rectangle under a plate, seen from above the light's plane."""
    white, red, green = lambert(0.7, 0.7, 0.7), lambert(0.6, 0.1, 0.1), lambert(0.1, 0.5, 0.1)
    wall = mesh.box((0.1, 2.2, 2.0))
    things = [
        thing(mesh.box((2.2, 0.1, 2.0)), white, (0, -1.05, 0)),
        thing(mesh.box((2.2, 0.1, 2.0)), white, (0, 1.05, 0)),
        thing(mesh.box((2.2, 2.2, 0.1)), white, (0, 0, -1.05)),
        thing(wall, red, (-1.05, 0, 0)),
        thing(wall, green, (1.05, 0, 0)),
        thing(mesh.box((0.6, 0.02, 0.6)), lambert(0, 0, 0), (0, 0.82, 0)),
        thing(mesh.box((0.5, 0.6, 0.5)), white, (0.4, -0.7, 0.3), -0.3),
        thing(mesh.box((0.5, 1.2, 0.5)), white, (-0.4, -0.4, -0.3), 0.4),
    ]
    lamp = RectLight((0, 0.8, 0), (0.6, 0, 0), (0, 0, 0.6), (12, 10, 8))
    return scene.Scene(things, (lamp,), scene.Camera((0, 0.85, 4.2), (0, -0.1, 0), fov_y=0.6))


def spheres():
    """Metal balls on a diffuse floor, under a plate with a rectangle below it, in an even sky."""
    ball = mesh.icosphere(4, 0.5)
    things = [
        thing(mesh.plane((6, 6)), lambert(0.5, 0.4, 0.3), (0, -0.5, 0)),
        thing(ball, scene.Material((1, 1, 1), metallic=1.0, roughness=0.3), (-0.6, 0, 0)),
        thing(ball, scene.Material((1, 1, 1), metallic=1.0, roughness=0.2), (0.6, 0, 0.2)),
        thing(mesh.box((1.2, 0.02, 1.2)), lambert(0, 0, 0), (0, 2.02, 0)),
    ]
    lamp = RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1), (4, 4, 5))
    camera = scene.Camera((0, 1.2, 3.2), (0, 0, 0), fov_y=0.7)
    return scene.Scene(things, (lamp,), camera, background=(0.3, 0.4, 0.5))


def punctual():
    """Blocks under a point and a distant light, interreflecting."""
    things = [
        thing(mesh.plane((6, 6)), lambert(0.7, 0.6, 0.5), (0, -0.5, 0)),
        thing(mesh.box((0.6, 1.0, 0.6)), lambert(0.2, 0.4, 0.7), (-0.5, 0, 0), 0.5),
        thing(mesh.torus(0.4, 0.15), lambert(0.8, 0.3, 0.3), (0.6, -0.2, 0.3)),
    ]
    lights = (PointLight((1.5, 1.5, 1.0), (6, 5, 4)), DirectionalLight((0.5, -1.0, -0.4), (1.0, 1.2, 1.5)))
    return scene.Scene(things, lights, scene.Camera((0, 1.5, 3.0), (0, -0.1, 0), fov_y=0.7))


def ply(path, arrays, material):
    """One material's faces as Mitsuba reads them, with their normals."""
    used, faces = np.unique(arrays.faces[arrays.material_ids == material], return_inverse=True)
    faces = faces.reshape(-1, 3)
    names = "x y z nx ny nz".split()
    head = ["ply", "format ascii 1.0", f"element vertex {len(used)}", *(f"property float {n}" for n in names)]
    head += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    rows = np.concatenate([arrays.positions[used], arrays.normals[used]], -1)
    lines = [" ".join(map(repr, map(float, row))) for row in rows] + [f"3 {a} {b} {c}" for a, b, c in faces]
    path.write_text("\n".join(head + lines) + "\n")


def mitsuba_scene(mi, world, folder, depth):
    """The same scene for Mitsuba, whose depth counts one more."""
    transform, rgb = mi.ScalarTransform4f, lambda c: {"type": "rgb", "value": [float(x) for x in c]}
    camera = world.camera
    to_world = transform().look_at(origin=camera.eye, target=camera.target, up=camera.up)
    film = {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    out = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": depth + 1, "rr_depth": 100},
        "sensor": {"type": "perspective", "fov": np.degrees(camera.fov_y), "fov_axis": "y", "to_world": to_world},
    }
    out["sensor"] |= {"film": film, "sampler": {"type": "independent"}}
    arrays = world.flatten(np.float32)
    for i, m in enumerate(arrays.materials):
        if m.metallic == 1:
            bsdf = {"type": "roughconductor", "material": "none", "alpha": m.roughness**2, "distribution": "ggx"}
        else:
            assert m.specular == 0
            bsdf = {"type": "diffuse", "reflectance": rgb(m.base_color)}
        ply(folder / f"{i}.ply", arrays, i)
        shape = {"type": "ply", "filename": str(folder / f"{i}.ply"), "bsdf": {"type": "twosided", "inner": bsdf}}
        out[f"shape{i}"] = shape
    for i, light in enumerate(world.lights):
        if isinstance(light, PointLight):
            out[f"light{i}"] = {"type": "point", "position": light.position, "intensity": rgb(light.intensity)}
        elif isinstance(light, DirectionalLight):
            kind = {"type": "directional", "direction": light.direction}
            out[f"light{i}"] = kind | {"irradiance": rgb(light.irradiance)}
        else:
            matrix = np.eye(4)
            matrix[:3] = np.stack(
                [np.divide(light.edge_u, 2), np.divide(light.edge_v, 2), light.normal, light.center], 1
            )
            shape = {
                "type": "rectangle",
                "to_world": transform(matrix),
                "bsdf": {"type": "diffuse", "reflectance": 0.0},
            }
            out[f"light{i}"] = shape | {"emitter": {"type": "area", "radiance": rgb(light.radiance)}}
    if any(world.background):
        out["sky"] = {"type": "constant", "radiance": rgb(world.background)}
    return mi.load_dict(out)


def tiles(picture):
    h, w, c = picture.shape
    return picture.astype(np.float64).reshape(h // TILE, TILE, w // TILE, TILE, c).mean((1, 3))


@pytest.mark.parametrize("build", [cornell, spheres, punctual])
def test_agrees_with_mitsuba_within_monte_carlo_error(build, tmp_path):
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    world, depth = build(), 4
    theirs = mitsuba_scene(mi, world, tmp_path, depth)
    runs = np.stack([tiles(np.array(mi.render(theirs, spp=48, seed=s))) for s in range(16)])
    other, other_variance = runs.mean(0), runs.var(0, ddof=1) / len(runs)
    ours = sl.pathtrace.path_trace(world, SIZE, samples=2048, max_depth=depth, seed=1)
    mean, variance = tiles(ours.radiance), tiles(ours.variance) / TILE**2
    # Where every path carries the same (the sky, black), the pictures differ by single precision's rounding.
    sigma = np.sqrt(variance + other_variance + (1e-6 * mean) ** 2 + 1e-20)
    z = (mean - other) / sigma
    # 72 scores at 15 degrees of freedom for most of their variance: 5 has a chance of 1e-2, and the seeds are fixed.
    assert np.abs(z).max() < 5, z
    assert np.sqrt((z**2).mean()) < 1.6
    # The whole picture, per channel: a bias of 0.5 % would show at three sigma.
    total = (mean - other).mean((0, 1))
    error = np.sqrt((sigma**2).sum((0, 1))) / sigma[..., 0].size
    assert (error < 0.005 / 3 * mean.mean((0, 1))).all()
    assert (np.abs(total) < 4 * error).all()


def test_white_furnace_is_white():
    things = [
        thing(mesh.icosphere(2, 0.5), lambert(1, 1, 1)),
        thing(mesh.plane((4, 4)), lambert(1, 1, 1), (0, -0.5, 0)),
    ]
    world = scene.Scene(things, (), scene.Camera((0, 1, 3), (0, 0, 0)), background=(1, 1, 1))
    traced = sl.pathtrace.path_trace(world, (24, 16), samples=256, max_depth=200)
    # Each path carries exactly one until roulette (from the fourth reflection, 5 % a time) makes noise of it.
    assert np.abs(traced.radiance - 1).max() < 0.1
    error = np.sqrt(traced.variance.mean() / traced.radiance[..., 0].size)
    assert abs(traced.radiance.mean() - 1) < 4 * error + 1e-5


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
    assert merged.samples == 64
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
    elif sampler != "latin_hypercube":
        assert spread < 0.5 * independent
    # The mean of each pixel, whose error is mostly the reference's.
    z = error.mean(0) / np.sqrt(runs.var(0, ddof=1) / 8 + reference.variance + 1e-12)
    assert np.sqrt((z**2).mean()) < 1.3


def test_stops_at_the_target_error():
    coarse = sl.pathtrace.path_trace(punctual(), (24, 16), 4096, target_error=0.05)
    fine = sl.pathtrace.path_trace(punctual(), (24, 16), 4096, target_error=0.01)
    assert coarse.samples < fine.samples < 4096
    assert np.sqrt(fine.variance.mean()) <= 0.01 * fine.radiance.mean()


def test_depth_zero_shows_emission_alone_and_depth_adds_light():
    world = cornell()
    pictures = [sl.pathtrace.path_trace(world, SIZE, 16, max_depth=d).radiance.mean() for d in (0, 1, 2, 8)]
    assert pictures == sorted(pictures)
    lamp = RectLight((0, 0, 0), (9, 0, 0), (0, 9, 0), (12, 10, 8))
    facing = scene.Scene(mesh.box((1, 1, 1)).transformed(sl.transform.translate((0, 0, -1))), lamp, world.camera)
    emission = sl.pathtrace.path_trace(facing, SIZE, 16, max_depth=0)
    assert np.allclose(emission.radiance, (12, 10, 8), rtol=1e-6) and emission.variance.max() < 1e-9


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
    assert sl.pathtrace.path_trace(ball, (4, 4), samples=1, bvh=same).samples == 1
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
