"""The question of samplers: closed forms are right, and errors fall as theory says."""

import numpy as np
import pytest
from scipy import integrate
from shadelab import study
from shadelab.study import Case
from shadelab.study.questions import samplers

FAST = {"size": (8, 8), "rounds": 1, "patience": 0.0, "causes": False}


@pytest.mark.parametrize("name", samplers._SCENES)
def test_the_closed_forms_are_the_integrals(name):
    scene = samplers._SCENES[name]
    inputs = samplers._setup(Case(name, "", scene, None, (3, 1), np.dtype(np.float32), 0))
    exact = scene.exact(inputs.parameters)
    for p, value in zip(inputs.parameters, exact, strict=True):
        if name.startswith("smooth, 2"):
            got = integrate.dblquad(lambda y, x: scene.evaluate(np.array([[[x, y]]]), p[None])[0, 0], 0, 1, 0, 1)[0]  # noqa: B023
            assert abs(got - value) < 1e-9
        else:
            # Averages of very many points, within five of their standard errors.
            values = scene.evaluate(np.random.default_rng(1).random((1, 400_000, scene.dimensions)), p[None])[0]
            assert abs(values.mean() - value) < 5 * values.std() / np.sqrt(values.size)


def test_errors_fall_as_theory_says():
    result = study.run("samplers", **FAST)
    assert len(result.records) == 4 * 8 * 5
    rate = samplers.rates(result.records)
    for scene in samplers._SCENES:
        assert abs(rate["independent", scene] + 0.5) < 0.15
    smooth, edge = "smooth, 2 dimensions", "an edge, 2 dimensions"
    # Owen 1997: -3/2; a jittered grid: -1 (where smooth) and -3/4 (at edges); Halton's has -1 and logarithms.
    for name in ("Sobol, pairs", "Sobol, whole"):
        assert -1.75 < rate[name, smooth] < -1.3
        assert -0.95 < rate[name, edge] < -0.6
    assert abs(rate["stratified", smooth] + 1) < 0.2
    assert abs(rate["stratified", edge] + 0.75) < 0.2
    assert rate["Halton", smooth] < -0.85
    # In many dimensions combined at random, what is gained is a factor; the sequence as a whole keeps its rate.
    assert rate["Sobol, whole", "smooth, 16 dimensions"] < rate["Sobol, pairs", "smooth, 16 dimensions"] - 0.05
    with pytest.raises(ValueError, match="or takes an Integrand"):
        study.run("samplers", 3, **FAST)
