"""What the camera sees beside light: against Mitsuba's AOVs, ray casts, and motion worked out by hand."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import mesh, scene
from shadelab.pathtrace import PixelFilter, aovs, ray_cast

SIZE = (48, 32)


def place(at, turn=0.0):
    return sl.transform.translate(at) @ sl.transform.rotate_axis((0, 1, 0), turn)


def room(**camera):
    red, blue = scene.Material((0.8, 0.2, 0.1)), scene.Material((0.1, 0.2, 0.7))
    things = [
        scene.Instance(mesh.plane((4, 4)), place((0, -0.5, 0)), blue),
        scene.Instance(mesh.box((0.8, 1.0, 0.8)), place((-0.5, 0, 0), 0.5), red),
        scene.Instance(mesh.icosphere(3, 0.4), place((0.7, 0, 0.2)), (scene.Material((0.3, 0.9, 0.3)),)),
    ]
    return scene.Scene(things, (), scene.Camera((0.4, 1.0, 3.0), (0, 0, 0), fov_y=0.6, **camera))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_centres_see_what_rays_hit(dtype):
    world = room()
    seen = aovs(world, SIZE, dtype=dtype)
    arrays = world.flatten(dtype)
    hit = ray_cast(sl.accel.BVH(arrays.positions, arrays.faces), world.camera, SIZE)
    assert seen.depth.dtype == seen.motion.dtype == dtype
    assert np.array_equal(seen.face, hit.face)
    there = hit.face >= 0
    assert 0.3 < there.mean() < 1
    assert np.array_equal(seen.coverage, there.astype(dtype))
    assert np.array_equal(seen.instance[there], arrays.instance_ids[hit.face[there]])
    assert np.array_equal(seen.material[there], arrays.material_ids[hit.face[there]])
    assert np.allclose(seen.albedo[there], arrays.base_color[seen.material[there]], rtol=1e-6)
    eps = np.finfo(dtype).eps
    _, directions = world.camera.rays(SIZE, dtype=np.float64)
    points = np.asarray(world.camera.eye) + directions * np.where(there, hit.t, 0)[..., None]
    assert np.abs(seen.position - points)[there].max() < 40 * eps
    depth = -(points @ world.camera.view()[2, :3] + world.camera.view()[2, 3])
    assert np.allclose(seen.depth[there], depth[there], rtol=20 * eps)
    assert np.allclose(np.linalg.norm(seen.normal[there], axis=-1), 1, atol=4 * eps)
    # Nothing there, nothing moves.
    assert (
        (seen.face[~there] == -1).all() and (seen.instance[~there] == -1).all() and (seen.material[~there] == -1).all()
    )
    assert np.isinf(seen.depth[~there]).all() and not seen.position[~there].any() and not seen.normal[~there].any()
    assert not seen.motion.any()


def test_means_agree_with_mitsubas(tmp_path):
    """Albedo, position, shading normal and depth of a box-filtered picture, by tiles, with a lens."""
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    from .recursion_scenes import tiles
    from .scenes import mitsuba_scene

    lens = {"aperture": 0.2, "focus_distance": 2.5}
    plain = scene.Scene(
        [
            scene.Instance(i.mesh, i.transform, tuple(scene.Material(m.base_color, specular=0.0) for m in i.materials))
            for i in room().instances
        ],
        (),
        scene.Camera((0.4, 1.0, 3.0), (0, 0, 0), fov_y=0.6, **lens),
    )
    camera = plain.camera
    sensor = {
        "type": "thinlens",
        "aperture_radius": 0.1,
        "focus_distance": 2.5,
        "fov": np.degrees(camera.fov_y),
        "fov_axis": "y",
        "to_world": mi.ScalarTransform4f().look_at(origin=camera.eye, target=camera.target, up=camera.up),
        "film": {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"}},
        "sampler": {"type": "independent"},
    }
    theirs = mitsuba_scene(mi, plain, tmp_path, 1)
    sensor = mi.load_dict(sensor)
    integrator = mi.load_dict({"type": "aov", "aovs": "a:albedo,p:position,n:sh_normal"})
    runs = []
    for s in range(8):
        made = np.array(mi.render(theirs, sensor=sensor, integrator=integrator, spp=64, seed=s))
        runs.append(tiles(made[..., -9:]))
    runs = np.stack(runs)
    mean, error = runs.mean(0), runs.std(0, ddof=1) / np.sqrt(len(runs))
    # Independent runs of ours tell our own error.
    ours = []
    for s in range(8):
        a = aovs(plain, SIZE, 64, seed=s)
        # Positions of all samples, as theirs: misses count as the origin.
        ours.append(tiles(np.concatenate([a.albedo, a.position * a.coverage[..., None], a.normal], -1)))
    ours = np.stack(ours)
    sigma = np.sqrt(error**2 + ours.var(0, ddof=1) / len(ours) + 1e-10)
    z = (ours.mean(0) - mean) / sigma
    # 216 scores, about 14 degrees of freedom each: 6 has a chance of 1e-2; the seeds are fixed.
    assert np.abs(z).max() < 6 and np.sqrt((z**2).mean()) < 1.4


def test_motion_of_a_thing_and_of_the_camera():
    """A card before a camera 4 away: a shift of 0.1 is as many pixels as the picture's height makes of it."""
    card = mesh.plane((1, 1)).transformed(sl.transform.rotate_axis((1, 0, 0), np.pi / 2))
    pixels = 0.1 / 4 * (32 / (2 * np.tan(0.2)))
    camera = scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.4)
    moving = scene.Instance(card, transform_end=sl.transform.translate((0.1, 0, 0)))
    seen = aovs(scene.Scene(moving, (), camera), SIZE, dtype=np.float64)
    there = seen.face >= 0
    assert np.allclose(seen.motion[there], [pixels, 0], atol=1e-9) and not seen.motion[~there].any()
    # The camera's own shift moves things the other way, and the sky not at all.
    shifted = scene.Camera((0, 0.1, 4), (0, 0.1, 0), fov_y=0.4)
    eye = scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.4, end=shifted)
    seen = aovs(scene.Scene(scene.Instance(card), (), eye), SIZE, dtype=np.float64)
    assert np.allclose(seen.motion[there], [0, pixels], atol=1e-9) and np.allclose(seen.motion[~there], 0, atol=1e-9)
    # A turn moves both alike; and the sky's direction goes where the turned camera sees it.
    turned = scene.Camera((0, 0, 4), (0.2, 0, 0), fov_y=0.4)
    seen = aovs(scene.Scene(scene.Instance(card), (), scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.4, end=turned)), SIZE)
    assert (seen.motion[..., 0] < -3).all()


