"""Frames: unshadowed light in closed form times visibility, buffers that agree, pictures that open."""

import io
import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import shadelab as sl
from shadelab.light import DirectionalLight, PointLight, RectLight
from shadelab.scene import Camera, Instance, Material, Scene

SIZE = (160, 90)
CAMERA = Camera((2, 3, 5), (0, 0.4, 0))
MATTE = Material((0.6, 0.5, 0.4), roughness=1.0)
GROUND = Instance(sl.mesh.plane(8.0), None, MATTE)
BOX = Instance(sl.mesh.box(), sl.transform.translate([0, 0.5, 0]), MATTE)
AREA = RectLight(center=(1, 4, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 1), radiance=(9, 9, 9))


@pytest.fixture(scope="module")
def frame():
    return sl.render(Scene([GROUND, BOX], AREA, CAMERA), size=SIZE)


def test_buffers_agree_with_rays(frame):
    arrays = Scene([GROUND, BOX], AREA, CAMERA).flatten(np.float64)
    origins, directions = CAMERA.rays(SIZE)
    hit = sl.accel.BVH(arrays.positions, arrays.faces).closest_hit(origins, directions)
    # Off silhouettes; a face's edge of 1/256 pixel at most.
    same = frame.face == hit.face
    assert same.mean() > 0.995
    seen = same & (hit.face >= 0)
    position = origins + hit.t[..., None] * directions
    assert np.allclose(frame.position[seen], position[seen], atol=2e-5)
    forward = -CAMERA.view()[2, :3]
    assert np.allclose(frame.depth[seen], ((position - origins) @ forward)[seen], atol=2e-5)
    assert np.isinf(frame.depth[frame.face < 0]).all() and np.isnan(frame.position[frame.face < 0]).all()
    assert np.allclose(np.linalg.norm(frame.normal[seen], axis=-1), 1, atol=1e-5)
    assert (np.einsum("ij,ij->i", frame.normal[seen], directions[seen]) < 1e-6).all()


def test_unshadowed_light_is_that_of_the_closed_form(frame):
    # Filters of moments leave traces of shadow everywhere.
    lit = (frame.lit[0] > 0.995) & (frame.face >= 0)
    assert lit.mean() > 0.2
    expected = sl.light.unshadowed(
        AREA, frame.position[lit], frame.normal[lit], MATTE.base_color, 0.0, 1.0, eye=CAMERA.eye, samples=1024
    )
    # The plan states how far its choice for the material is off, and keeps to 2 % by itself.
    (stated,) = {way.error for way in frame.plan.shading}
    assert 0 < stated < 0.02
    apart = np.sqrt(np.mean((frame.radiance[lit] - expected) ** 2)) / expected.mean()
    assert apart < 1.3 * stated


