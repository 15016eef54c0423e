"""`run` on synthetic candidates: what it measures is what was put in."""

import pickle

import numpy as np
import pytest
import toy
from shadelab import study
from shadelab.study import Candidate, External, MonteCarlo, references

FAST = {"rounds": 3, "patience": 1.0, "cache": False}


def by_setting(result, scene=None):
    return {r.setting: r for r in result.records if scene in (None, r.scene)}


def test_errors_are_the_bias_and_noise_that_were_put_in():
    result = study.run(toy.question(), **FAST)
    records = by_setting(result)
    for bias in (0.01, 0.1):
        r = records[f"biased(bias={bias:g})"]
        assert r.error.value == pytest.approx(bias, rel=1e-4) == r.bias
        assert r.noise == 0 and r.error.low <= r.error.value <= r.error.high
        assert r.precision < 1e-6  # float32 against float64
    for n in (4, 16):
        r = records[f"noisy(samples={n})"]
        # 3072 pixels of the mask twice: the root mean square is known within 1/√(2·6144) = 0.9 %; five of it.
        assert r.error.value == pytest.approx(0.1 / np.sqrt(n), rel=0.045)
        assert r.noise == pytest.approx(0.1 / np.sqrt(n), rel=0.065)
        assert r.bias < 0.02 / np.sqrt(n) ** 0.5


def test_a_noisy_reference_does_not_raise_the_error():
    exact = study.run(toy.question(), **FAST)
    judged = study.run(toy.question(sigma=0.05), fraction=0.5, **FAST)
    assert judged.cases[0].reached and judged.cases[0].reference_samples > 4
    assert judged.cases[0].reference_error <= judged.cases[0].target
    for setting, r in by_setting(judged).items():
        # The noise of the reference is 0.5 of the smallest error; undebiased, the smallest would read 12 % high.
        assert r.error.value == pytest.approx(by_setting(exact)[setting].error.value, rel=0.05)


def test_a_reference_that_ran_out_of_time_says_so():
    result = study.run(toy.question(sigma=0.5), reference_seconds=0.0, **FAST)
    assert not result.cases[0].reached and result.cases[0].reference_error > result.cases[0].target


def test_refinement_stays_inside_the_mask_and_agrees_with_one_long_run():
    sizes = []

    def counted(inputs, samples, seed, start, where):
        sizes.append((samples, start, where is None))
        return toy.estimate(0.3)(inputs, samples, seed, start, where)

    q = toy.question(sigma=0.3)
    case = study.Case("ramp", "", 0, None, toy.SIZE, np.dtype(np.float64), 0)
    source = MonteCarlo(counted, first=4, most=64)
    halves = references.first(study.Question("toy", {}, source, toy.DIFFERENCE, []), case, 0)
    outside = halves.a.copy()
    where = toy.LEFT.select(halves.a, case)
    assert not references.refine(halves, source, case, 0, where, lambda h: 1.0, 0.0, 1e3)
    assert halves.samples == 64 and sizes[0] == (4, 0, True) and not any(s[2] for s in sizes[2:])
    assert (halves.a[~where] == outside[~where]).all()
    whole = toy.estimate(0.3)(case, 64, references._streams(0)[0], 0, None)
    assert np.allclose(halves.a[where], whole[where], atol=1e-12)
    assert q.mask is toy.LEFT


def test_pick_takes_the_worst_over_scenes():
    def fooled(inputs, prepared):
        return toy.truth(inputs) + np.float32(0.2 if inputs.scene_name == "hard" else 0.001)

    def steady(inputs, prepared):
        return toy.truth(inputs) + sum(np.float32(0.01) for _ in range(1)) + 0 * slow(inputs)

    def slow(inputs):
        return np.sum([toy.truth(inputs) for _ in range(20)], axis=0)

    q = toy.question(candidates=[Candidate("fooled", fooled), Candidate("steady", steady)], scenes=("easy", "hard"))
    result = study.run(q, **FAST)
    assert result.pick(max_error=0.02).technique == "steady"
    assert result.pick(max_error=0.02, scene="easy").technique == "fooled"
    choice = result.pick(max_error=0.5)
    assert choice.technique == "fooled" and choice.error == pytest.approx(0.2, rel=1e-3) and choice.cases == 2
    assert choice.error_case == "hard" and choice.metric == "difference" and choice.mask == "left half"
    assert {s.technique for s in result.front()} == {"fooled", "steady"}
    assert [s.technique for s in result.front("easy")] == ["fooled"]
    with pytest.raises(ValueError, match="'easy', 'hard'"):
        result.front("absent")


def test_pick_by_budget_takes_the_most_accurate_that_fits():
    def slow(inputs, prepared):
        return toy.truth(inputs) + 0 * np.sum([toy.truth(inputs) for _ in range(200)], axis=0)

    q = toy.question(candidates=[Candidate("biased", toy.biased, {"bias": (0.01, 0.1)}), Candidate("slow", slow)])
    result = study.run(q, **FAST)
    times = {s.setting: s.ms for s in result.summaries()}
    assert result.pick(budget_ms=1e4).technique == "slow"
    assert result.pick(budget_ms=times["slow"].low * 0.9).knobs == {"bias": 0.01}