def test_means_over_the_shutter():
    """A card that crosses a pixel's column: coverage is the part of the time that it is there."""
    card = mesh.plane((1, 1)).transformed(sl.transform.rotate_axis((1, 0, 0), np.pi / 2))
    camera = scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.4)
    thing = scene.Instance(card, transform_end=sl.transform.translate((0.5, 0, 0)))
    seen = aovs(scene.Scene(thing, (), camera), SIZE, 256)
    row = seen.coverage[16]
    step = 4 * 2 * np.tan(0.2) / 32
    x = (np.arange(48) + 0.5 - 24) * step
    # The left edge goes from −0.5 to 0, the right one from 0.5 to 1, evenly.
    wanted = np.clip((x + 0.5) / 0.5, 0, 1) * np.clip((1 - x) / 0.5, 0, 1)
    assert np.abs(row - wanted).max() < 0.04
    assert np.allclose(seen.depth[16][row > 0], 4, atol=1e-5)
    closed = scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.4, shutter=(1, 1))
    late = aovs(scene.Scene(thing, (), closed), SIZE, 4).coverage[16]
    assert np.array_equal(late > 0.99, (x - step / 2 > -1e-9) & (x + step / 2 < 1))


def test_filters_and_runs():
    world = room()
    wide = aovs(world, SIZE, 64, filter=PixelFilter("gaussian", 6.0))
    narrow = aovs(world, SIZE, 64, filter=PixelFilter("box", 1e-6))
    edges = (0 < wide.coverage) & (wide.coverage < 1)
    assert edges.sum() > 3 * ((0 < narrow.coverage) & (narrow.coverage < 1)).sum()
    assert np.array_equal(narrow.coverage > 0.5, narrow.face >= 0)
    whole = aovs(world, SIZE, 32, seed=3)
    parts = [aovs(world, SIZE, 16, seed=3, start=s) for s in (0, 16)]
    assert np.allclose((parts[0].albedo + parts[1].albedo) / 2, whole.albedo, atol=1e-6)


def test_threads_and_levels_change_no_bit():
    results, before = [], sl.threads()
    for level in sl.simd_levels():
        for threads in (1, 3):
            with sl.simd(level):
                sl.set_threads(threads)
                results.append(aovs(room(aperture=0.1), (24, 16), 4))
    sl.set_threads(before)
    assert all(np.array_equal(a, b) for r in results for a, b in zip(r, results[0], strict=True))


def test_wrong_calls_name_the_argument():
    with pytest.raises(ValueError, match="samples: expected an integer"):
        aovs(room(), SIZE, -1)
    with pytest.raises(ValueError, match="filter: expected one of"):
        aovs(room(), SIZE, filter="mitchell")
    with pytest.raises(TypeError, match="dtype: expected float32 or float64"):
        aovs(room(), SIZE, dtype=np.int32)