def test_shadowed_light_is_about_that_of_rays(frame):
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    arrays = scene.flatten(np.float32)
    seen = frame.face >= 0
    corners = arrays.positions[arrays.faces[frame.face[seen]]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    exact = sl.shadow.ray_traced(
        sl.accel.BVH(arrays.positions, arrays.faces), frame.position[seen], normals, AREA, samples=256
    )
    apart = np.abs(frame.lit[0][seen] - exact)
    facing = frame.radiance[seen].sum(-1) > 0
    # Percentage-closer soft shadows of a box on the ground: 1 % on average, noise and all.
    assert apart[facing].mean() < 0.02
    assert (frame.lit[0] < 0.05).any() and ((frame.lit[0] > 0.2) & (frame.lit[0] < 0.8)).any()


def test_soft_shadows_of_the_default_scene_are_about_those_of_rays():
    # Casters near and far from the light: a blocker search that misses some leaks light into the umbrae.
    scene, size = sl.scene.default(), (320, 180)
    knobs = {"resolution": 1024, "blocker_samples": 16, "filter_samples": 32}
    choice = SimpleNamespace(technique="pcss", knobs=knobs, error=0.1, ms=1.0)
    evidence = SimpleNamespace(pick=lambda **bounds: choice)
    soft = sl.render(scene, sl.plan(scene, size, max_error=0.1, evidence=evidence))
    assert soft.plan.find("shadow").settings["technique"] == "pcss"
    kept = [p for p in soft.plan.passes if not p.name.startswith("shadow")]
    rays = sl.renderer.Pass("shadow", "the reference", {"technique": "ray_traced", "samples": 64})
    kept[1:1] = [sl.renderer.Pass("bvh", "for rays"), rays]
    exact = sl.render(scene, sl.renderer.Plan(tuple(kept), (), size))
    seen = soft.face >= 0
    apart = np.abs(soft.lit[0] - exact.lit[0])[seen]
    assert apart.mean() < 0.03
    dark = exact.lit[0][seen] == 0
    assert dark.mean() > 0.02 and soft.lit[0][seen][dark].mean() < 0.03


def test_every_pass_is_timed_and_reported():
    told = []
    f = sl.render(
        Scene([GROUND, BOX], AREA, CAMERA), size=SIZE, progress=lambda done, total: told.append((done, total))
    )
    assert list(f.times) == [p.name for p in f.plan.passes] and min(f.times.values()) > 0
    assert told == [(i + 1, 4) for i in range(4)]


def test_surroundings_and_emission_add_up():
    glow = Instance(sl.mesh.box(), sl.transform.translate([0, 0.5, 0]), Material((0.5, 0.5, 0.5), emission=(1, 2, 3)))
    f = sl.render(Scene([glow], (), CAMERA, background=(0.2, 0.4, 0.8)), size=SIZE)
    seen = f.face >= 0
    share = (f.radiance[seen] - np.array([1, 2, 3])) / np.array([0.2, 0.4, 0.8])
    # What the material reflects of even light, on the average over where it is seen.
    cosine = np.einsum("ij,ij->i", f.normal[seen], np.asarray(CAMERA.eye, np.float32) - f.position[seen])
    cosine /= np.linalg.norm(np.asarray(CAMERA.eye) - f.position[seen], axis=-1)
    wo = np.stack([np.sqrt(1 - cosine**2), np.zeros_like(cosine), cosine], -1)
    model = sl.brdf.MetallicRoughness((0.5, 0.5, 0.5))
    exact = sl.brdf.directional_albedo(model, wo.astype(np.float64), 256)
    assert np.abs(share.mean() - exact.mean()) < 5e-3 and np.abs(share - exact).max() < 0.02
    assert np.allclose(f.radiance[~seen], [0.2, 0.4, 0.8], rtol=1e-6)
    assert f.lit == ()


def test_an_empty_scene_is_its_background():
    f = sl.render(Scene([], AREA, CAMERA, background=(0.25, 0.5, 0.75)), size=(8, 4))
    assert f.radiance.shape == (4, 8, 3) and (f.radiance == [0.25, 0.5, 0.75]).all()
    assert (f.face == -1).all() and f.lit[0].shape == (4, 8)


@pytest.mark.parametrize("technique", ["hard", "pcf", "pcss", "ray_traced"])
def test_each_technique_of_a_plan_is_run(technique):
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    made = sl.plan(scene, SIZE)
    passes = [
        sl.renderer.Pass(p.name, p.reason, {"technique": technique} if p.name == "shadow" else p.settings)
        for p in made.passes
    ]
    if technique == "ray_traced":
        passes.insert(1, sl.renderer.Pass("bvh", "for rays"))
    f = sl.render(scene, sl.renderer.Plan(tuple(passes), (), SIZE))
    values = np.unique(f.lit[0])
    assert values.min() == 0 and values.max() == 1
    assert (len(values) == 2) == (technique == "hard")


def test_several_lights_add_up():
    lamps = [AREA, PointLight((-6, 8, 2), (90, 60, 30))]
    together = sl.render(Scene([GROUND, BOX], lamps, CAMERA), size=SIZE)
    alone = [sl.render(Scene([GROUND, BOX], lamp, CAMERA), size=SIZE) for lamp in lamps]
    assert np.allclose(together.radiance, alone[0].radiance + alone[1].radiance, rtol=1e-5, atol=1e-6)
    assert len(together.lit) == 2 and np.array_equal(together.lit[1], alone[1].lit[0])


def test_the_same_seed_gives_the_same_bits_whatever_the_threads():
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    before, frames = sl.threads(), []
    try:
        for n in (1, 3):
            sl.set_threads(n)
            frames.append(sl.render(scene, sl.plan(scene, SIZE, max_error=0.04), seed=4))
    finally:
        sl.set_threads(before)
    assert np.array_equal(frames[0].radiance, frames[1].radiance) and str(frames[0].plan) == str(frames[1].plan)
    assert not np.array_equal(frames[0].radiance, sl.render(scene, frames[0].plan, seed=5).radiance)


def test_shows_itself_as_a_picture(frame, tmp_path):
    from PIL import Image

    shown = frame.display()
    assert shown.shape == (90, 160, 3) and shown.dtype == np.uint8 and 20 < shown.mean() < 235
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(frame._repr_png_()))), shown)
    frame.save(tmp_path / "a.png")
    assert np.array_equal(np.asarray(Image.open(tmp_path / "a.png")), shown)
    frame.save(tmp_path / "a.exr")
    assert np.allclose(sl.scene.load_image(tmp_path / "a.exr"), frame.radiance, rtol=1e-6)
    # Twice the exposure is brighter; an explicit one does not look at the frame.
    assert frame.display(exposure=0.2).mean() < frame.display(exposure=0.4).mean()
    with pytest.raises(ValueError, match="exposure"):
        frame.display(exposure=0.0)


