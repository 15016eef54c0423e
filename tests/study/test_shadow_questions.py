"""Questions of shadow maps: aliasing, bias and memory; their masks and prices, and what each must find."""

import csv
import gc

import numpy as np
import pytest
import shadelab as sl
from shadelab import study
from shadelab.light import PointLight
from shadelab.study.questions import _fields, _visibility, shadow_aliasing, shadow_bias, shadow_memory

SIZE = (96, 54)
FAST = {"size": SIZE, "rounds": 3, "patience": 0.0, "cache": False}


_FEW = ("hard", "pcss", "pcss, 16 bits", "moments as mips, 16 bits", "distance_field")


def by_setting(result, technique, case=None):
    return {
        tuple(r.knobs.values()): r
        for r in result.records
        if r.technique == technique and case in (None, r.scene, r.view)
    }


@pytest.mark.parametrize("module", [shadow_aliasing, shadow_bias, shadow_memory])
def test_five_scenes_that_break_someone(module):
    assert {"contact", "two depths", "thin fence", "large penumbra", "long view"} <= set(module.question().scenes)


def test_aliasing_falls_with_resolution_and_is_worse_near():
    question = shadow_aliasing.question()
    few = [c for c in question.candidates if c.name == "hard"]
    result = study.run(study.Question(**{**vars(question), "candidates": few}), "contact", **FAST)
    for view in ("near", "far"):
        hard = by_setting(result, "hard", view)
        values = [hard[(n,)].error.value for n in (256, 1024, 4096)]
        # Errors of outlines are of a texel's size: the share falls by four, its root by two, for each.
        assert values[0] > 1.4 * values[1] and values[1] > 1.4 * values[2]
    assert hard[(1024,)].counters["bytes"] == 4 * 1024**2


def test_edges_are_where_the_exact_shadow_steps():
    scene = _visibility.BREAKING["contact"]()
    case = study.Case("contact", "", scene, scene.camera, SIZE, np.dtype(np.float32), 0)
    inputs = _visibility.pointlike(case)
    assert all(isinstance(l, PointLight) and l.position == scene.lights[0].center for l in inputs.lights)
    exact = _visibility.traced(inputs)
    mask = _visibility.edges(exact, inputs)
    assert set(np.unique(exact)) == {0, 1} and 0.02 < mask.mean() < 0.4
    assert not mask[~inputs.covered].any()
    assert not _visibility.edges(np.ones_like(exact), inputs).any()


def test_bias_trades_acne_for_detachment():
    result = study.run("shadow bias", "thin fence", **FAST)
    none, constant = by_setting(result, "none"), by_setting(result, "constant")
    offset, plane = by_setting(result, "normal offset"), by_setting(result, "receiver plane")
    (bare,) = none.values()
    assert bare.also["acne %"] > 30
    sizes = [constant[(1024, b)] for b in (0.001, 0.003, 0.01, 0.03, 0.1, 0.3)]
    acne, gone = ([r.also[k] for r in sizes] for k in ("acne %", "detached %"))
    assert acne == sorted(acne, reverse=True) and acne[0] > 10 and acne[-1] < 2
    assert gone == sorted(gone) and gone[-1] > gone[0]
    assert offset[(1024, 4.0)].also["detached %"] > offset[(1024, 0.25)].also["detached %"]
    # The tangent plane needs no size: next to no acne, and shadows stay.
    best = plane[(1024, 0.05)]
    assert best.also["acne %"] < 3 and best.error.value < 0.5 * bare.error.value
    # The middle of a thing that has two sides is far from both.
    (middle,) = by_setting(result, "midpoint").values()
    assert middle.also["acne %"] < 0.3 * bare.also["acne %"] and middle.error.value < bare.error.value


