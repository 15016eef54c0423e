"""The questions of reflection: their references hold, and they find what is known."""

import numpy as np
import pytest
from shadelab import study

FAST = {"size": (64, 32), "rounds": 1, "patience": 0.0, "causes": False}


def errors(result):
    return {(r.scene, r.setting): r.error.value for r in result.records}


def test_schlick_is_off_by_hundredths_for_glass_and_more_for_metals():
    found = errors(study.run("fresnel", **FAST | {"size": (512, 2)}))
    assert found["glass", "schlick"] == pytest.approx(0.036, abs=1e-3)
    assert max(v for (_, s), v in found.items() if s == "fresnel") < 1e-5
    assert found["aluminium", "schlick"] > 0.02
    assert all(found[scene, "constant"] > 5 * found[scene, "schlick"] for scene in ("glass", "water", "diamond"))


def test_compensation_gives_back_what_is_lost():
    found = errors(study.run("energy compensation", **FAST | {"size": (64, 64)}))
    lost = {"roughness 0.5": 0.118, "roughness 0.75": 0.344, "roughness 1": 0.59}
    lost |= {"glass from outside, roughness 0.75": 0.11, "glass from within, roughness 0.75": 0.36}
    for scene, loss in lost.items():
        assert found[scene, "facets(compensation=none)"] == pytest.approx(loss, abs=0.01)
        for form in ("kulla_conty", "kulla_conty_as_published", "scaled"):
            assert found[scene, f"facets(compensation={form})"] < 0.01


def test_correlated_masking_is_its_own_reference():
    found = errors(study.run("masking functions", **FAST))
    for (_, setting), error in found.items():
        assert (error < 1e-6) == ("height_correlated" in setting)
    assert np.isfinite(list(found.values())).all()
    # Schlick's form is made for the separable one.
    assert found["middling (0.5)", "masking(masking=schlick)"] < 0.2


@pytest.mark.parametrize("name", ["fresnel", "energy compensation", "masking functions"])
def test_scenes_of_other_kinds_are_refused(name):
    with pytest.raises(ValueError, match="this question has scenes of its own"):
        study.run(name, {"mine": 3}, **FAST)
