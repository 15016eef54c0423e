"""Plans: no pass without need, every pass with a reason, and what a study measured where there is one."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import shadelab as sl
from shadelab.light import DirectionalLight, PointLight, RectLight
from shadelab.scene import Camera, Instance, Material, Scene

CAMERA = Camera((3, 3, 6), (0, 0.5, 0))
GROUND = Instance(sl.mesh.plane(8.0))
BOX = Instance(sl.mesh.box(), sl.transform.translate([0, 1.0, 0]))
AREA = RectLight(center=(0, 4, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 1), radiance=(9, 9, 9))


def names(plan):
    return [p.name for p in plan.passes]


def why_not(plan, name):
    return next(x.reason for x in plan.left_out if x.name == name)


def test_an_area_light_over_a_box_needs_a_soft_shadow():
    plan = sl.plan(Scene([GROUND, BOX], AREA, CAMERA))
    assert names(plan) == ["g-buffer", "shadow map", "shadow", "direct light"]
    # One blocker above one receiver: penumbrae of one width.
    assert plan.find("shadow").settings["technique"] == "pcf"
    assert why_not(plan, "ambient") == "the background is black"
    assert why_not(plan, "emission") == "no material shines"
    assert "display" in why_not(plan, "tone map")
    assert all(p.reason for p in plan.passes)


@pytest.mark.parametrize("lamp", [PointLight((0, 8, 0), (9, 9, 9)), DirectionalLight((0, -1, 0), (1, 1, 1))])
def test_no_area_light_no_penumbra(lamp):
    plan = sl.plan(Scene([GROUND, BOX], lamp, CAMERA))
    assert plan.find("shadow").settings["technique"] == "hard"
    assert "no area light" in why_not(plan, "penumbra")


def test_a_light_that_faces_away_gets_no_map():
    away = RectLight(center=(0, 4, 0), edge_u=(0, 0, 1), edge_v=(1, 0, 0), radiance=(9, 9, 9))
    plan = sl.plan(Scene([GROUND, BOX], [AREA, away], CAMERA))
    assert names(plan) == ["g-buffer", "shadow map 0", "shadow 0", "direct light"]
    assert why_not(plan, "shadow map 1") == "it faces away from every surface"
    assert plan.find("direct light").settings["lights"] == (0,)


def test_a_black_light_gets_nothing():
    plan = sl.plan(Scene([GROUND, BOX], PointLight((0, 8, 0), (0, 0, 0)), CAMERA))
    assert names(plan) == ["g-buffer"] and why_not(plan, "direct light") == "it emits nothing"


@pytest.mark.parametrize(
    ("things", "reason"),
    [
        ([GROUND], "one plane"),
        ([BOX], "convex"),
        ([Instance(sl.mesh.icosphere(3), sl.transform.translate([0, 1, 0]))], "convex"),
    ],
)
def test_nothing_in_shadow_range_no_shadow_pass(things, reason):
    plan = sl.plan(Scene(things, AREA, CAMERA))
    assert names(plan) == ["g-buffer", "direct light"] and reason in why_not(plan, "shadow")


@pytest.mark.parametrize(
    "things",
    [
        [Instance(sl.mesh.torus(), sl.transform.translate([0, 1, 0]))],
        [BOX, Instance(sl.mesh.box(0.3), sl.transform.translate([0, 2.5, 0]))],
    ],
)
def test_what_can_shade_itself_keeps_its_shadow(things):
    assert sl.plan(Scene(things, AREA, CAMERA)).find("shadow") is not None


def test_inside_a_convex_body_its_walls_stand_before_the_light():
    room = Scene(Instance(sl.mesh.box(2.0)), AREA, Camera((0, 0, 0.5), (0, 0, 0)))
    assert sl.plan(room).find("shadow") is not None


def test_a_penumbra_narrower_than_a_pixel_is_hard():
    small = RectLight(center=(0, 4, 0), edge_u=(1e-4, 0, 0), edge_v=(0, 0, 1e-4), radiance=(9, 9, 9))
    scene = Scene([GROUND, BOX], small, Camera((0, 40, 80), (0, 0.5, 0)))
    plan = sl.plan(scene)
    assert plan.find("shadow").settings == {"technique": "hard"}
    assert "narrower than a pixel" in why_not(plan, "penumbra")
    # With enough pixels it is worth its pass.
    assert sl.plan(scene, (16384, 16384)).find("shadow").settings["technique"] == "hard"
    wider = RectLight(center=(0, 4, 0), edge_u=(0.05, 0, 0), edge_v=(0, 0, 0.05), radiance=(9, 9, 9))
    close = Scene([GROUND, BOX], wider, Camera((0, 40, 80), (0, 0.5, 0)))
    assert sl.plan(close, (64, 36)).find("shadow").settings["technique"] == "hard"
    fine = sl.plan(close, (7680, 4320))
    assert fine.find("shadow").settings["technique"] != "hard" and "penumbra" not in [x.name for x in fine.left_out]


def test_a_point_light_within_the_scene_has_a_cube_of_maps():
    scene = Scene([GROUND, BOX], PointLight((1, 1, 0), (9, 9, 9)), CAMERA)
    plan = sl.plan(scene)
    assert names(plan) == ["g-buffer", "shadow map", "shadow", "direct light"]
    assert (
        plan.find("shadow map").settings["kind"] == "cube" and "cannot see all around" in plan.find("shadow map").reason
    )
    exact = sl.plan(scene, max_error=0.01)
    assert names(exact) == ["g-buffer", "bvh", "shadow", "direct light"]
    assert exact.find("shadow").settings == {"technique": "ray_traced", "samples": 1}
    assert why_not(exact, "shadow map") == "rays need none"


def test_a_light_to_both_sides_is_traced():
    both = RectLight(center=(0, 1.7, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 1), radiance=(9, 9, 9), two_sided=True)
    lid = Instance(sl.mesh.box((2, 0.1, 2)), sl.transform.translate([0, 3, 0]))
    plan = sl.plan(Scene([GROUND, BOX, lid], both, CAMERA))
    assert plan.find("shadow").settings["technique"] == "ray_traced"


def test_a_light_close_to_surfaces_is_traced():
    """A panel that stands on the floor: a map from its middle sees little of what hides its edges."""
    panel = RectLight((0, 0.6, 0), (1.6, 0, 0), (0, 1, 0), (6, 6, 6))
    ball = Instance(sl.mesh.icosphere(2, 0.25), sl.transform.translate([0.3, 0.25, 1.0]))
    plan = sl.plan(Scene([GROUND, ball], panel, CAMERA))
    assert plan.find("shadow").settings == {"technique": "ray_traced", "samples": 16}
    assert "come as near to the light (0.6) as it is wide (1.9)" in plan.find("shadow").reason
    # A surface behind it, or far before it, does not count.
    above = replace(AREA, center=(0, 4.001, 0))
    ceiling = Instance(sl.mesh.plane(8.0), sl.transform.translate([0, 4.002, 0]))
    plan = sl.plan(Scene([GROUND, BOX, ceiling], above, CAMERA))
    assert plan.find("shadow map") is not None


def test_background_and_emission_get_passes_where_there_are_any():
    glow = Instance(sl.mesh.box(), sl.transform.translate([0, 1.0, 0]), Material(emission=(1, 0, 0)))
    plan = sl.plan(Scene([GROUND, glow], (), CAMERA, background=(0.1, 0.1, 0.1)))
    assert names(plan) == ["g-buffer", "ambient", "emission"]
    assert why_not(plan, "direct light") == "the scene has no lights"


def test_an_empty_scene_is_its_background():
    plan = sl.plan(Scene([], AREA, CAMERA))
    assert names(plan) == ["background"]


class Study:
    """What a study hands over."""

    def __init__(self, technique, **knobs):
        self.choice = SimpleNamespace(technique=technique, knobs=knobs, error=0.013, ms=7.5)
        self.asked = None

    def pick(self, **bounds):
        self.asked = bounds
        return self.choice


class Measured(Study):
    """What measured more than pictures are rendered by."""

    def pick(self, techniques=None, **bounds):
        self.asked = bounds
        others = SimpleNamespace(technique="distance_field", knobs={"field_resolution": 32}, error=0.01, ms=1.0)
        return others if techniques is None else self.choice


def test_what_is_no_technique_of_pictures_is_passed_over():
    plan = sl.plan(Scene([GROUND, BOX], AREA, CAMERA), evidence=Measured("ray_traced", samples=4), max_error=0.02)
    assert plan.find("shadow").settings == {"technique": "ray_traced", "samples": 4}


def test_evidence_chooses_technique_and_knobs():
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    study = Study("pcf", resolution=512, samples=64, radius=8.0)
    plan = sl.plan(scene, evidence=study, max_error=0.02)
    assert study.asked == {"max_error": 0.02}
    assert plan.find("shadow map").settings == {"resolution": 512}
    assert plan.find("shadow").settings == {"technique": "pcf", "samples": 64, "radius": 8.0}
    assert "0.013" in plan.find("shadow").reason and "7.5 ms" in plan.find("shadow").reason
    plan = sl.plan(scene, evidence=Study("ray_traced", samples=4), budget_ms=16)
    assert names(plan) == ["g-buffer", "bvh", "shadow", "direct light"]
    # Necessity comes first: what needs no penumbra is not given one.
    hard = sl.plan(Scene([GROUND, BOX], PointLight((0, 8, 0)), CAMERA), evidence=study, max_error=0.02)
    assert why_not(hard, "penumbra") == "no area light: a hard shadow suffices"


def test_evidence_needs_bounds_which_need_no_evidence():
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    assert "expected error" in sl.plan(scene, (64, 36), max_error=0.02).find("shadow").reason
    with pytest.raises(ValueError, match="evidence: expected max_error or budget_ms"):
        sl.plan(scene, evidence=Study("hard"))
    with pytest.raises(ValueError, match="evidence: expected a technique"):
        sl.plan(scene, evidence=Study("magic"), max_error=0.02)
    with pytest.raises(ValueError, match="size"):
        sl.plan(scene, (0, 10))


@pytest.mark.parametrize("cases", [["a"], None, 3, "pcf"])
def test_evidence_of_ones_own_may_call_something_else_cases(cases):
    study = Study("pcf", resolution=512, samples=64, radius=8.0)
    study.cases = cases
    plan = sl.plan(Scene([GROUND, BOX], AREA, CAMERA), evidence=study, max_error=0.02)
    assert "measured: error" in plan.find("shadow").reason


@pytest.mark.parametrize("lack", [{"knobs": None}, {"knobs": 3}, {"ms": None}, {"technique": None}, {"error": None}])
def test_evidence_whose_choice_lacks_something_is_refused(lack):
    study = Study("pcf", resolution=512)
    vars(study.choice).update(lack)
    with pytest.raises((TypeError, ValueError), match="evidence: expected"):
        sl.plan(Scene([GROUND, BOX], AREA, CAMERA), evidence=study, max_error=0.02)
    study.choice = SimpleNamespace(technique="pcf", knobs={}, error=float("nan"), ms=1.0)
    with pytest.raises(ValueError, match="evidence: expected an error and a time"):
        sl.plan(Scene([GROUND, BOX], AREA, CAMERA), evidence=study, max_error=0.02)


def test_prints_and_shows_itself():
    plan = sl.plan(Scene([GROUND, BOX], AREA, CAMERA))
    text, table = str(plan), plan._repr_html_()
    for p in plan.passes:
        assert p.name in text and p.reason in text and f"<td>{p.name}</td>" in table
    for x in plan.left_out:
        assert f"left out: {x.reason}" in text and f"left out: {x.reason}" in table
    assert np.all([line == line.rstrip() for line in text.splitlines()])


def test_lights_in_view_are_left_out_with_a_reason():
    def names(lights, camera=CAMERA):
        return [x.name for x in sl.plan(Scene([GROUND, BOX], lights, camera)).left_out if "surface" in x.name]

    facing = RectLight((0, 1, -2), (1, 0, 0), (0, 1, 0), (9, 9, 9))
    away = RectLight((0, 1, -2), (0, 1, 0), (1, 0, 0), (9, 9, 9))
    behind = RectLight((0, 1, 40), (1, 0, 0), (0, 1, 0), (9, 9, 9), two_sided=True)
    camera = Camera((0, 1, 5), (0, 1, 0))
    assert names(facing, camera) == ["light surface"]
    assert names([away, behind, facing], camera) == ["light surface 2"]
    assert names(PointLight((0, 1, 0), (9, 9, 9)), camera) == []


def test_wrong_kinds_are_named():
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    with pytest.raises(TypeError, match="scene: expected a Scene"):
        sl.plan(None)
    with pytest.raises(TypeError, match="scene: expected a Scene"):
        sl.render(None)
    with pytest.raises(TypeError, match="size"):
        sl.plan(scene, 5)
    with pytest.raises(ValueError, match="size"):
        sl.plan(scene, (5, 5, 5))
    with pytest.raises(TypeError, match="evidence"):
        sl.plan(scene, evidence="x", max_error=0.1)


def test_plans_of_wrong_kinds_are_named():
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    with pytest.raises(TypeError, match="passes: expected a sequence of Pass, got str in it"):
        sl.renderer.Plan(("g-buffer",), (), (32, 18))
    with pytest.raises(TypeError, match="passes: expected a sequence of Pass, got NoneType"):
        sl.renderer.Plan(None, (), (32, 18))
    with pytest.raises(TypeError, match="left_out"):
        sl.renderer.Plan((), ("tone map",), (32, 18))
    with pytest.raises(TypeError, match="shading"):
        sl.renderer.Plan((), (), (32, 18), 1, ("diffuse",))
    with pytest.raises(TypeError, match="size"):
        sl.renderer.Plan((), (), None)
    with pytest.raises(TypeError, match="lights"):
        sl.renderer.Plan((), (), (32, 18), "one")
    for wrong in ({"name": 3}, {"reason": None}, {"settings": [1]}, {"settings": {"lights": "0"}}):
        with pytest.raises(TypeError, match=next(iter(wrong))):
            sl.renderer.Pass(**{"name": "direct light", "reason": "", **wrong})
    with pytest.raises(TypeError, match="plan: expected a Plan"):
        sl.render(scene, [sl.renderer.Pass("g-buffer", "")])


def avenue():
    """A long road of posts under the sun, seen from its begin."""
    posts = [Instance(sl.mesh.box((0.4, 3.0, 0.4)), translated(x, 1.5, -z)) for z in range(4, 400, 12) for x in (-3, 3)]
    road = Instance(sl.mesh.plane((60.0, 900.0)), translated(0, 0, 0))
    camera = Camera((0, 1.7, 0), (0, 1.2, -10))
    return Scene([road, *posts], DirectionalLight((0.5, -1, 0.2), (3, 3, 3)), camera)


def translated(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def test_long_views_under_the_sun_have_cascades_and_small_ones_none():
    long = avenue()
    plan = sl.plan(long, (320, 180))
    chart = plan.find("shadow map")
    assert 2 <= chart.settings["cascades"] <= 6 and "parts by distance" in chart.reason
    assert "pixels wide" in chart.reason and plan.find("shadow").settings["technique"] == "hard"
    small = sl.plan(Scene([GROUND, BOX], DirectionalLight((0.5, -1, 0.2), (3, 3, 3)), CAMERA), (320, 180))
    assert "cascades" not in small.find("shadow map").settings
    assert "pixels wide" in why_not(small, "cascades")
    # What they are for: less is wrong than with one map, by rays.
    frame = sl.render(long, plan)
    settings = {"resolution": 2048}
    passes = tuple(replace(p, settings=settings) if p.name == "shadow map" else p for p in plan.passes)
    alone = replace(plan, passes=passes)
    one = sl.render(long, alone)
    arrays = long.flatten(np.float32)
    seen = np.isfinite(frame.depth)
    bvh = sl.accel.BVH(arrays.positions, arrays.faces)
    origins = frame.position[seen] + np.float32(1e-3) * frame.normal[seen]
    exact = ~bvh.any_hit(origins, np.broadcast_to(-np.float32(long.lights[0].direction), origins.shape))
    off, off_one = (float((f.lit[0][seen] != exact).mean()) for f in (frame, one))
    assert off < 0.02 and off < 0.6 * off_one


MOMENTS = {"resolution": 512, "filter": "mip"}
MEASURED = {
    "hard": {"resolution": 512},
    "pcf": {"resolution": 512, "samples": 16, "radius": 4.0},
    "pcss": {"resolution": 512, "blocker_samples": 8, "filter_samples": 16},
    "variance": MOMENTS,
    "exponential_variance": MOMENTS,
    "moment": MOMENTS,
    "variance_soft": MOMENTS | {"kind": "moment", "reduce": 2},
    "ray_traced": {"samples": 16},
}


def test_every_technique_that_evidence_may_name_is_rendered():
    from shadelab.renderer._shadows import _TECHNIQUES

    assert set(MEASURED) == set(_TECHNIQUES)
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    lit = {}
    for technique, knobs in MEASURED.items():
        plan = sl.plan(scene, (64, 36), max_error=0.1, evidence=Study(technique, **knobs))
        assert plan.find("shadow").settings["technique"] == technique
        lit[technique] = sl.render(scene, plan).lit[0]
    # All find the same shadow, but for its edges.
    for technique, picture in lit.items():
        assert (lit["ray_traced"] < 0.1).sum() > 10
        assert np.abs(picture - lit["ray_traced"]).mean() < 0.05, technique


@pytest.mark.parametrize("size", [(64, 36), (160, 90), (320, 180), (640, 360)])
def test_texels_are_as_small_as_the_plan_says(size):
    boxes = [Instance(sl.mesh.box((1.0, 2.0, 1.0)), translated(x, 1, z)) for x in (-20, 0, 20) for z in (-20, 0, 20)]
    camera = Camera((0, 6, 0), (0, 5, -8), fov_y=0.8)
    scene = Scene([Instance(sl.mesh.plane(100.0)), *boxes], DirectionalLight((0.3, -1, 0.2), (1, 1, 1)), camera)
    plan = sl.plan(scene, size)
    settings = plan.find("shadow map").settings
    if "cascades" in settings:
        return
    said = float(why_not(plan, "cascades").split("at most ")[1].split()[0])
    frame, arrays = sl.render(scene, plan), scene.flatten(np.float32)
    drawn = sl.shadow.shadow_map(
        arrays.positions, arrays.faces, scene.lights[0], **settings, receivers=frame.position[np.isfinite(frame.depth)]
    )
    widest = drawn.texel_size() / (frame.depth.min() * 2 * np.tan(0.4) / size[1])
    assert said <= 4 and widest <= 1.05 * said


@pytest.mark.parametrize("size", [(110, 62), (160, 90), (320, 180)])
def test_penumbrae_on_tilted_receivers_are_wider(size):
    # Light that grazes the ground over a wall: penumbrae are far wider than on what faces the light.
    ground = sl.mesh.Mesh(
        np.array([[1, 0, -5], [21, 0, -5], [21, 0, 5], [1, 0, 5.0]]), np.array([[0, 2, 1], [0, 3, 2]])
    )
    wall = Instance(sl.mesh.box((0.01, 0.9, 4.0)), translated(1.05, 0.45, 0))
    lamp = RectLight(center=(0, 1, 0), edge_u=(0, 0.01, 0), edge_v=(0, 0, 0.01), radiance=(1e4, 1e4, 1e4))
    scene = Scene([Instance(ground), wall], lamp, Camera((10, 30.0, 0.01), (10, 0, 0), fov_y=0.5))
    plan = sl.plan(scene, size)
    assert plan.find("shadow").settings["technique"] != "hard"


def test_penumbrae_are_within_the_bound():
    from shadelab.renderer._facts import facts_of, widest_penumbra

    rng = np.random.default_rng(4)
    for tilt in (0.0, 0.5, 1.0, 1.3):
        lamp = RectLight((0, 4, 0), (1e-3, 0, 0), (0, 0, 1e-3), (9, 9, 9))
        turn = sl.transform.rotate_z(tilt)
        low = Instance(sl.mesh.plane(1.0), sl.transform.translate([0.3, 0, 0]) @ turn)
        post = Instance(sl.mesh.plane(0.2), sl.transform.translate([0.2, 2.0, 0]))
        scene = Scene([low, post], lamp, Camera((0, 40, 0.1), (0, 0, 0)))
        facts = facts_of(scene, (64, 36))
        normal = turn[:3, :3] @ [0, 1, 0]
        origin = np.array([0.3, 0, 0])
        # Where all corners' rays through points of the post's edge meet the plane.
        corners = np.asarray(lamp.corners)
        edge = np.stack([np.full(50, 0.3), np.full(50, 2.0), rng.uniform(-0.1, 0.1, 50)], -1)
        way = edge[:, None] - corners
        t = ((origin - corners) @ normal) / (way @ normal)
        hits = corners + way * t[..., None]
        wide = np.linalg.norm(hits[:, :, None] - hits[:, None], axis=-1).max()
        assert wide <= widest_penumbra(lamp, facts) < 100 * wide


def test_rays_stand_in_for_what_was_measured_where_no_map_sees_enough():
    room, box = Instance(sl.mesh.box(4.0)), Instance(sl.mesh.box(), sl.transform.translate([1.0, -1, 0]))
    both = RectLight(center=(0, 1, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 1), radiance=(9, 9, 9), two_sided=True)
    scene = Scene([room, box], both, Camera((-1.5, 1.5, 1.9), (0.5, -1.5, 0)))
    study = Study("pcss", resolution=512)
    for bound in (0.1, 0.05, 0.02):
        found = sl.plan(scene, (64, 36), max_error=bound, evidence=study).find("shadow")
        assert found.settings["technique"] == "ray_traced" and "not kept" not in found.reason
        # That bound needs no study.
        assert sl.plan(scene, (64, 36), max_error=bound).find("shadow").settings == found.settings
    tight = sl.plan(scene, (64, 36), max_error=0.0001, evidence=study).find("shadow")
    assert tight.settings["samples"] == 4096 and "max_error 0.0001 is not kept" in tight.reason
    timed = sl.plan(scene, (64, 36), budget_ms=1e-3, evidence=study).find("shadow")
    assert "budget_ms 0.001 is not kept" in timed.reason
    # What was measured of rays themselves stays.
    kept = sl.plan(scene, (64, 36), max_error=0.02, evidence=Study("ray_traced", samples=8)).find("shadow")
    assert kept.settings["samples"] == 8 and "measured" in kept.reason


def test_what_is_not_looked_for_is_said():
    def left(**of):
        return {x.name for x in sl.plan(Scene([GROUND, BOX], AREA, CAMERA, **of)).left_out}

    assert {"ambient occlusion", "indirect light"} <= left(background=(0.1, 0.1, 0.1))
    assert "ambient occlusion" not in left(background=(0, 0, 0))


def test_evidence_says_where_it_was_measured():
    from shadelab import study

    scene = Scene([GROUND, BOX], AREA, CAMERA)
    fast = {"size": (48, 27), "rounds": 1, "patience": 0.0, "cache": False, "techniques": ["hard"], "causes": False}
    result = study.run("soft shadows", {"mine": scene}, **fast)
    assert "on mine at 48 × 27: error" in sl.plan(scene, evidence=result, max_error=9.0).find("shadow").reason


@pytest.mark.parametrize("question", ["soft shadows", "shadow aliasing", "shadow memory"])
def test_whatever_a_study_of_shadows_measured_can_be_rendered(question):
    """Every setting of the techniques that pictures are rendered by is one of theirs, or of their map."""
    asked, seen = sl.study.find(question), 0
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    for candidate in asked.candidates:
        if candidate.name not in ("hard", "pcf", "pcss", "variance", "exponential_variance", "moment", "ray_traced"):
            continue
        settings = candidate.settings()
        for knobs in (settings[0], settings[-1]):
            small = knobs | ({"resolution": 64} if "resolution" in knobs else {})
            plan = sl.plan(scene, (16, 9), evidence=Study(candidate.name, **small), max_error=0.02)
            assert np.isfinite(sl.render(scene, plan).radiance).all(), (candidate.name, knobs)
            seen += 1
    assert seen


def test_knobs_of_a_map_go_to_the_map_and_strange_ones_are_named():
    scene = Scene([GROUND, BOX], AREA, CAMERA)
    study = Study("hard", resolution=128, surface="second", stored_bits=16)
    plan = sl.plan(scene, (32, 18), evidence=study, max_error=0.02)
    assert plan.find("shadow map").settings == {"resolution": 128, "surface": "second", "bits": 16}
    assert plan.find("shadow").settings == {"technique": "hard"}
    with pytest.raises(ValueError, match="evidence: expected knobs of pcf and its map, got foo"):
        sl.plan(scene, evidence=Study("pcf", samples=16, foo=3), max_error=0.02)