def test_memory_is_the_price_and_time_a_counter(tmp_path):
    question = shadow_memory.question()
    few = [c for c in question.candidates if c.name in _FEW]
    result = study.run(study.Question(**{**vars(question), "candidates": few}), "large penumbra", **FAST)
    hard = by_setting(result, "hard")
    assert [hard[(n,)].ms.value for n in (128, 2048)] == [4 * 128**2, 4 * 2048**2]
    assert hard[(128,)].counters["ms"] > 0 and "bytes" not in hard[(128,)].counters
    whole, half = by_setting(result, "pcss"), by_setting(result, "pcss, 16 bits")
    assert half[(512, 16, 16, 32)].ms.value == 2 * 512**2
    # Depths are quantised far below what 32 taps leave as noise.
    assert abs(half[(512, 16, 16, 32)].error.value - whole[(512, 16, 32)].error.value) < 0.02
    # Depths, four powers of 16 bits, a third for mips.
    mips = by_setting(result, "moments as mips, 16 bits")
    assert mips[(256, "moment", "mip", 16)].ms.value == 4 * 256**2 + round(256**2 * 8 * 4 / 3)
    unit = result.cost_unit()
    assert unit.short == "MB" and unit.per_ms == 1e-6
    assert " MB" in str(result.pick(max_error=0.5)) and "MB: megabytes" in result.table()
    with pytest.raises(study.NothingQualifies, match="MB"):
        result.pick(max_error=1e-6)
    page = result.report(tmp_path, max_error=0.5).read_text()
    assert "Error against bytes" in page and "megabytes" in page
    rows = list(csv.DictReader((tmp_path / "figures.csv").open()))
    assert {r["technique"] for r in rows} == {c.name for c in few} and all(float(r["ms"]) > 0 for r in rows)


def test_further_samples_are_others():
    scene = _visibility.BREAKING["large penumbra"]()
    case = study.Case("large penumbra", "", scene, scene.camera, SIZE, np.dtype(np.float32), 0)
    inputs = shadow_memory._setup(case)
    a, b = (shadow_memory._estimate(inputs, 16, 1, start, None) for start in (0, 16))
    whole = shadow_memory._estimate(inputs, 256, 1, 32, None)
    where = _visibility.facing(inputs)
    assert not np.array_equal(a, b) and np.abs((a - b)[where].mean()) < 5e-3
    # Two sets of 16 together are nearer than either.
    error = [np.sqrt(np.mean((x - whole)[where] ** 2)) for x in (a, b, (a + b) / 2)]
    assert error[2] < 0.85 * min(error[:2])
    part = np.zeros_like(where)
    part[20:30] = True
    some = shadow_memory._estimate(inputs, 256, 1, 0, part)
    assert some.shape == a.shape and not some[~(part & inputs.covered)].any()
    # Patterns follow the batch, so a part's values are those of the whole but for noise.
    there = part & where
    assert there.sum() > 100 and np.abs((some - whole)[there]).mean() < 0.02 < some[there].mean()


def test_bytes_are_no_milliseconds(tmp_path):
    question = shadow_memory.question()
    few = [c for c in question.candidates if c.name == "pcss"]
    ask = study.Question(**{**vars(question), "candidates": few})
    result = study.run(ask, "contact", size=(48, 27), rounds=3, patience=0.0, cache=False, reference_seconds=0.2)
    with pytest.raises(ValueError, match=r"budget_ms: expected a study of times, .* megabytes"):
        result.pick(budget_ms=50)
    choice = result.pick(max_error=0.9)
    assert choice.cost_interval.value == 4 * 128**2 and " MB" in str(choice)
    # Milliseconds are milliseconds.
    (record,) = (r for r in result.records if r.setting == choice.setting)
    assert choice.ms == record.counters["ms"] == choice.ms_interval.value < 1e4
    scene = _visibility.BREAKING["contact"]()
    plan = sl.plan(scene, (48, 27), max_error=0.9, evidence=result)
    said = next(p.reason for p in plan.passes if "measured on contact at 48 × 27: error" in p.reason)
    assert "MB" in said and f"{choice.ms:.3g} ms" in said and "65536" not in said and "6.55e+04" not in said
    with pytest.raises(ValueError, match="budget_ms"):
        sl.plan(scene, (48, 27), budget_ms=50, evidence=result)


def test_what_has_no_price_is_refused_before_anything_is_measured(tmp_path):
    def mine(inputs):
        raise AssertionError("measured")

    with pytest.raises(ValueError, match=r"candidates: .*'bytes'.*'mine' has none"):
        study.run("shadow memory", "contact", candidates=[mine], techniques=[], **FAST)
    with pytest.raises(ValueError, match="candidates: 'g' has a time, but what 'shadow memory' asks is bytes"):
        study.run("shadow memory", "contact", candidates=[study.External(tmp_path / "g.png", 1.8)], **FAST)
    other = study.Candidate(
        "other",
        lambda inputs, _: np.ones((len(inputs.lights), len(inputs.points))),
        counters=lambda inputs: {"taps": 1},
    )
    with pytest.raises(ValueError, match="'bytes' among the counters of 'other', got 'taps'"):
        study.run("shadow memory", "contact", candidates=[other], techniques=[], **FAST)