def test_a_plan_of_another_scene_is_refused():
    scene = Scene([GROUND, BOX], [AREA, AREA], CAMERA)
    made = sl.plan(scene, SIZE)
    with pytest.raises(ValueError, match="made for another scene, with 2 lights instead of 1"):
        sl.render(Scene([GROUND, BOX], [AREA], CAMERA), made)
    with pytest.raises(TypeError, match="plan: expected a Plan"):
        sl.render(scene, "fast")


@pytest.mark.parametrize("length", [1e-300, 1e300])
def test_lights_far_from_unit_length_shine_alike(length):
    def picture(y):
        return sl.render(Scene([GROUND, BOX], DirectionalLight((0, y, 0), (3, 3, 3)), CAMERA), size=(32, 18)).radiance

    assert np.array_equal(picture(-length), picture(-1.0)) and picture(-1.0).max() > 0.1


def test_plans_fit_their_scene_and_size():
    one, none = Scene([GROUND, BOX], AREA, CAMERA), Scene([GROUND, BOX], [], CAMERA)
    two = Scene([GROUND, BOX], [AREA, AREA], CAMERA)
    for made, other in ((one, none), (one, two), (two, one), (none, one)):
        with pytest.raises(ValueError, match="plan: made for another scene"):
            sl.render(other, sl.plan(made, SIZE))
    by_hand = replace(sl.plan(two, SIZE), lights=None)
    with pytest.raises(ValueError, match="plan: made for another scene"):
        sl.render(one, by_hand)
    with pytest.raises(ValueError, match="plan: made for another size"):
        sl.render(one, sl.plan(one, SIZE), (8, 8))
    assert sl.render(one, sl.plan(one, (8, 6)), (8, 6)).radiance.shape == (6, 8, 3)


@pytest.mark.parametrize("seed", [-1, 2**64])
def test_seeds_out_of_range_are_refused(seed):
    with pytest.raises(ValueError, match="seed"):
        sl.render(Scene([GROUND, BOX], AREA, CAMERA), size=(8, 8), seed=seed)


def test_warns_where_single_precision_loses_the_scene():
    away, aside = np.array([1e8, 0, 0]), np.array([2, 3, 5])
    camera = Camera(tuple(away + aside), tuple(away))
    far = Scene(Instance(sl.mesh.box(), sl.transform.translate(away)), AREA, camera)
    for f in (sl.plan, sl.render):
        with pytest.warns(RuntimeWarning, match="float32 loses its shape") as caught:
            f(far, size=(8, 8))
        assert [w.filename for w in caught] == [__file__]
    with pytest.warns(RuntimeWarning, match="float32 loses its shape") as caught:
        sl.pathtrace.path_trace(far, (4, 4), samples=1)
    assert caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sl.pathtrace.path_trace(far, (4, 4), samples=1, dtype=np.float64)
        sl.render(Scene([GROUND, BOX], AREA, CAMERA), size=(8, 8))
