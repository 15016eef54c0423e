"""The question of soft shadows: its reference, its mask, and what it finds of each technique."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import study
from shadelab.study.questions import _shadow_scenes, soft_shadows

SIZE = (96, 54)
FAST = {"size": SIZE, "rounds": 3, "patience": 0.0, "cache": False}


@pytest.fixture(scope="module")
def measured():
    return study.run("soft shadows", "contact", **FAST)


def case_of(name, dtype=np.float32):
    scene = _shadow_scenes.SCENES[name]()
    return study.Case(name, "", scene, scene.camera, SIZE, np.dtype(dtype), 0)


def errors(result, technique):
    return {tuple(r.knobs.values()): r for r in result.records if r.technique == technique}


def test_rays_converge_to_the_path_tracer_without_bias(measured):
    rays = errors(measured, "ray_traced")
    values = [rays[(n,)].error.value for n in (1, 4, 16, 64)]
    assert values == sorted(values, reverse=True) and values[-1] < values[0] / 8
    # Two estimators of two chapters agree: what is left of bias is a small part of the noise of 64 rays.
    assert rays[(64,)].bias < 0.5 * rays[(64,)].noise


def test_the_reference_can_judge(measured):
    case = measured.cases[0]
    assert case.reached and 0 < case.reference_error <= case.target
    least = min(r.error.value for r in measured.records)
    assert case.target == pytest.approx(0.25 * least, rel=0.2)


def test_hard_shadows_lose_most_where_it_matters(measured):
    hard = errors(measured, "hard")[(1024,)]
    pcss = errors(measured, "pcss")[(1024, 16, 32)]
    assert pcss.error.high < hard.error.low and pcss.also["FLIP"] < hard.also["FLIP"]
    assert hard.noise == 0 and hard.frame_error < hard.error.value  # over the frame it looks better


def test_counters_are_those_of_the_settings(measured):
    pcss = errors(measured, "pcss")[(1024, 16, 32)].counters
    assert pcss == {"taps/px": 48, "rays/px": 0, "bytes": 4 * 1024**2}
    assert errors(measured, "ray_traced")[(16,)].counters["rays/px"] == 16
    assert errors(measured, "ray_traced")[(16,)].prepare_ms < errors(measured, "hard")[(512,)].prepare_ms


def test_the_mask_holds_penumbrae_and_their_surroundings():
    inputs = soft_shadows._setup(case_of("large penumbra"))
    reference = soft_shadows._estimate(inputs, 64, 1, 0, None)
    mask = soft_shadows._penumbrae(reference, inputs)
    fraction = soft_shadows._residual(reference, np.zeros_like(reference), inputs)
    inside = (
        (fraction > 0.1) & (fraction < 0.9) & (inputs.spread(inputs.unshadowed.sum(0)).sum(-1) > 0.2 / inputs.exposure)
    )
    assert inside.sum() > 100 and mask[inside].all()
    assert not mask[~inputs.covered].any() and mask.mean() < 0.7


def test_leaks_are_what_full_shadow_shows():
    inputs = soft_shadows._setup(case_of("two depths"))
    reference = soft_shadows._estimate(inputs, 64, 1, 0, None)
    whole = inputs.spread(inputs.unshadowed.sum(0))
    dark = (whole.sum(-1) > 0) & (reference == 0).all(-1)
    assert dark.mean() > 0.05
    # A twentieth of what is dim even without shadow is hardly seen either.
    bright = sl.color.luminance(whole) * inputs.exposure > 0.05**2
    for value, leak in (
        (reference, 0.0),
        (whole, 100.0 * bright[dark].mean()),
        (0.04 * whole, 0.0),
        (np.where(dark[..., None], np.nan, 0.0), 100.0),
        # What leaks where there is some light is another matter.
        (np.where(dark[..., None], 0.0, whole), 0.0),
    ):
        assert soft_shadows._leaks(value, reference, inputs) == pytest.approx(leak, abs=1e-3)
    assert np.isnan(soft_shadows._leaks(whole, whole, inputs))


def test_leaks_stand_case_by_case_in_tables_and_figures(tmp_path):
    scenes = {name: _shadow_scenes.SCENES[name] for name in ("two depths", "contact")}
    found = study.run("soft shadows", scenes, techniques=["hard", "variance", "ray_traced"], causes=False, **FAST)
    leaks = {(r.scene, r.technique, *r.knobs.values()): r.also["leak %"] for r in found.records}
    for scene in scenes:
        assert leaks[scene, "hard", 2048] < 2 and leaks[scene, "ray_traced", 64] < 2
        # The wider a filter of one width, the farther light comes into shadows.
        assert leaks[scene, "variance", 1024, 2, 4.0, 0.0] < leaks[scene, "variance", 1024, 2, 16.0, 0.0]
    # And what little there is of it counts as none.
    assert leaks["contact", "variance", 1024, 2, 16.0, 0.2] < 0.7 * leaks["contact", "variance", 1024, 2, 16.0, 0.0]
    rows = found.to_csv(tmp_path / "figures.csv").read_text().splitlines()
    at = rows[0].split(",").index("leak %")
    assert [float(r.split(",")[at]) for r in rows[1:]] == pytest.approx([r.also["leak %"] for r in found.records])
    assert "leak %" in found.by_case() and "full shadow" in found.also["leak %"]


def test_masks_widen_by_a_square():
    mask = np.zeros((7, 9), bool)
    mask[3, 0] = True
    wide = soft_shadows._widened(mask, 2)
    assert wide.sum() == 5 * 3 and wide[1:6, :3].all()


def test_double_inputs_are_the_same_g_buffer():
    single, double = (soft_shadows._setup(case_of("contact", t)) for t in (np.float32, np.float64))
    assert (single.covered == double.covered).all() and double.points.dtype == double.unshadowed.dtype == np.float64
    assert np.abs(single.points - double.points).max() < 1e-6  # two roundings of coordinates below 8


def test_estimates_over_a_mask_are_those_of_the_whole():
    inputs = soft_shadows._setup(case_of("contact"))
    where = np.zeros(inputs.covered.shape, bool)
    where[20:40, 30:60] = True
    part = soft_shadows._estimate(inputs, 16, 5, 0, where)
    assert part.shape == (54, 96, 3) and np.isfinite(part).all() and (part[~where] == 0).all()
    assert (part[where] > 0).any()


def test_every_scene_and_view_shows_penumbrae():
    for name, make in _shadow_scenes.SCENES.items():
        scene = make()
        for view, camera in _shadow_scenes.views(name, scene).items():
            case = study.Case(name, view, scene, camera, SIZE, np.dtype(np.float32), 0)
            inputs = soft_shadows._setup(case)
            assert 0.02 < soft_shadows._penumbrae(None, inputs).mean() < 0.9, (name, view)


def test_an_external_picture_joins_the_front(tmp_path):
    case = case_of("contact")
    inputs = soft_shadows._setup(case)
    picture = soft_shadows._estimate(inputs, 1024, 77, 0, None)
    sl.scene.save_image(tmp_path / "engine.exr", picture)
    mine = study.External(tmp_path / "engine.exr", ms=0.01)
    result = study.run("soft shadows", "contact", candidates=[mine], techniques=["hard", "ray_traced"], **FAST)
    assert result.front()[0].technique == "engine" and result.pick(max_error=0.05).technique == "engine"
    # 1024 samples of another seed: far below 64 rays.
    assert errors(result, "engine")[()].error.value < errors(result, "ray_traced")[(64,)].error.value / 2


def test_a_plan_follows_the_evidence(measured):
    scene = _shadow_scenes.SCENES["contact"]()
    wanted = measured.pick(max_error=0.05)
    plan = sl.plan(scene, size=SIZE, evidence=measured, max_error=0.05)
    assert any(p.settings.get("technique") == wanted.technique for p in plan.passes)
    with pytest.raises(ValueError, match="nothing"):
        sl.plan(scene, size=SIZE, evidence=measured, max_error=1e-6)


def test_point_lights_leave_area_techniques_out():
    base = _shadow_scenes.SCENES["contact"]()
    light = sl.light.PointLight((2.0, 4.0, 1.0), (30.0, 30.0, 30.0))
    scene = sl.scene.Scene(base.instances, lights=(light, *base.lights), camera=base.camera)
    result = study.run("soft shadows", scene, **FAST)
    assert not errors(result, "pcss") and "pcss: it needs area lights" in result.cases[0].left_out[0]


def test_scenes_with_nothing_to_measure_are_refused_by_name():
    base = _shadow_scenes.SCENES["contact"]()
    light = sl.light.PointLight((2.0, 4.0, 1.0), (30.0, 30.0, 30.0))
    for things, lights, expected in (
        (base.instances, (light,), "nothing to measure in 'mine': no pixel is in penumbra"),
        ((), base.lights, "at least one instance with a face in 'mine'"),
        (base.instances, (), "at least one light in 'mine'"),
    ):
        scene = sl.scene.Scene(things, lights=lights, camera=base.camera)
        with pytest.raises(ValueError, match=expected):
            study.run("soft shadows", {"mine": scene}, **FAST)


@pytest.mark.parametrize("answer", [np.zeros((3, 4)), None])
def test_answers_that_are_no_lit_fractions_are_refused_by_name(answer):
    def mine(inputs):
        return answer

    with pytest.raises((TypeError, ValueError), match=r"mine: expected .*shape \("):
        study.run("soft shadows", "contact", candidates=[mine], techniques=[], **FAST)


def test_a_study_and_its_report_do_without_flip_where_it_is_not_defined(monkeypatch, tmp_path):
    def black(*pictures, dynamic_range):
        raise ValueError("reference: expected a picture that is not black")

    monkeypatch.setattr(sl.image, "flip_error", black)
    result = study.run("soft shadows", "contact", techniques=["hard"], **FAST)
    assert np.isnan(result.records[0].also["FLIP"]) and "FLIP" in str(result) and "–" in str(result)
    assert result.report(tmp_path, max_error=0.5).is_file()


def test_an_answer_of_nothing_but_nan_is_counted_and_reported(tmp_path):
    def nans(inputs):
        return np.full(inputs.unshadowed.shape[:2], np.nan, np.float32)

    result = study.run("soft shadows", "contact", candidates=[nans], techniques=["hard"], **FAST)
    assert next(r for r in result.records if r.technique == "nans").strays > 0
    assert result.report(tmp_path, max_error=0.5).is_file()