def test_when_nothing_qualifies_the_nearest_is_named():
    result = study.run(toy.question(), **FAST)
    with pytest.raises(study.NothingQualifies, match=r"nothing keeps error at most 0.0001.*biased\(bias=0.01\)") as e:
        result.pick(max_error=1e-4)
    assert e.value.best.knobs == {"bias": 0.01}
    with pytest.raises(ValueError, match="expected one of them"):
        result.pick()
    with pytest.raises(ValueError, match="max_error: expected a positive number"):
        result.pick(max_error=-1)


def test_a_function_of_the_user_joins():
    def mine(inputs):
        return toy.truth(inputs) + np.float32(0.05)

    result = study.run(toy.question(), candidates=[mine], techniques=["noisy"], **FAST)
    assert by_setting(result)["mine"].error.value == pytest.approx(0.05, rel=1e-3)
    assert "biased(bias=0.1)" not in by_setting(result)


def test_wrong_candidates_are_named():
    with pytest.raises(ValueError, match="techniques: expected some of 'biased', 'noisy', got 'vsm'"):
        study.run(toy.question(), techniques=["vsm"], **FAST)
    with pytest.raises(ValueError, match=r"flat: expected an answer of shape \(64, 96\), got \(3,\)"):
        study.run(toy.question(), candidates=[Candidate("flat", lambda inputs, _: np.zeros(3))], **FAST)
    with pytest.raises(TypeError, match="candidates: expected a Candidate"):
        study.run(toy.question(), candidates=[3], **FAST)
    with pytest.raises(ValueError, match="question: expected one of"):
        study.run("hard shadows")


@pytest.mark.parametrize("answer", [None, "text", [[1.0], [1.0, 2.0]], np.zeros((64, 96), complex)])
def test_what_is_no_picture_is_refused_by_name(answer):
    with pytest.raises((TypeError, ValueError), match=r"^mine: "):
        study.run(toy.question(candidates=[Candidate("mine", lambda inputs, _: answer)]), **FAST)


def test_a_study_of_nothing_is_refused():
    for given in ({"techniques": []}, {"views": {}}, {"views": []}, {"scene": {}}):
        with pytest.raises(ValueError, match=f"{next(iter(given))}: expected at least one"):
            study.run(toy.question(), **given, **FAST)
    nowhere = study.Mask("nowhere", lambda r, inputs: np.zeros(r.shape, bool))
    with pytest.raises(ValueError, match="nothing to measure in 'ramp': the mask selects no pixel"):
        study.run(toy.question(mask=nowhere), **FAST)


@pytest.mark.parametrize(
    "given", [{"size": "x"}, {"size": 5}, {"size": (1, 2, 3)}, {"views": 5}, {"techniques": 5}, {"threads": 0}]
)
def test_wrong_arguments_are_named(given):
    with pytest.raises((TypeError, ValueError), match=f"^{next(iter(given))}: expected"):
        study.run(toy.question(), **given, **FAST)


def test_wrong_bounds_and_pictures_are_named():
    result = study.run(toy.question(), techniques=["biased"], **FAST)
    for name in ("max_error", "budget_ms"):
        with pytest.raises(TypeError, match=f"{name}: expected a positive number, got 'x'"):
            result.pick(**{name: "x"})
    with pytest.raises(TypeError, match="path: expected a path"):
        External(5, 1)
    with pytest.raises(TypeError, match="ms: expected a number"):
        External("a.png", "1")


def test_not_finite_answers_are_counted_and_never_chosen():
    def broken(inputs, prepared):
        value = toy.truth(inputs)
        value[3, 4] = np.nan
        return value

    result = study.run(toy.question(candidates=[Candidate("broken", broken)]), **FAST)
    assert result.records[0].strays == 1 and np.isnan(result.records[0].error.value)
    assert result.front() == []
    with pytest.raises(study.NothingQualifies):
        result.pick(max_error=1e3)
    assert "not finite" in str(result)


def test_out_of_domain_candidates_stand_aside_with_their_reason():
    q = toy.question(candidates=[Candidate("never", toy.biased, [{"bias": 1}], domain=lambda i: "there is no light")])
    result = study.run(q, **FAST)
    assert result.records == () and result.cases[0].left_out == ("never: there is no light",)