def test_fields_in_double_are_double():
    scene = _visibility.BREAKING["contact"]()
    found = {}
    for dtype in (np.float32, np.float64):
        case = study.Case("contact", "", scene, scene.camera, (48, 27), np.dtype(dtype), 0)
        inputs = shadow_memory._setup(case)
        grid = _fields._grid(inputs, 16)
        assert grid.distances.dtype == dtype and _fields._grid(inputs, 16) is grid
        found[dtype] = _fields.field_lit(inputs, None, 16)
    assert all(v.dtype == k for k, v in found.items())
    assert len(_fields._FIELDS) >= 1
    # Nothing is kept beyond the case.
    del inputs, grid
    gc.collect()
    assert not len(_fields._FIELDS)


def test_pages_and_cascades_stand_beside_one_map():
    question = shadow_aliasing.question()
    few = [c for c in question.candidates if c.name in ("hard", "cascades", "pages")]
    result = study.run(study.Question(**{**vars(question), "candidates": few}), "long view, sun", **FAST)
    for view in ("near", "far"):
        hard, parts, pages = (by_setting(result, n, view) for n in ("hard", "cascades", "pages"))
        # Texels that follow the view do with a fraction of them.
        assert parts[(1024, 4)].error.value < 0.8 * hard[(2048,)].error.value
        assert pages[(16384, 4)].error.value < 0.8 * hard[(2048,)].error.value
        assert pages[(16384, 4)].counters["bytes"] < hard[(2048,)].counters["bytes"]
        assert parts[(1024, 4)].counters["bytes"] == hard[(2048,)].counters["bytes"]
    # Point lights have no cascades.
    scene = _visibility.BREAKING["contact"]()
    inputs = _visibility.pointlike(study.Case("contact", "", scene, scene.camera, SIZE, np.dtype(np.float32), 0))
    assert "parallel" in next(c for c in few if c.name == "cascades").domain(inputs)


def test_moments_differ_by_rounding_alone_between_precisions():
    # The bias that single precision needs stands in double as well.
    scene = _visibility.BREAKING["long view"]()
    lit = []
    for dtype in (np.float32, np.float64):
        case = study.Case("long view", "", scene, scene.camera, SIZE, np.dtype(dtype), 0)
        inputs = _visibility.pointlike(case)
        maps = shadow_aliasing._moment_maps("moment")(inputs, 256, sigma=1.0)
        lit.append(shadow_aliasing._moment(inputs, maps, 256, 1.0))
    assert np.sqrt(np.mean((lit[0] - lit[1]) ** 2)) < 0.02


def test_colours_count_by_their_luminance(tmp_path):
    scene = _visibility.BREAKING["contact"]()
    case = study.Case("contact", "far", scene, scene.camera, SIZE, np.dtype(np.float32), 0)
    exact = _visibility.traced(_visibility.pointlike(case))
    sl.scene.save_image(tmp_path / "white.exr", np.repeat(exact[..., None], 3, -1).astype(np.float32))
    sl.scene.save_image(tmp_path / "green.exr", (exact[..., None] * [0.0, 1.0, 0.0]).astype(np.float32))
    question = shadow_aliasing.question()
    few = [c for c in question.candidates if c.name == "hard"]
    given = [study.External(tmp_path / f"{name}.exr", ms=1.0) for name in ("white", "green")]
    result = study.run(study.Question(**{**vars(question), "candidates": few}), "contact", candidates=given, **FAST)
    white, green = (next(r for r in result.records if r.technique == n) for n in ("white", "green"))
    assert white.error.value < 1e-6 and 0.1 < green.error.value < 0.3


@pytest.mark.parametrize("name", ["soft shadows", "shadow bias", "shadow aliasing", "shadow memory"])
@pytest.mark.parametrize("thing", [sl.mesh.icosphere(1), [], None], ids=["a mesh", "a list", "a name's nothing"])
def test_what_is_no_scene_is_named(name, thing):
    with pytest.raises((TypeError, ValueError), match="scene: expected"):
        study.run(name, {"mine": thing}, **FAST)
