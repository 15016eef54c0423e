"""The question of strategies: they agree, and rank as where the light comes from says."""

import numpy as np
import pytest
from shadelab import study
from shadelab.study import Case
from shadelab.study.questions import path_tracing_strategies as strategies

FAST = {"size": (24, 16), "rounds": 1, "patience": 0.0, "causes": False}


@pytest.mark.parametrize("name", strategies._SCENES)
def test_strategies_agree_in_the_mean(name):
    inputs = strategies._setup(Case(name, "", strategies._SCENES[name], None, (24, 16), np.dtype(np.float32), 0))
    means = {}
    for strategy in ("bsdf", "light", "mis"):
        parts = [inputs.trace(256, seed, strategy).mean() / inputs.brightness for seed in range(4)]
        means[strategy] = np.mean(parts), np.std(parts) / np.sqrt(3)
    best, own = means["mis"]
    for mean, error in means.values():
        # Four runs tell their own spread roughly: five of it, and what none of them may hide.
        assert abs(mean - best) < 5 * np.hypot(error, own) + 0.005


def test_it_runs_whole_and_ranks_as_expected():
    result = study.run("path tracing strategies", **FAST)
    assert len(result.cases) == 4
    error = {(r.scene, r.technique): r.error.value for r in result.records if r.knobs["samples"] == 64}
    for scene in strategies._SCENES:
        least = min(error[scene, name] for name in ("bsdf", "light"))
        assert error[scene, "mis"] < 1.3 * least
        assert error[scene, "uniform"] > error[scene, "mis"]
    assert error["room, small lamp", "light"] < 0.1 * error["room, small lamp", "bsdf"]
    with pytest.raises(ValueError, match="expected a Scene"):
        study.run("path tracing strategies", 3, **FAST)