def test_external_pictures_join_where_they_belong(tmp_path, monkeypatch):
    case = study.Case("ramp", "", 0, None, toy.SIZE, np.dtype(np.float32), 0)
    picture = toy.truth(case) + np.float32(0.03)
    monkeypatch.setattr(External, "picture", lambda self, case, first: picture if first else None)
    result = study.run(toy.question(scenes=("a", "b")), candidates=[External("vsm.exr", ms=0.001)], **FAST)
    mine = next(s for s in result.summaries() if s.technique == "vsm")
    assert mine.error.value == pytest.approx(0.03, rel=1e-3) and mine.ms.value == 0.001
    assert not mine.complete and mine.technique not in {s.technique for s in result.front()}
    assert result.front("a")[0].technique == "vsm"  # measured in all of that scene's cases, and fastest
    with pytest.raises(ValueError, match="ms: expected a finite number"):
        External("vsm.exr", ms=-1)


def test_the_mean_and_largest_magnitude_are_taken_where_asked():
    for how, expected in (("mean", 0.1), ("max", 0.1)):
        q = toy.question(candidates=[Candidate("biased", toy.biased, {"bias": (-0.1,)})])
        metric = study.Metric("d", lambda x, r, _: x - r, aggregate=how)
        result = study.run(study.Question("toy", q.scenes, q.reference, metric, q.candidates, size=toy.SIZE), **FAST)
        assert result.records[0].error.value == pytest.approx(expected, rel=1e-5)
    with pytest.raises(ValueError, match="aggregate 'rms' with a Monte Carlo reference"):
        study.Question("toy", {}, MonteCarlo(toy.estimate(1.0)), metric, [])


def test_the_same_seed_gives_the_same_errors():
    a, b = (study.run(toy.question(sigma=0.05), seed=3, **FAST) for _ in range(2))
    assert [r.error for r in a.records] == [r.error for r in b.records]
    c = study.run(toy.question(sigma=0.05), seed=4, **FAST)
    assert [r.error for r in a.records] != [r.error for r in c.records]


def test_preparation_is_timed_apart_and_counted():
    prepared = []

    def prepare(inputs, bias):
        prepared.append(bias)
        return sum(toy.truth(inputs) for _ in range(50))

    q = toy.question(candidates=[Candidate("biased", toy.biased, {"bias": (0.1,)}, prepare)])
    record = study.run(q, **FAST).records[0]
    assert len(prepared) == 1 + 1 + 3  # warm-up, in double, timed
    assert record.prepare_ms > record.run_ms > 0 and record.rounds == 3
    assert record.ms.value == pytest.approx(record.prepare_ms + record.run_ms, rel=0.5)


def test_threads_are_set_for_the_study_alone():
    import shadelab as sl

    before = sl.threads()
    result = study.run(toy.question(), threads=1, **FAST)
    assert result.machine["threads"] == 1 and sl.threads() == before


def test_progress_ends_at_its_total():
    seen = []
    study.run(toy.question(), progress=lambda done, total: seen.append((done, total)), **FAST)
    assert seen[-1][0] == seen[-1][1] and [d for d, _ in seen] == sorted(d for d, _ in seen)


def test_references_are_kept_by_content(tmp_path, monkeypatch):
    monkeypatch.setenv("SHADELAB_CACHE", str(tmp_path))
    options = FAST | {"cache": True}
    first = study.run(toy.question(sigma=0.05), **options)
    again = study.run(toy.question(sigma=0.05), **options)
    assert not first.cases[0].cached and again.cases[0].cached
    assert [r.error for r in first.records] == [r.error for r in again.records]
    assert len(list(tmp_path.glob("*.npz"))) == 1
    other = study.run(toy.question(sigma=0.06), **options)  # the estimate closes over another number
    assert not other.cases[0].cached and len(list(tmp_path.glob("*.npz"))) == 2
    next(tmp_path.glob("*.npz")).write_bytes(b"broken")
    results = [study.run(toy.question(sigma=s), **options).cases[0].cached for s in (0.05, 0.06)]
    assert sorted(results) == [False, True]


def test_what_has_no_content_is_not_kept():
    assert references.digest(object()) is None
    assert references.digest(np.arange(3)) != references.digest(np.arange(3.0))
    assert references.digest({"a": (1, 2)}) == references.digest({"a": (1, 2)})
    assert references.digest(lambda x: x + 1) != references.digest(lambda x: x + 2)


def test_functions_count_with_what_they_name_and_close_over():
    def made(n, helper):
        return lambda x: helper(x) + n

    one, other = (lambda x: x + 1), (lambda x: x + 2)
    assert references.digest(made(1, one)) == references.digest(made(1, one))
    assert references.digest(made(1, one)) != references.digest(made(2, one))
    assert references.digest(made(1, one)) != references.digest(made(1, other))
    space = {"helper": one}
    by_name = eval("lambda x: helper(x)", space)
    before = references.digest(by_name)
    space["helper"] = other
    assert before != references.digest(by_name)


def test_a_study_is_told_in_a_line_and_survives_pickling():
    result = study.run("fresnel", rounds=1, patience=0.0)
    assert repr(result).startswith("Study('fresnel', ") and len(repr(result)) < 80
    again = pickle.loads(pickle.dumps(result))
    assert again == result and again.table() == result.table()
