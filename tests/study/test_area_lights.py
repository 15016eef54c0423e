"""The question of area lights: what it must find whatever the machine."""

import pytest
from shadelab import light, study
from shadelab.study.questions.area_lights import Floor

FAST = {"size": (48, 32), "rounds": 1, "patience": 0.0, "causes": False, "cache": False}


@pytest.mark.parametrize("scene", ["panel, roughness 0.3", "small panel, roughness 0.3"])
def test_transformed_cosines_are_near_the_truth(scene):
    result = study.run("area lights", scene, **FAST)
    error = {(r.setting, r.view): r.error.value for r in result.records}
    # At grazing angles lobes are wider to the sides than any transformed cosine about the same plane.
    for view, bound in (("from above", 0.01), ("grazing", 0.08)):
        assert error["ltc", view] < bound
        # Noise falls with samples, whose bias is none.
        assert error["samples(samples=256)", view] < 0.5 * error["samples(samples=4)", view]


def test_one_point_distorts_the_highlight_of_a_panel():
    result = study.run("area lights", {"mine": Floor(light.RectLight((0, 1, -1), (2, 0, 0), (0, 0, 1)), 0.4)}, **FAST)
    error = {(r.setting, r.view): r.error.value for r in result.records}
    assert error["representative point", "from above"] > 2 * error["ltc", "from above"]


def test_other_scenes_are_refused():
    with pytest.raises(ValueError, match="scene: this question has scenes of its own"):
        study.run("area lights", {"mine": 3}, **FAST)
